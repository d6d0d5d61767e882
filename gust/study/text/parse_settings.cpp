#include <algorithm>

#include "gust/setup/toml.h"
#include "gust/study/text/parse.h"

namespace gust {
namespace {

/// What a table of a list is called by: its name or its id.
std::string label_of(const Value& item) {
  const auto* table = std::get_if<Table>(&item.data);
  for (const char* key : {"name", "id"}) {
    const Value* name = table ? table->find(key) : nullptr;
    const auto* text = name ? std::get_if<std::string>(&name->data) : nullptr;
    if (text != nullptr) return *text;
  }
  return {};
}

/// The table of a list whose name or id is this, or whose position is.
Value* element(Value::List& list, const std::string& key) {
  const auto at = std::ranges::find(list, key, label_of);
  if (at != list.end()) return &*at;
  const Value index = value_from_text(key, {});
  const auto* number = std::get_if<std::int64_t>(&index.data);
  if (number == nullptr || *number < 0 || *number >= static_cast<std::int64_t>(list.size())) return nullptr;
  return &list[static_cast<std::size_t>(*number)];
}

Value* child(Value& parent, const std::string& key) {
  if (auto* list = std::get_if<Value::List>(&parent.data)) return element(*list, key);
  auto* table = std::get_if<Table>(&parent.data);
  if (table == nullptr) return nullptr;
  const auto at = std::ranges::find_if(table->items, [&](const auto& item) { return item.first == key; });
  return at == table->items.end() ? nullptr : &at->second;
}

/// A setting in two: the parts of its key between dots, any of them in quotes, and what it is set to.
struct SettingParts {
  std::vector<std::string> path;
  std::string value;
};

SettingParts split_parts(std::string_view rest, const Place& place) {
  SettingParts parts;
  for (char stop = '.'; stop == '.'; rest.remove_prefix(1)) {
    const char quote = rest.starts_with('"') || rest.starts_with('\'') ? rest.front() : '\0';
    if (quote != '\0') rest.remove_prefix(1);
    const std::size_t end = quote != '\0' ? rest.find(quote) : rest.find_first_of(".=");
    if (quote != '\0' && end == rest.npos) throw error_at(place, "a quote is not closed");
    parts.path.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(rest.size(), quote != '\0' ? end + 1 : end));
    stop = rest.empty() ? '\0' : rest.front();
    if (parts.path.back().empty() || (stop != '.' && stop != '='))
      throw error_at(place, "a setting reads key=value, such as evaluate.episodes=5");
  }
  parts.value = rest;
  return parts;
}

Error nothing_there(const Place& place, const Value& parent, const std::string& key) {
  std::vector<std::string> names;
  if (const auto* list = std::get_if<Value::List>(&parent.data)) {
    for (const Value& item : *list) names.push_back(label_of(item));
  }
  return error_at(place, "the study has no '", key, "' there", did_you_mean(key, names));
}

}  // namespace

Value setting_value(const std::string& text, const Place& place) {
  try {
    Value value = parse_toml("value = " + text, place.name).items.front().second;
    value.place = place;
    return value;
  } catch (const Error&) {
    return value_from_text(text, place);
  }
}

void apply_setting(Table& study, const std::string& setting) {
  const Place place{cat("--set ", setting)};
  auto [path, text] = split_parts(setting, place);
  const std::string last = path.back();
  path.pop_back();

  Value root{study, study.place};
  Value* at = &root;
  for (const std::string& key : path) {
    Value* next = child(*at, key);
    auto* table = std::get_if<Table>(&at->data);
    if (next == nullptr && table != nullptr) {
      table->set(key, Value{Table{{}, place}, place});
      next = child(*at, key);
    }
    if (next == nullptr) throw nothing_there(place, *at, key);
    at = next;
  }
  const Value value = setting_value(text, place);
  if (auto* table = std::get_if<Table>(&at->data)) {
    table->set(last, value);
  } else if (Value* item = child(*at, last)) {
    *item = value;
  } else {
    throw nothing_there(place, *at, last);
  }
  study = std::get<Table>(std::move(root.data));
}

}  // namespace gust
