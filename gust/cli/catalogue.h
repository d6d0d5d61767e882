#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gust/core/fields.h"

namespace gust {

/// One thing that a study or a command line may name, as `gust list` and `gust describe` show it.
struct CatalogueItem {
  std::string name;
  std::string summary;
  std::string source;
  std::vector<FieldInfo> fields;
  std::vector<std::pair<std::string, std::string>> notes;  ///< what else there is to know, by a heading
  std::string text;                                        ///< shown as it is, such as the content of a preset
  std::string example;                                     ///< TOML for a study, or a command line
};

/// One sort of things, such as all waveforms.
struct CatalogueKind {
  std::string name;    ///< "waveform"
  std::string plural;  ///< "waveforms"
  std::vector<CatalogueItem> items;
};

/// Everything there is: plants, policies, waveforms, agents, metrics, presets, sites and the program's commands.
std::vector<CatalogueKind> catalogue(const CLI::App& program);

/// The kind of a name, singular or plural, and the item of a name; an Error with the nearest name if there is none.
const CatalogueKind& find_kind(const std::vector<CatalogueKind>& kinds, std::string_view name);
const CatalogueItem& find_item(const CatalogueKind& kind, std::string_view name);

// For a terminal, and as JSON.
std::string list_text(const std::vector<CatalogueKind>& kinds);
std::string list_json(const CatalogueKind& kind);
std::string list_json(const std::vector<CatalogueKind>& kinds);
std::string describe_text(const CatalogueKind& kind, const CatalogueItem& item);
std::string describe_json(const CatalogueKind& kind, const CatalogueItem& item);

}  // namespace gust
