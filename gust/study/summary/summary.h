#pragma once

#include "gust/stats/claim.h"
#include "gust/stats/margin.h"
#include "gust/study/summary/measurements.h"

namespace gust {

/// An estimate with the ends of its interval; NaN where there is none.
struct Estimate {
  double value = 0;
  double low = 0;
  double high = 0;
};

/// One policy along one sweep from one start, seeds and episodes taken together.
struct Series {
  std::size_t policy = 0;
  std::size_t sweep = Trial::kNominal;
  std::size_t start = 0;
  std::size_t cells = 0;
  std::vector<std::size_t> metrics = {};  ///< which ones: summarised_metrics()
  std::vector<Estimate> values = {};      ///< [metric][cell]
  /// The levels that the margins asked for beside the sweep's own, ascending, and what was measured there.
  std::vector<double> added_levels = {};
  std::vector<Estimate> added_values = {};  ///< [metric][added level]
  /// Of a sweep of one cell, for the first metric that the page leads with: what each training alone would have shown.
  std::vector<double> trainings = {};
  /// Of the same: how far the episodes of one training lie apart (standard deviation, mean over trainings).
  double episode_deviation = std::numeric_limits<double>::quiet_NaN();
  Unit unit = Unit::none;  ///< what the intervals were resampled over
  std::size_t units = 0;
  Margin margin = {};  ///< of the first metric that is better when higher; sweeps over levels only
  bool has_margin = false;
  std::size_t not_finite = 0;  ///< episodes with NaN or infinities

  /// One of `metrics` in a cell.
  const Estimate& at(std::size_t metric, std::size_t cell) const;
  /// The same at an added level.
  const Estimate& at_added(std::size_t metric, std::size_t level) const;
  /// Adds a level in its place, with a value for each of `metrics`.
  void add_level(double level, const std::vector<Estimate>& estimates);

 private:
  std::size_t row_of(std::size_t metric) const;
};

struct ClaimVerdict {
  const StudyClaim* claim = nullptr;
  Finding finding;
};

/// What a study found: everything that tables and the page show, in plan order. Memory per cell does not depend on
/// the number of episodes or seeds.
struct Summary {
  std::vector<Series> series;
  std::vector<ClaimVerdict> claims;  ///< all of them; not testable where a trial is missing
  std::vector<SeedCurve> curves;     ///< of all trainings that there are, in plan order
  std::vector<KeptTraces> kept;      ///< a choice that a page can hold, evenly over the plan
  std::size_t margin_metric = 0;
  std::vector<std::string> missing;  ///< what the study asks for and was not measured; for people
  std::vector<std::string> notes;    ///< what is wrong with a policy

  /// The series of a policy, sweep and start; null if its trials are missing.
  const Series* find(std::size_t policy, std::size_t sweep, std::size_t start) const;
  /// The score of the margins where nothing disturbs; NaN if that trial is missing.
  double undisturbed(std::size_t policy, std::size_t start) const;
};

/// The metrics that a summary holds: those that the page leads with, survival, saturation and the score of the margins.
/// The store and what is exported from it hold all.
std::vector<std::size_t> summarised_metrics(const Study& study);

/// Reads what was measured as a stream and summarises it. Equal rows give equal bits for any number of threads.
Summary summarise(const Measurements& measured, std::size_t threads);

/// The table of robustness margins, one line a site and waveform, one column a policy; UTF-8, for a terminal. What is
/// wider than `columns` is told in blocks of policies, one below the other.
std::string margins_table(const Study& study, const Summary& summary, std::size_t start, std::size_t columns);

/// The verdicts of the claims, one line each; where that is wider than `columns`, one below the other and wrapped.
std::string claims_table(const Summary& summary, std::size_t columns);

}  // namespace gust
