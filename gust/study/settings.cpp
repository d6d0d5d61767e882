#include <algorithm>

#include "gust/study/parse.h"
#include "gust/study/toml.h"

namespace gust {
namespace {

/// The table of a list whose name or id is this, or whose position is.
Value* element(Value::List& list, const std::string& key) {
  for (Value& item : list) {
    const auto* table = std::get_if<Table>(&item.data);
    if (table == nullptr) continue;
    for (const char* label : {"name", "id"}) {
      const Value* name = table->find(label);
      const auto* text = name ? std::get_if<std::string>(&name->data) : nullptr;
      if (text != nullptr && *text == key) return &item;
    }
  }
  const Value index = value_from_text(key, {});
  const auto* number = std::get_if<std::int64_t>(&index.data);
  if (number == nullptr || *number < 0 || *number >= static_cast<std::int64_t>(list.size())) return nullptr;
  return &list[static_cast<std::size_t>(*number)];
}

/// The value of a setting: TOML if it reads as such, else plain text.
Value setting_value(const std::string& text, const Place& place) {
  try {
    Value value = parse_toml("value = " + text, place.name).items.front().second;
    value.place = place;
    return value;
  } catch (const Error&) {
    return value_from_text(text, place);
  }
}

Value* child(Value& parent, const std::string& key) {
  if (auto* list = std::get_if<Value::List>(&parent.data)) return element(*list, key);
  auto* table = std::get_if<Table>(&parent.data);
  if (table == nullptr) return nullptr;
  const auto at = std::ranges::find_if(table->items, [&](const auto& item) { return item.first == key; });
  return at == table->items.end() ? nullptr : &at->second;
}

}  // namespace

void apply_setting(Table& study, const std::string& setting) {
  const Place place{cat("--set ", setting)};
  const std::size_t equals = setting.find('=');
  if (equals == 0 || equals == std::string::npos)
    throw error_at(place, "a setting reads key=value, such as evaluate.episodes=5");
  std::vector<std::string> path = split_text(setting.substr(0, equals), '.');
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
    if (next == nullptr) throw error_at(place, "the study has no '", key, "' there");
    at = next;
  }
  const Value value = setting_value(setting.substr(equals + 1), place);
  if (auto* table = std::get_if<Table>(&at->data)) {
    table->set(last, value);
  } else if (Value* item = child(*at, last)) {
    *item = value;
  } else {
    throw error_at(place, "the study has no '", last, "' there");
  }
  study = std::get<Table>(std::move(root.data));
}

}  // namespace gust
