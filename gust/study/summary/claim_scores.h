#pragma once

#include <functional>
#include <map>
#include <optional>

#include "gust/stats/aggregate.h"
#include "gust/stats/bootstrap.h"
#include "gust/stats/formula.h"
#include "gust/study/summary/measurements.h"
#include "gust/study/summary/score_log.h"

namespace gust {

/// A study with what was measured in it. Without that it is all shape: every score is 1.
struct ClaimSource {
  const Study* study = nullptr;
  const Measurements* measured = nullptr;
  ScoreLog* log = nullptr;  ///< notes what is asked, under this name of the study
  std::string name = {};
};

/// How claims look at scores.
struct ClaimView {
  std::string metric;  ///< what score() means
  std::string start;   ///< of the evaluations
  Statistic over_seeds = Statistic::mean;
  bool one_training = false;  ///< resamples draw one seed of each trained policy, as if it had been trained once
};

/// The functions of claims that speak of studies. A policy and a sweep are looked up in the first study that has both.
///
///     score(policy)                     undisturbed, a number
///     score(policy, sweep)              along the sweep, a curve
///     score(policy, grid, value)        along a grid's second axis where the first one has the value
///     anr_h(…), survival(…), …          the same of any other metric
///     values(sweep), values(sweep, 2)   a list of a sweep's levels, or of those of its second axis
///     curve(policy), curve(policy, 'rmse_scg')   a column of the learning curve (anr_h) against all steps
///     own_curve(…)                      the same against the steps that the policy itself has learned from
///     curve_spread(…)                   the standard deviation of its seeds, against all steps
///
/// Every number is the mean (or what the view has) over training seeds (over episodes for a policy that is one alone),
/// a share of successes with the interval that share_interval gives it (sampled_share.h), and its resamples draw whole
/// seeds: the same ones for all that is asked of a policy, so that what its scores share
/// cancels, and for policies of the same trainings (other steps or risk levels). Others are drawn independently of each
/// other. A seed whose training ended without a policy is left out, and not counted; so it is in all policies of the
/// same trainings.
class ClaimScores final : public FormulaData {
 public:
  ClaimScores(std::vector<ClaimSource> sources, ClaimView view, Rng rng);

  std::vector<std::string> functions() const override;
  FormulaValue call(std::string_view function, const std::vector<FormulaValue>& arguments) const override;

  /// Seeds are trainings, or the files of one pattern; a policy that is one alone has none.
  std::optional<std::size_t> fewest_seeds() const override;

  /// One number of a metric: undisturbed where `sweep` is empty, else in the cell where the axes have these values.
  Sampled measured(const std::string& metric, const std::string& policy, const std::string& sweep,
                   std::span<const double> at) const;

 private:
  struct Place {
    const ClaimSource* source = nullptr;
    std::size_t policy = 0;
    std::size_t sweep = Trial::kNominal;
  };
  using Arguments = std::vector<FormulaValue>;
  using Statistics = std::function<double(std::span<const double>)>;

  static void check_count(std::string_view function, const Arguments& arguments, std::size_t most);
  Place find(const Arguments& arguments, std::string_view function) const;
  const Sweep& sweep_of(const FormulaValue& name) const;
  FormulaValue score(const std::string& metric, const Arguments& arguments) const;
  FormulaValue values(const Arguments& arguments) const;
  FormulaValue curve(std::string_view function, const Arguments& arguments) const;
  /// One number a cell of a sweep.
  const std::vector<Sampled>& cells(const Place& place, const std::string& metric) const;
  std::vector<Sampled> read_cells(const Place& place, const std::string& metric) const;
  /// Gives a curve along levels what its margin is measured from, or the reason why it has none.
  void add_margin(const Place& place, const std::string& metric, FormulaList& curve) const;
  /// Gives a curve the values at the levels that were looked at beside its own.
  void add_levels(const Place& place, const std::string& metric, FormulaList& curve) const;
  /// The learning curves of a policy's seeds, all as long as the shortest.
  std::vector<std::vector<CurvePoint>> curves(const Place& place) const;
  /// The members of a policy that count, in the order of their seeds.
  const std::vector<std::size_t>& members(const Place& place) const;
  std::vector<std::size_t> find_members(const Place& place) const;
  void count_seeds(const Place& place) const;
  /// What makes one number of a policy's units.
  Statistics over_units(const Place& place) const;
  /// The statistic of the units of a policy, and of its resamples.
  Sampled sampled(const Place& place, std::span<const double> units, const Statistics& statistic) const;
  bool draws_one(const Place& place) const;

  std::vector<ClaimSource> sources_;
  ClaimView view_;
  Rng rng_;
  mutable std::map<std::string, std::vector<Sampled>> known_;
  mutable std::map<std::string, Bootstrap> resampling_;
  mutable std::map<std::string, std::vector<std::size_t>> members_;
  mutable std::optional<std::size_t> fewest_seeds_;
};

}  // namespace gust
