#include "gust/core/fields.h"

#include <algorithm>

namespace gust {
namespace {

void check_range(double number, const Value& value, std::string_view name, const Range& range) {
  if (!range.contains(number)) throw error_at(value.place, "'", name, "' must be ", range.text(), ", got ", number);
}

}  // namespace

std::string Range::text() const {
  if (!words.empty()) return cat("one of ", join(split_text(words, '|'), ", "));
  const bool has_low = std::isfinite(low);
  const bool has_high = std::isfinite(high);
  if (has_low && has_high) return cat(low_open ? "above " : "", low, " to ", high);
  if (has_low) return cat(low_open ? "> " : ">= ", low);
  if (has_high) return cat("<= ", high);
  return {};
}

void read_value(bool& to, const Value& value, std::string_view name, const Range&) { to = value.as_bool(name); }

void read_value(std::int64_t& to, const Value& value, std::string_view name, const Range& range) {
  to = value.as_int(name);
  check_range(static_cast<double>(to), value, name, range);
}

void read_value(double& to, const Value& value, std::string_view name, const Range& range) {
  to = value.as_number(name);
  check_range(to, value, name, range);
}

void read_value(std::string& to, const Value& value, std::string_view name, const Range& range) {
  to = value.as_text(name);
  if (range.words.empty()) return;
  const std::vector<std::string> words = split_text(range.words, '|');
  if (std::find(words.begin(), words.end(), to) != words.end()) return;
  throw error_at(value.place, "'", name, "' must be ", range.text(), ", got '", to, "'", did_you_mean(to, words));
}

void read_value(std::vector<double>& to, const Value& value, std::string_view name, const Range& range) {
  to = value.as_numbers(name);
  for (const double number : to) check_range(number, value, name, range);
}

std::string canonical_text(bool value) { return value ? "true" : "false"; }
std::string canonical_text(std::int64_t value) { return cat(value); }
std::string canonical_text(double value) { return cat(value == 0 ? 0.0 : value); }  // -0 and 0 are one value
std::string canonical_text(const std::string& value) {
  std::string text = "\"";
  for (const char letter : value) {
    if (letter == '"' || letter == '\\') text += '\\';
    text += letter;
  }
  return text + "\"";
}
std::string canonical_text(const std::vector<double>& value) {
  std::vector<std::string> parts;
  for (const double number : value) parts.push_back(canonical_text(number));
  return cat("[", join(parts, ", "), "]");
}

std::string_view type_text(const bool&) { return "true or false"; }
std::string_view type_text(const std::int64_t&) { return "whole number"; }
std::string_view type_text(const double&) { return "number"; }
std::string_view type_text(const std::string&) { return "text"; }
std::string_view type_text(const std::vector<double>&) { return "list of numbers"; }

}  // namespace gust
