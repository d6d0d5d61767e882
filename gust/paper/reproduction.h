#pragma once

#include "gust/paper/paper.h"
#include "gust/study/summary/score_log.h"
#include "gust/study/summary/summary.h"

namespace gust {

/// What of a paper is to be run.
struct ReproductionChoice {
  std::string profile;                ///< empty: the paper's first one
  std::vector<std::string> only;      ///< names of studies; empty: all
  std::optional<std::int64_t> seeds;  ///< of every training, before the profile's

  bool operator==(const ReproductionChoice&) const = default;
};

/// One of the paper's studies under a reading that changes it.
struct ReproductionStudy {
  std::size_t reading = 0;
  std::size_t figure = 0;
  Study study;
};

/// All studies of a reproduction, ready to be run; those of the main reading come first, in the paper's order.
struct Reproduction {
  const Paper* paper = nullptr;
  ReproductionChoice choice;
  const PaperProfile* profile = nullptr;
  std::vector<ReproductionStudy> studies;
  bool fewer_seeds = false;  ///< some training has more in its study than are to be run

  /// Where a figure's study under a reading stands: where the reading leaves it alone, that of the reading that it is
  /// like, or of the main one. None if it is not to be run.
  std::optional<std::size_t> find(std::size_t reading, std::string_view study) const;
  /// Where its results lie: "scg-2022/white".
  std::string stem(const ReproductionStudy& study) const;
  /// The same of the study that a figure is drawn from.
  std::optional<std::size_t> drawn(const PaperFigure& figure) const {
    return find(paper->reading(figure.reading), figure.study);
  }
};

/// Throws Error where the profile or a study is not known, or a study cannot be read.
Reproduction open_reproduction(const Paper& paper, const ReproductionChoice& choice);

/// What became of a claim under a reading.
struct PaperVerdict {
  std::size_t claim = 0;
  std::size_t reading = 0;
  Interval measured;  ///< by how much the part that decides is true, in its unit; below 0 if it is not
  Verdict verdict;
  std::size_t seeds = 0;  ///< the fewest of any trained policy that was asked; 0 if none was
  /// How likely it is to be true of one training of each policy, drawn from the seeds. Not a number where there are
  /// fewer than kSeedsForVerdict, or one training says nothing of the claim: of intervals, or how seeds differ.
  double one_training = std::numeric_limits<double>::quiet_NaN();
  double share = std::numeric_limits<double>::quiet_NaN();  ///< of the resamples of the seeds in which it is true
  std::size_t parts = 0;           ///< statements that the claim puts together (Truth); 0 where it could not be asked
  std::size_t true_parts = 0;      ///< those that are true, at the estimate
  std::size_t left_out_parts = 0;  ///< beside them: those whose premise did not happen here

  std::vector<PartFinding> each_part = {};  ///< what became of every part; not kept with the results
  Ruling widened = Ruling::not_testable;    ///< by intervals that are wide enough for so few seeds (Finding)

  bool decided() const { return verdict.ruling == Ruling::holds || verdict.ruling == Ruling::fails; }
  Grade grade() const { return grade_of(verdict.ruling, parts, true_parts, left_out_parts); }
};

/// What was measured in each study of a reproduction, in their order.
using StudyMeasurements = std::span<const std::unique_ptr<Measurements>>;

/// Asks every claim of the data under each reading that bears on it; the reading that decides comes first. Claims whose
/// studies are not to be run are left out, and so are all but those named, if any are. `log` notes the scores that were
/// asked for. Equal data give equal bits for any number of threads.
std::vector<PaperVerdict> judge_paper(const Reproduction& reproduction, StudyMeasurements measured, std::size_t threads,
                                      const std::vector<std::string>& named = {}, ScoreLog* log = nullptr);

/// Asks every claim under every reading of data that have shapes only, so that what is wrong with one is found before
/// any work.
void check_claims(const Reproduction& reproduction);

}  // namespace gust
