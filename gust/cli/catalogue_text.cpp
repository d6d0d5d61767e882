#include <algorithm>
#include <nlohmann/json.hpp>

#include "gust/cli/catalogue.h"
#include "gust/cli/help_format.h"
#include "gust/cli/toml_format.h"
#include "gust/core/text.h"

namespace gust {
namespace {

using Json = nlohmann::ordered_json;

std::size_t longest_name(const std::vector<CatalogueKind>& kinds) {
  std::size_t longest = 0;
  for (const CatalogueKind& kind : kinds) {
    for (const CatalogueItem& item : kind.items) longest = std::max(longest, item.name.size());
  }
  return longest;
}

std::string indented(const std::string& text) {
  std::string to = "  ";
  for (const char letter : text) to += letter == '\n' ? std::string("\n  ") : std::string(1, letter);
  return to;
}

/// name = default [unit]   help; range
std::string field_text(const FieldInfo& field) {
  const std::string head =
      cat("  ", field.name, " = ", field.standard, field.unit.empty() ? "" : cat(" [", field.unit, "]"));
  const std::string range = field.range.empty() ? field.type : field.range;
  return cat(head, "\n", indented(indented(wrapped(cat(field.help, "; ", range), text_columns() - 6))), "\n");
}

Json list_of(const CatalogueKind& kind) {
  Json list = Json::array();
  for (const CatalogueItem& item : kind.items) {
    list.push_back({{"name", item.name}, {"summary", item.summary}, {"source", item.source}});
  }
  return list;
}

std::string dumped(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

}  // namespace

std::string list_text(const std::vector<CatalogueKind>& kinds) {
  const std::size_t width = longest_name(kinds);
  std::string text;
  for (const CatalogueKind& kind : kinds) {
    if (kinds.size() > 1) text += cat(text.empty() ? "" : "\n", kind.plural, "\n");
    for (const CatalogueItem& item : kind.items) {
      const std::size_t room = text_columns() - std::min(text_columns(), width + 4);
      text += fmt::format("  {:<{}}  {}\n", item.name, width, wrapped(item.summary, room, width + 4));
    }
  }
  return text;
}

std::string list_json(const CatalogueKind& kind) { return dumped(list_of(kind)); }

std::string list_json(const std::vector<CatalogueKind>& kinds) {
  Json object;
  for (const CatalogueKind& kind : kinds) object[kind.plural] = list_of(kind);
  return dumped(object);
}

std::string describe_text(const CatalogueKind& kind, const CatalogueItem& item) {
  if (kind.name == "command") return item.text;
  std::string text = wrapped(cat(item.name, ", ", kind.name == "agent" ? "an " : "a ", kind.name, ": ", item.summary),
                             text_columns()) +
                     "\n";
  if (!item.source.empty()) text += wrapped(cat("Source: ", item.source), text_columns()) + "\n";
  for (const auto& [heading, note] : item.notes)
    text += cat("\n", heading, "\n", indented(wrapped(note, text_columns() - 2)), "\n");
  if (!item.fields.empty()) text += "\noptions\n";
  for (const FieldInfo& field : item.fields) text += field_text(field);
  const std::size_t room = text_columns() - 2;
  if (!item.text.empty()) text += cat("\ncontent\n", indented(wrapped_toml(item.text, room)), "\n");
  return text + cat("\nexample\n", indented(wrapped_toml(item.example, room)), "\n");
}

std::string describe_json(const CatalogueKind& kind, const CatalogueItem& item) {
  Json fields = Json::array();
  for (const FieldInfo& field : item.fields) {
    fields.push_back({{"name", field.name},
                      {"type", field.type},
                      {"unit", field.unit},
                      {"range", field.range},
                      {"default", field.standard},
                      {"help", field.help}});
  }
  Json notes = Json::object();
  for (const auto& [heading, note] : item.notes) notes[heading] = note;
  return dumped({{"kind", kind.name},
                 {"name", item.name},
                 {"summary", item.summary},
                 {"source", item.source},
                 {"options", fields},
                 {"notes", notes},
                 {"content", item.text},
                 {"example", item.example}});
}

}  // namespace gust
