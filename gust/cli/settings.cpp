#include "gust/cli/settings.h"

#include <algorithm>

#include "gust/core/text.h"
#include "gust/study/text/parse.h"

namespace gust {
namespace {

const Place kPlace{"--set"};

/// A mask such as 0010 is text, for its zeros count. Lists and tables are TOML if they read as such.
Value value_of(const Setting& setting) {
  const bool digits = setting.text.find_first_not_of("01") == std::string::npos;
  if (setting.key == "mask" && digits) return {setting.text, kPlace};
  if (setting.text.front() == '[' || setting.text.front() == '{') return setting_value(setting.text, kPlace);
  return value_from_text(setting.text, kPlace);
}

}  // namespace

Setting split_setting(const std::string& typed, std::string_view option) {
  const std::size_t equals = typed.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == typed.size()) {
    throw Error(cat(option, ": '", typed, "' must read key=value"));
  }
  return {typed.substr(0, equals), typed.substr(equals + 1)};
}

void sort_settings(const std::vector<std::string>& typed, std::span<const SettingGroup> groups, std::string_view hint) {
  for (const std::string& text : typed) {
    const Setting setting = split_setting(text, kPlace.name);
    const auto group = std::ranges::find_if(
        groups, [&](const SettingGroup& one) { return std::ranges::find(one.keys, setting.key) != one.keys.end(); });
    if (group == groups.end()) {
      std::vector<std::string> known;
      for (const SettingGroup& one : groups) known.insert(known.end(), one.keys.begin(), one.keys.end());
      throw Error(cat("--set: unknown key '", setting.key, "'", did_you_mean(setting.key, known), hint));
    }
    if (group->table->contains(setting.key)) throw Error(cat("--set: '", setting.key, "' is given twice"));
    group->table->set(setting.key, value_of(setting));
  }
}

}  // namespace gust
