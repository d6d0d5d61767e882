#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "gust/core/error.h"

namespace gust {

/// Where a piece of text stands: "study.toml:14:12", or only a name ("--set") where lines mean nothing.
struct Place {
  std::string name;
  std::uint32_t line = 0;
  std::uint32_t column = 0;

  std::string text() const { return line == 0 ? name : cat(name, ":", line, ":", column); }
};

struct Value;

/// Named values in the order in which they were written.
struct Table {
  std::vector<std::pair<std::string, Value>> items;
  Place place;

  const Value* find(std::string_view key) const;
  bool contains(std::string_view key) const { return find(key) != nullptr; }
  /// Sets or replaces a key.
  void set(std::string_view key, Value value);
  /// Removes a key if it is there.
  void erase(std::string_view key);
  std::vector<std::string> keys() const;
};

/// What a study, a preset or a command line says: one value and where it was said.
struct Value {
  using List = std::vector<Value>;
  std::variant<bool, std::int64_t, double, std::string, List, Table> data;
  Place place;

  bool is_number() const { return std::holds_alternative<double>(data) || std::holds_alternative<std::int64_t>(data); }

  // Each throws an Error that names `what` if the value is of another type. Numbers must be finite.
  bool as_bool(std::string_view what) const;
  std::int64_t as_int(std::string_view what) const;
  double as_number(std::string_view what) const;
  const std::string& as_text(std::string_view what) const;
  const List& as_list(std::string_view what) const;
  const Table& as_table(std::string_view what) const;
  /// A list of numbers; a single number stands for a list of one.
  std::vector<double> as_numbers(std::string_view what) const;

  /// "a number", "text", "a list" … for messages.
  std::string_view type() const;
};

// Clang has to make and destroy a Value here: std::pair, asked first, would need both before it is complete itself.
namespace detail {
inline Value no_value() { return {}; }
}  // namespace detail

/// An Error at a place: "study.toml:3:1: " followed by the parts.
template <class... Parts>
Error error_at(const Place& place, const Parts&... parts) {
  return Error(cat(place.text(), ": ", parts...));
}

/// Reads what a command line gives as a value: true, 3, 0.5, [1, 2], a,b,c, or else text.
Value value_from_text(std::string_view text, const Place& place);

/// Throws an Error for the first key of the table that is not known, with the nearest known one.
void check_keys(const Table& table, const std::vector<std::string>& known, std::string_view what);

}  // namespace gust
