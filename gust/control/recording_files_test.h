#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <string>
#include <vector>

#include "gust/control/recording.h"
#include "gust/core/text.h"

namespace gust {

/// The two files of a committed recording as texts, for tests that change them.
struct RecordingText {
  std::string json;
  std::string csv;

  Recording read() const { return read_recording({json, "log.json"}, {csv, "log.csv"}); }
};

inline std::filesystem::path recordings_folder() {
  return std::filesystem::path(GUST_TEST_DATA) / "reference" / "traj";
}

inline std::string file_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  REQUIRE_MESSAGE(file.good(), path.string());
  return {std::istreambuf_iterator<char>(file), {}};
}

inline RecordingText recording_text(const std::string& name,
                                    const std::filesystem::path& folder = recordings_folder()) {
  return {file_text(folder / (name + ".json")), file_text(folder / (name + ".csv"))};
}

/// A CSV text without a column; quotes are not looked at.
inline std::string without_column(const std::string& csv, const std::string& name) {
  const std::vector<std::string> header = split_text(csv.substr(0, csv.find('\n')), ',');
  const auto at = std::ranges::find(header, name);
  REQUIRE_MESSAGE(at != header.end(), name);
  std::string text;
  std::ptrdiff_t column = 0;
  std::string kept;
  for (const char letter : csv) {
    const bool end = letter == '\n';
    if (column != at - header.begin() && !end && letter != ',') kept += letter;
    if (!end && letter != ',') continue;
    if (column != at - header.begin()) text += (text.empty() || text.back() == '\n' ? "" : ",") + kept;
    kept.clear();
    column = end ? 0 : column + 1;
    if (end) text += '\n';
  }
  return text;
}

inline RecordingText without(RecordingText text, std::initializer_list<const char*> columns) {
  for (const char* column : columns) text.csv = without_column(text.csv, column);
  return text;
}

/// Replaces the first occurrence, which must be there.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE_MESSAGE(at != std::string::npos, from);
  return text.replace(at, from.size(), to);
}

/// The message of the Error that reading gives; empty if it gives none.
inline std::string reading_error(const RecordingText& text) {
  try {
    text.read();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace gust
