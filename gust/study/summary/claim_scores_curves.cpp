#include <algorithm>
#include <limits>

#include "gust/core/text.h"
#include "gust/stats/statistics.h"
#include "gust/study/summary/claim_scores.h"

namespace gust {
namespace {

/// A column of curve.csv by its name.
double CurvePoint::*curve_column(const std::string& name) {
  std::vector<std::string> known;
  for (const CurveColumn& column : kCurveColumns) {
    if (name == column.name) return column.value;
    known.emplace_back(column.name);
  }
  throw Error(cat("a learning curve has no '", name, "'", did_you_mean(name, known), "; it has ", join(known, ", ")));
}

}  // namespace

FormulaValue ClaimScores::curve(std::string_view function, const Arguments& arguments) const {
  check_count(function, arguments, 2);
  const auto column =
      arguments.size() == 2 ? curve_column(arguments[1].as_text(cat("'", function, "'"))) : &CurvePoint::anr_h;
  const Place place = find({arguments[0]}, function);
  count_seeds(place);
  const std::vector<std::vector<CurvePoint>> seeds = curves(place);
  FormulaList list;
  for (std::size_t i = 0; i < seeds.front().size(); ++i) {
    std::vector<double> units;
    for (const std::vector<CurvePoint>& seed : seeds) units.push_back(seed[i].*column);
    const CurvePoint& point = seeds.front()[i];
    list.axis.push_back(static_cast<double>(function == "own_curve" ? point.protagonist_steps : point.steps));
    list.items.push_back({sampled(place, units, function == "curve_spread" ? sample_deviation : over_units(place))});
  }
  return {std::move(list)};
}

std::vector<std::vector<CurvePoint>> ClaimScores::curves(const Place& place) const {
  const StudyPolicy& policy = place.source->study->policies[place.policy];
  if (!policy.training()) throw Error(cat("policy '", policy.name, "' is not trained: it has no learning curve"));
  std::vector<std::vector<CurvePoint>> curves;
  if (place.source->measured == nullptr) {
    constexpr std::int64_t kFar = std::numeric_limits<std::int64_t>::max();
    curves.push_back({{.steps = 0, .anr_h = 1}, {.steps = kFar, .anr_h = 1, .protagonist_steps = kFar}});
    return curves;
  }
  std::vector<std::string> missing;
  for (const std::size_t member : members(place)) {
    auto curve = place.source->measured->curve(place.policy, member, missing);
    if (!curve) throw NotTestable(cat("not measured: ", missing.front()));
    curves.push_back(std::move(*curve));
  }
  GUST_CHECK(!curves.empty());
  std::size_t shortest = curves.front().size();
  for (const auto& curve : curves) shortest = std::min(shortest, curve.size());
  for (auto& curve : curves) curve.resize(shortest);
  if (shortest == 0) throw NotTestable(cat("a training of '", policy.name, "' ended before its first point"));
  return curves;
}

}  // namespace gust
