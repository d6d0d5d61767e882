#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <string_view>

namespace gust {

/// Joins at most 32 values to one text; floating point numbers in their shortest form that reads back to the same
/// value.
template <class... Parts>
std::string cat(const Parts&... parts) {
  static constexpr std::string_view kSlots = "{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}{}";
  static_assert(2 * sizeof...(Parts) <= kSlots.size());
  return fmt::vformat(kSlots.substr(0, 2 * sizeof...(Parts)), fmt::make_format_args(parts...));
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
