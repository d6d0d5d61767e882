#include "gust/core/identity.h"

namespace gust {

Identity Identity::without(std::string_view name) const {
  Identity rest = *this;
  std::erase_if(rest.values_, [&](const auto& value) { return value.first == name; });
  return rest;
}

Identity Identity::with(std::string_view name, std::string_view value) const {
  Identity other = *this;
  for (auto& [known, text] : other.values_) {
    if (known == name) text = value;
  }
  return other;
}

std::string Identity::text() const {
  std::string text;
  for (const auto& [name, value] : values_) text += (text.empty() ? "" : ", ") + name + " = " + value;
  return text;
}

}  // namespace gust
