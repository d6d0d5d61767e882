#pragma once

#include <filesystem>

#include "gust/study/store.h"
#include "gust/study/study.h"

namespace gust {

/// The folder that a run leaves: the study as it was run, copies of the policy files that it used, and the store.
///
///   study.toml      the study's text, byte for byte
///   inputs.json     the settings, and which file each pattern found
///   inputs/         those files, named by their hashes
///   store/          the trials (elsewhere if GUST_CACHE names a folder)
///   report.html     the page
class StudyFolder {
 public:
  explicit StudyFolder(std::filesystem::path path) : path_(std::move(path)) {}

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path report() const { return path_ / "report.html"; }
  std::filesystem::path store() const;

  /// Reads the study of a file for a run, with patterns relative to the file.
  static Study read(const std::filesystem::path& file, const std::vector<std::string>& settings);
  /// Writes what open() needs. Throws Error if the folder belongs to another study or cannot be written.
  void keep(const Study& study, const std::vector<std::string>& settings) const;
  /// Reads the study back, without the files it was made from.
  Study open() const;
  /// The settings of the run.
  std::vector<std::string> settings() const;

 private:
  std::filesystem::path path_;
};

}  // namespace gust
