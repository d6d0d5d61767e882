#pragma once

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "gust/control/recording.h"

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

inline RecordingText recording_text(const std::string& name) {
  return {file_text(recordings_folder() / (name + ".json")), file_text(recordings_folder() / (name + ".csv"))};
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
