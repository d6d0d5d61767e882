#include "gust/core/value.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "gust/core/text.h"

namespace gust {
namespace {

template <class T>
const T& get(const Value& value, std::string_view what, std::string_view wanted) {
  if (const T* data = std::get_if<T>(&value.data)) return *data;
  throw error_at(value.place, "'", what, "' must be ", wanted, ", got ", value.type());
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

template <class T>
bool reads_whole(std::string_view text, T& number) {
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  return failure == std::errc{} && end == text.data() + text.size();
}

}  // namespace

const Value* Table::find(std::string_view key) const {
  const auto at = std::find_if(items.begin(), items.end(), [&](const auto& item) { return item.first == key; });
  return at == items.end() ? nullptr : &at->second;
}

void Table::set(std::string_view key, Value value) {
  const auto at = std::find_if(items.begin(), items.end(), [&](const auto& item) { return item.first == key; });
  if (at == items.end()) {
    items.emplace_back(std::string(key), std::move(value));
  } else {
    at->second = std::move(value);
  }
}

void Table::erase(std::string_view key) {
  std::erase_if(items, [&](const auto& item) { return item.first == key; });
}

std::vector<std::string> Table::keys() const {
  std::vector<std::string> names;
  for (const auto& item : items) names.push_back(item.first);
  return names;
}

std::string_view Value::type() const {
  static constexpr std::string_view kNames[] = {"true or false", "a whole number", "a number",
                                                "text",          "a list",         "a table"};
  return kNames[data.index()];
}

bool Value::as_bool(std::string_view what) const { return get<bool>(*this, what, "true or false"); }
const std::string& Value::as_text(std::string_view what) const { return get<std::string>(*this, what, "text"); }
const Value::List& Value::as_list(std::string_view what) const { return get<List>(*this, what, "a list"); }
const Table& Value::as_table(std::string_view what) const { return get<Table>(*this, what, "a table"); }
std::int64_t Value::as_int(std::string_view what) const {
  if (const double* number = std::get_if<double>(&data)) {
    throw error_at(place, "'", what, "' must be a whole number, got ", *number);
  }
  return get<std::int64_t>(*this, what, "a whole number");
}

double Value::as_number(std::string_view what) const {
  if (const auto* whole = std::get_if<std::int64_t>(&data)) return static_cast<double>(*whole);
  const double number = get<double>(*this, what, "a number");
  if (!std::isfinite(number)) throw error_at(place, "'", what, "' must be a finite number, got ", number);
  return number;
}

std::vector<double> Value::as_numbers(std::string_view what) const {
  if (is_number()) return {as_number(what)};
  std::vector<double> numbers;
  for (const Value& item : get<List>(*this, what, "a number or a list of numbers")) {
    numbers.push_back(item.as_number(what));
  }
  return numbers;
}

Value value_from_text(std::string_view text, const Place& place) {
  text = trimmed(text);
  if (text == "true" || text == "false") return {text == "true", place};
  std::int64_t whole = 0;
  if (reads_whole(text, whole)) return {whole, place};
  double number = 0;
  if (reads_whole(text, number)) return {number, place};
  const bool bracketed = text.size() >= 2 && text.front() == '[' && text.back() == ']';
  if (bracketed || text.find(',') != std::string_view::npos) {
    if (bracketed) text = text.substr(1, text.size() - 2);
    Value::List list;
    for (const std::string& part : split_text(text, ',')) list.push_back(value_from_text(part, place));
    return {std::move(list), place};
  }
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  return {std::string(text), place};
}

void check_keys(const Table& table, const std::vector<std::string>& known, std::string_view what) {
  for (const auto& [key, value] : table.items) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    const std::string hint = did_you_mean(key, known);
    throw error_at(value.place, "unknown key '", key, "' in ", what,
                   hint.empty() ? cat("; known are ", join(known, ", ")) : hint);
  }
}

}  // namespace gust
