#pragma once

#include "gust/control/recording.h"

namespace gust {

/// A key or a column of the format, and what it means.
struct Meaning {
  std::string_view name;
  std::string_view text;
};

/// The keys of the JSON file: those that must be there, those that must where the CSV file has the columns that they
/// are about, and those that may.
std::span<const Meaning> recording_keys();
std::span<const Meaning> judged_recording_keys();
std::span<const Meaning> optional_recording_keys();

/// Reads the JSON file: all of a recording but its records, whose CSV file has these columns. Its `state` holds the
/// initial state alone, if the file gives it.
Recording read_description(const NamedBytes& description, std::vector<std::string> columns);

}  // namespace gust
