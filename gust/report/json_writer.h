#pragma once

#include <span>
#include <string>
#include <string_view>

namespace gust {

/// Writes compact JSON that may stand inside a script element: '<' is written as an escape, broken UTF-8 as U+FFFD.
///
/// Numbers keep five significant digits. What is not a number becomes null, infinity 1e999, which JavaScript reads as
/// such.
class JsonWriter {
 public:
  JsonWriter& open(char bracket);   // '{' or '['
  JsonWriter& close(char bracket);  // '}' or ']'
  JsonWriter& key(std::string_view name);
  JsonWriter& text(std::string_view value);
  JsonWriter& number(double value);
  JsonWriter& index(std::size_t value);
  JsonWriter& flag(bool value);
  JsonWriter& numbers(std::span<const double> values);
  JsonWriter& raw(std::string_view json);  // a finished value

  const std::string& str() const { return out_; }
  std::string take() { return std::move(out_); }

 private:
  void separate();

  std::string out_;
};

}  // namespace gust
