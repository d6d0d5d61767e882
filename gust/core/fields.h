#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "gust/core/identity.h"
#include "gust/core/text.h"
#include "gust/core/value.h"

namespace gust {

/// What a field accepts: an interval of numbers, or one of some words written "a|b|c".
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;
  std::string_view words = {};

  bool contains(double number) const { return (low_open ? number > low : number >= low) && number <= high; }
  /// "> 0", "0 to 1", "one of a, b"; empty if anything goes.
  std::string text() const;
};

inline constexpr Range anything{};
inline constexpr Range positive{.low = 0, .low_open = true};
inline constexpr Range non_negative{.low = 0};
constexpr Range between(double low, double high) { return {.low = low, .high = high}; }
constexpr Range at_least(double low) { return {.low = low}; }
constexpr Range one_of(std::string_view words) { return {.words = words}; }

/// One option of a kind: from this one declaration follow its key, default, range, help and canonical text.
template <class S, class M>
struct Field {
  std::string_view name;
  M S::*member;
  std::string_view help;
  Range range;
  std::string_view unit;
  bool later = false;  ///< came after results had been stored
};

template <class S, class M>
constexpr Field<S, M> field(std::string_view name, M S::*member, std::string_view help, Range range = anything,
                            std::string_view unit = "") {
  return {name, member, help, range, unit, false};
}

/// A field that came after results had been stored under names without it: it enters the canonical text only where it
/// is not at its default.
template <class S, class M>
constexpr Field<S, M> later(Field<S, M> field) {
  field.later = true;
  return field;
}

/// A field as the catalogue shows it.
struct FieldInfo {
  std::string name;
  std::string type;
  std::string unit;
  std::string range;
  std::string standard;  ///< the default, as canonical text
  std::string help;
};

// The types that a field may have: read from a value, written as canonical text.
void read_value(bool& to, const Value& value, std::string_view name, const Range& range);
void read_value(std::int64_t& to, const Value& value, std::string_view name, const Range& range);
void read_value(double& to, const Value& value, std::string_view name, const Range& range);
void read_value(std::string& to, const Value& value, std::string_view name, const Range& range);
void read_value(std::vector<double>& to, const Value& value, std::string_view name, const Range& range);
std::string canonical_text(bool value);
std::string canonical_text(std::int64_t value);
std::string canonical_text(double value);
std::string canonical_text(const std::string& value);
std::string canonical_text(const std::vector<double>& value);
std::string_view type_text(const bool&);
std::string_view type_text(const std::int64_t&);
std::string_view type_text(const double&);
std::string_view type_text(const std::string&);
std::string_view type_text(const std::vector<double>&);

template <class S, class Visit>
void for_each_field(Visit&& visit) {
  std::apply([&](const auto&... fields) { (visit(fields), ...); }, S::kFields);
}

template <class S>
std::vector<FieldInfo> describe_fields(const S& standard = S{}) {
  std::vector<FieldInfo> infos;
  for_each_field<S>([&](const auto& field) {
    const auto& value = standard.*field.member;
    infos.push_back({std::string(field.name), std::string(type_text(value)), std::string(field.unit),
                     field.range.text(), canonical_text(value), std::string(field.help)});
  });
  return infos;
}

template <class S>
std::vector<std::string> field_names() {
  std::vector<std::string> names;
  for_each_field<S>([&](const auto& field) { names.emplace_back(field.name); });
  return names;
}

/// Overwrites the options that the table names. Keys that are no fields are errors, but for those in `also`.
/// A struct may check what lies between its fields in `void check(const Place&) const`.
template <class S>
void read_fields(S& options, const Table& table, std::string_view what, const std::vector<std::string>& also = {}) {
  std::vector<std::string> known = also;
  for (std::string& name : field_names<S>()) known.push_back(std::move(name));
  check_keys(table, known, what);
  for_each_field<S>([&](const auto& field) {
    if (const Value* value = table.find(field.name)) read_value(options.*field.member, *value, field.name, field.range);
  });
  if constexpr (requires { options.check(table.place); }) options.check(table.place);
}

/// Every option with its value, in the order of declaration: what is hashed and shown. later() ones that are at
/// their default are left out.
template <class S>
Identity identity_of(const S& options) {
  const S standard{};
  Identity identity;
  for_each_field<S>([&](const auto& field) {
    if (field.later && options.*field.member == standard.*field.member) return;
    identity.add(std::string(field.name), canonical_text(options.*field.member));
  });
  return identity;
}

template <class S>
std::string canonical_fields(const S& options) {
  return identity_of(options).text();
}

}  // namespace gust
