#include "gust/paper/paper_checks.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "gust/core/text.h"

namespace gust {

void check_known(const std::vector<std::string>& known, const Value& value, const char* what) {
  const std::string& name = value.as_text(what);
  if (std::ranges::find(known, name) != known.end()) return;
  const std::string hint = did_you_mean(name, known);
  throw error_at(value.place, "unknown ", what, " '", name, "'",
                 !hint.empty() || known.empty() ? hint : cat("; known are ", join(known, ", ")));
}

void check_study(const Paper& paper, const Value& value) {
  std::vector<std::string> known;
  for (const PaperFigure& figure : paper.figures) known.push_back(figure.study);
  check_known(known, value, "study");
}

void check_studies(const Paper& paper, const Table& table, std::string_view key) {
  const Value* list = table.find(key);
  if (list == nullptr) return;
  for (const Value& item : list->as_list(key)) check_study(paper, item);
}

void check_reading(const Paper& paper, const Table& table, std::string_view key) {
  std::vector<std::string> known;
  for (const PaperReading& reading : paper.readings) known.push_back(reading.name);
  if (const Value* value = table.find(key)) check_known(known, *value, "reading");
}

void check_file_name(const Value& value, std::string_view key) {
  const std::string& name = value.as_text(key);
  const bool plain = !name.empty() && std::ranges::all_of(name, [](unsigned char letter) {
    return std::isalnum(letter) != 0 || letter == '-' || letter == '_';
  });
  if (!plain)
    throw error_at(value.place, "'", key, "' becomes a file's name: letters, digits, - and _ alone, got '", name, "'");
}

void check_folder_name(const Paper& paper, const PaperReading& reading, const Place& place) {
  constexpr std::array<std::string_view, 3> kTaken = {"store", "policies", "inputs"};
  const std::string folder = slug(reading.name);
  if (folder.empty()) throw error_at(place, "the name of a reading needs a letter or a digit");
  if (std::ranges::find(kTaken, folder) != kTaken.end())
    throw error_at(place, "results have a folder '", folder, "' of another kind; give the reading another name");
  for (const PaperReading& other : paper.readings) {
    if (slug(other.name) == folder)
      throw error_at(place, "the readings '", other.name, "' and '", reading.name, "' have one folder, '", folder, "'");
  }
}

}  // namespace gust
