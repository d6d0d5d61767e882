#pragma once

#include <fmt/format.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

namespace gust {

/// What a value is printed as: itself, but a NaN has no sign.
template <class T>
decltype(auto) shown(const T& value) {
  if constexpr (std::is_floating_point_v<T>) {
    return value == value ? value : std::numeric_limits<T>::quiet_NaN();
  } else {
    return (value);
  }
}

/// fmt::format, but a NaN prints as "nan", never as "-nan". For all numbers that may be NaN.
template <class... Args>
std::string format(fmt::format_string<const Args&...> text, const Args&... args) {
  const auto print = [&](const auto&... shown) {
    return fmt::vformat(fmt::string_view(text), fmt::make_format_args(shown...));
  };
  return print(shown(args)...);
}

/// Joins at most 32 values to one text; floating point numbers in their shortest form that reads back to the same
/// value, NaN without a sign.
template <class... Parts>
std::string cat(const Parts&... parts) {
  static constexpr std::string_view kSlots = "{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}";
  static_assert(2 * sizeof...(Parts) <= kSlots.size());
  const auto print = [](const auto&... shown) {
    return fmt::vformat(kSlots.substr(0, 2 * sizeof...(Parts)), fmt::make_format_args(shown...));
  };
  return print(shown(parts)...);
}

/// Something that the user can mend. The message reads "where: what; what would be right".
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A mistake of ours: a broken promise inside the program.
class Bug : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

#define GUST_CHECK(condition) \
  ((condition) ? void(0) : throw ::gust::Bug(::gust::cat(__FILE__, ":", __LINE__, ": expected ", #condition)))

}  // namespace gust
