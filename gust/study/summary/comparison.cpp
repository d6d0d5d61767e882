#include "gust/study/summary/comparison.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "gust/core/crew.h"
#include "gust/study/summary/margin_data.h"
#include "gust/study/trials/margin_trial.h"

namespace gust {
namespace {

constexpr std::size_t kMostPolicies = 6;  // of which all pairs are shown

/// The places of the cells: levels, or their numbers in a grid.
std::vector<double> places_of(const Study& study, std::size_t sweep, std::size_t count) {
  if (sweep != Trial::kNominal && study.sweeps[sweep].axes.size() == 1) return study.sweeps[sweep].axes.front().values;
  std::vector<double> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0.0);
  return numbers;
}

struct OwnedCurve {
  std::vector<double> levels;
  std::vector<Matrix<double>> values;
  std::vector<Cell> cells;
  bool repeats = false;  // all episodes are the same one

  Curve view() const { return {levels, cells}; }
  /// To be called when all values are there.
  void show() {
    for (const Matrix<double>& cell : std::as_const(values)) cells.push_back(cell.view());
  }
};

/// The scores of one policy, cell after cell; empty where they are missing.
OwnedCurve curve_of(const Measurements& measured, const SweepOf& of) {
  const Study& study = measured.study();
  const std::string& metric = study.metric_set.name(margin_metric(study));
  std::vector<std::string> missing;
  MemberRows rows = measured.rows(measured.group(of.policy, of.sweep), missing);
  OwnedCurve curve;
  if (rows.members() == 0 || !rows.has(metric)) return curve;
  curve.repeats = rows.repeats(of.start);
  while (rows.next()) curve.values.push_back(rows.values(of.start, metric));
  curve.levels = places_of(study, of.sweep, curve.values.size());
  if (curve.levels.size() != curve.values.size()) curve.values.clear();
  return curve;
}

/// A policy's margin without what is not there: some of its seeds may be missing.
std::shared_ptr<const MarginData> margin_of(const Measurements& measured, const SweepOf& of) {
  const Study& study = measured.study();
  std::vector<std::string> missing;
  MemberRows rows = measured.rows(measured.group(of.policy, Trial::kNominal), missing);
  if (rows.members() == 0 || !rows.next() || !margin_obstacle(study, of.sweep, rows, of.start).empty()) return nullptr;
  return read_margin_data(measured, of, study.metric_set.name(margin_metric(study)));
}

/// Seeds of a policy that has some: trainings, or several files.
std::size_t seeds_of(const Study& study, std::size_t policy, const OwnedCurve& curve) {
  const StudyPolicy& of = study.policies[policy];
  return of.training() || of.count() > 1 ? curve.cells.front().rows : 0;
}

std::optional<SweepComparison> compare_along(const Measurements& measured, const PolicyPair& pair, std::size_t sweep) {
  const Study& study = measured.study();
  const SweepOf of_a{pair.a, sweep, pair.start}, of_b{pair.b, sweep, pair.start};
  OwnedCurve a = curve_of(measured, of_a), b = curve_of(measured, of_b);
  if (a.values.empty() || b.values.empty()) return std::nullopt;
  a.show();
  b.show();
  const std::size_t seeds_a = seeds_of(study, pair.a, a), seeds_b = seeds_of(study, pair.b, b);
  const Rng rng = comparison_stream(study);
  SweepComparison result{pair, sweep, compare(a.view(), b.view(), rng)};
  result.repeats = a.repeats && b.repeats;
  result.seeds = seeds_a == 0 || seeds_b == 0 ? std::max(seeds_a, seeds_b) : std::min(seeds_a, seeds_b);
  if (sweep == Trial::kNominal || !study.sweeps[sweep].along_levels() || a.levels.size() < 2) return result;
  const auto margin_a = margin_of(measured, of_a), margin_b = margin_of(measured, of_b);
  if (margin_a && margin_b) result.found.ratio = margin_ratio(*margin_a, *margin_b);
  return result;
}

}  // namespace

Standing SweepComparison::standing_of(const Interval& difference) const {
  return seeds > 0 && seeds < kSeedsForVerdict ? Standing::undecided : standing(difference);
}

std::size_t SweepComparison::count(Standing wanted) const {
  return static_cast<std::size_t>(std::ranges::count_if(
      found.scores, [&](const PairedDifference& at) { return standing_of(at.interval) == wanted; }));
}

std::string SweepComparison::needed() const {
  if (seeds > 0 && seeds < kSeedsForVerdict)
    return cat(seeds, seeds == 1 ? " seed; five are needed" : " seeds; five are needed");
  if (standing(found.over.interval) != Standing::undecided) return "";
  if (repeats && found.over.unit == Unit::none)
    return "every episode is the same one, so more of them decide nothing; a random start would";
  if (repeats && std::isnan(found.over.needed)) return "more seeds of both policies would decide";
  return needed_text(found.over.needed, found.over.unit);
}

std::vector<SweepComparison> compare_policies(const Measurements& measured, const PolicyPair& pair) {
  return compare_pairs(measured, {pair}, 1);
}

std::vector<PolicyPair> shown_pairs(const Study& study, std::size_t start) {
  std::vector<PolicyPair> pairs;
  const std::size_t policies = study.policies.size();
  for (std::size_t a = 0; a < policies && (a == 0 || policies <= kMostPolicies); ++a) {
    for (std::size_t b = a + 1; b < policies; ++b) pairs.push_back({a, b, start});
  }
  return pairs;
}

std::size_t compared_start(const Study& study) {
  const auto random = std::ranges::find_if(study.starts, &StartProtocol::random);
  return random == study.starts.end() ? 0 : static_cast<std::size_t>(random - study.starts.begin());
}

std::vector<SweepComparison> compare_pairs(const Measurements& measured, const std::vector<PolicyPair>& pairs,
                                           std::size_t threads) {
  const std::size_t width = measured.study().sweeps.size() + 1;  // undisturbed first
  std::vector<std::optional<SweepComparison>> found(pairs.size() * width);
  for_each_item(threads, found.size(), [&] {
    return [&](std::size_t i) {
      found[i] = compare_along(measured, pairs[i / width], i % width == 0 ? Trial::kNominal : i % width - 1);
    };
  });
  std::vector<SweepComparison> result;
  for (std::optional<SweepComparison>& one : found) {
    if (one) result.push_back(std::move(*one));
  }
  return result;
}

}  // namespace gust
