#pragma once

#include <filesystem>
#include <memory>

#include "gust/paper/reproduction.h"

namespace gust {

/// What a reproduction found: all that its page and its text are made of.
struct PaperResults {
  Reproduction reproduction;       ///< its automatic sweeps have the levels that were found
  std::vector<Summary> summaries;  ///< of its studies
  std::vector<PaperVerdict> verdicts;
  std::vector<std::string> failures;                            ///< trials that did not end well, each with its reason
  std::vector<std::pair<std::string, std::string>> provenance;  ///< versions, machine, time; in order
  std::size_t missing = 0;                                      ///< trials that are still to be run
  std::shared_ptr<ScoreLog> scores = nullptr;                   ///< that decided the claims; not read back
  std::shared_ptr<const Paper> own_paper = nullptr;             ///< reproduction.paper, where it was read from a copy

  /// What must stand wherever the numbers appear: that these are fewer steps, seeds or trials than the studies have.
  /// Empty for the full run.
  std::string label() const;

  /// The summary that a reading has of a study; null if it was not to be run.
  const Summary* summary(std::size_t reading, std::string_view study) const;
  /// The verdicts on one claim, the deciding one first.
  std::vector<const PaperVerdict*> on(std::size_t claim) const;
};

/// A result folder of a reproduction:
///
///   reproduction.json           which paper, profile, studies and seeds; versions, machine, time; what failed
///   claims.csv                  a line a claim and reading
///   scores.csv, scores.f32      the scores of every training that a claim asked for (ScoreLog)
///   READING/STUDY.csv           the cells (cells_csv)
///   READING/STUDY-learning.csv  learning curves, of the figures that show them
///   READING/STUDY-N.json        episodes for the replay, of the figures that show them
///   inputs/                     the paper's folder, if it is not the paper in the program
///
/// Reads back what was written, to the bit. Throws Error where a file is missing or another version's.
void write_results(const PaperResults& results, const std::filesystem::path& folder);
PaperResults read_results(const std::filesystem::path& folder);

/// Leaves what the tables hold, so that a page made of them is this one: means and intervals to seven digits at the
/// levels of the studies (a margin stands without those that it asked for), learning curves and kept episodes of those
/// figures alone that show them.
void reduce_to_tables(PaperResults& results);

/// What results say of themselves.
struct ResultsHead {
  std::string paper;                  ///< its name
  std::optional<std::string> folder;  ///< what `gust reproduce` was given for it, if it is not the paper in the program
  ReproductionChoice choice;
  std::vector<std::pair<std::string, std::string>> provenance;
  std::vector<std::string> failures;
  std::size_t missing = 0;
  std::map<std::string, std::string> hashes;  ///< of the other files

  /// Whether these are results of the same paper and choice.
  bool same_as(const Reproduction& reproduction) const;
};
ResultsHead read_results_head(const std::filesystem::path& folder);

/// Whether a folder holds the results of a reproduction.
bool holds_results(const std::filesystem::path& folder);

/// Writes the trained policies of the main reading's learning figures, the first seed of each, as ONNX files into
/// FOLDER/policies.
void write_headline_policies(const Reproduction& reproduction, const std::vector<Plan>& plans, const Store& store,
                             const std::filesystem::path& folder);

}  // namespace gust
