#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gust {

/// What something is: names and values, in order. Its text is what trials are named by, so equal texts make equal
/// things.
class Identity {
 public:
  void add(std::string name, std::string value) { values_.emplace_back(std::move(name), std::move(value)); }

  /// The same without a name, or with another value for one; without change where the name is not there.
  Identity without(std::string_view name) const;
  Identity with(std::string_view name, std::string_view value) const;

  /// "name = value, name = value"
  std::string text() const;

 private:
  std::vector<std::pair<std::string, std::string>> values_;
};

}  // namespace gust
