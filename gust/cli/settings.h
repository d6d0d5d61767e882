#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gust/core/value.h"

namespace gust {

/// "key=value" in two.
struct Setting {
  std::string key;
  std::string text;
};

/// Splits what was typed after an option; an Error that starts with it if there is no key or no value.
Setting split_setting(const std::string& typed, std::string_view option);

/// Keys that --set takes, and the table that they go to.
struct SettingGroup {
  Table* table;
  std::vector<std::string> keys;
};

/// Puts every --set into the table of the first group that knows its key. Unknown keys and keys given twice are Errors;
/// `hint` ends the message of the first.
void sort_settings(const std::vector<std::string>& typed, std::span<const SettingGroup> groups, std::string_view hint);

}  // namespace gust
