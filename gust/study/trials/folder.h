#pragma once

#include <filesystem>

#include "gust/store/store.h"
#include "gust/study/text/study.h"

namespace gust {

/// Where a run leaves its results unless it is told: ./NAME.gust
std::string standard_folder(const Study& study);

/// Finds the files of a study's patterns relative to a folder, as the study that lies there means them.
FindFiles files_beside(const std::filesystem::path& folder);

/// What `gust run`, or `gust import`, was given.
struct RunInputs {
  std::string study;  ///< path of the file
  std::vector<std::string> settings;
  std::string rows = {};  ///< path of the table that was imported; empty: gust runs the trials
};

/// The folder that a run leaves: the study as it was run, copies of the policy files that it used, and the store.
///
///   study.toml      the study's text, byte for byte
///   inputs.json     where the study lay, the settings, which file each pattern found, and the hashes of all this
///   inputs/         those files, named by their hashes
///   rows.csv        what was measured elsewhere, where that was imported; then there is no store
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
  /// Writes what open() needs. Throws Error if the folder is no result of gust or cannot be written.
  void keep(const Study& study, const RunInputs& inputs) const;
  /// The same of a study whose rows were measured elsewhere.
  void keep(const Study& study, const RunInputs& inputs, std::string_view rows) const;
  /// Reads the study back, without the files it was made from. An Error if its text, its settings or its files are not
  /// those that the run wrote; folders of earlier versions cannot tell, which the notice says.
  Study open(const Store::Notice& notice = {}) const;
  /// What the run was given.
  RunInputs inputs() const;
  /// Where imported rows lie.
  std::filesystem::path rows() const { return path_ / "rows.csv"; }
  /// The imported rows; an Error if they are not what was imported.
  std::string read_rows() const;

 private:
  void check_place() const;
  void write_study(const Study& study, const RunInputs& inputs, const std::string& rows_hash) const;

  std::filesystem::path path_;
};

}  // namespace gust
