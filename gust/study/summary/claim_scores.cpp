#include "gust/study/summary/claim_scores.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "gust/core/hash.h"
#include "gust/core/text.h"
#include "gust/stats/aggregate.h"
#include "gust/stats/resampled_mean.h"
#include "gust/stats/sampled_share.h"
#include "gust/stats/statistics.h"
#include "gust/study/summary/margin_data.h"
#include "gust/study/trials/margin_trial.h"

namespace gust {
namespace {

constexpr std::size_t kResamples = 2'000;
constexpr std::string_view kSameEpisodes =
    "every episode from this start is the same one; a random start would give an interval";

std::vector<std::string> names_of(const auto& items) {
  std::vector<std::string> names;
  for (const auto& item : items) names.push_back(item.name);
  return names;
}

/// The levels of an axis; of a grid that is still to be found, any two.
std::vector<double> levels_of(const Sweep& sweep, std::size_t axis) {
  const std::vector<double>& levels = sweep.axes[axis].values;
  constexpr double kFar = std::numeric_limits<double>::max();
  return levels.empty() ? std::vector<double>{-kFar, kFar} : levels;  // not found yet: any level may be among them
}

template <class Items>
std::size_t index_of(const Items& items, const std::string& name) {
  return static_cast<std::size_t>(std::ranges::find(items, name, &Items::value_type::name) - items.begin());
}

FormulaList listed(const std::vector<double>& axis, std::span<const Sampled> values) {
  FormulaList list;
  list.axis = axis;
  for (const Sampled& value : values) list.items.push_back({value});
  return list;
}

/// What policies have in common whose seeds are the same trainings: a longer one goes on where a shorter one ends, and
/// a risk level is chosen when the policy acts. The streams of resamples are named by this text, so it stays as it is.
std::string seeds_key(const Study& study, const StudyPolicy& policy) {
  const PolicyTraining* training = policy.training();
  if (training == nullptr) return policy.name;
  const std::string rest = training->agent.options.without("steps").text();
  std::string key = cat(training->agent.kind, "(", rest.empty() ? "" : ", ", rest, ")");
  for (const Injection& injection : training->disturbed)
    key += cat("; ", injection.canonical(), " ", canonical_text(injection.level));
  return cat(key, "; ", training->randomised.canonical(study.setup.plant->spec()),
             training->curve_as_trained ? "; curve" : "");
}

/// The seeds of a policy whose trainings did not end without one.
std::set<std::int64_t> seeds_left(const ClaimSource& source, const StudyPolicy& policy) {
  const PolicyTraining& training = *policy.training();
  std::set<std::int64_t> seeds(training.seeds.begin(), training.seeds.end());
  if (source.measured == nullptr) return seeds;
  const auto index = static_cast<std::size_t>(&policy - source.study->policies.data());
  for (std::size_t member = 0; member < policy.count(); ++member) {
    if (source.measured->training_failed(index, member)) seeds.erase(training.seeds[member]);
  }
  return seeds;
}

}  // namespace

ClaimScores::Statistics ClaimScores::over_units(const Place& place) const {
  const bool trained = place.source->study->policies[place.policy].training() != nullptr;
  if (!trained || view_.over_seeds == Statistic::mean) return mean;
  return [statistic = view_.over_seeds](std::span<const double> units) { return aggregate(statistic, units); };
}

bool ClaimScores::draws_one(const Place& place) const {
  return view_.one_training && place.source->study->policies[place.policy].training() != nullptr;
}

/// A single unit has no resamples that would say anything: they are not numbers.
Sampled ClaimScores::sampled(const Place& place, std::span<const double> units, const Statistics& statistic) const {
  const Study& study = *place.source->study;
  Sampled result{std::vector<double>(1 + kResamples, std::numeric_limits<double>::quiet_NaN())};
  result.n = units.size();
  result.values[0] = statistic(units);
  if (units.size() < 2) return result;
  result.unit = members(place).size() > 1 ? Unit::seeds : Unit::episodes;
  const std::string key = seeds_key(study, study.policies[place.policy]);
  const Rng rng = rng_.split("claims").split(key);
  if (draws_one(place)) {
    const Rng draws = rng.split("one");
    for (std::size_t k = 0; k < kResamples; ++k)
      result.values[1 + k] = statistic(units.subspan(draws.below(units.size(), k), 1));
    return result;
  }
  Bootstrap& bootstrap = resampling_.try_emplace(key, rng, kResamples).first->second;
  const auto* plain = statistic.target<double (*)(std::span<const double>)>();
  if (units.size() > Bootstrap::kMostGroups && plain != nullptr && *plain == mean && all_finite(units)) {
    const GroupedValues grouped(units);
    const std::size_t strata[] = {grouped.groups()};
    bootstrap.for_each_block(strata, [&](std::size_t first, const Rows<const std::uint16_t>& times) {
      grouped.resampled_means(times, std::span(result.values).subspan(1 + first, times.lanes));
    });
    return result;
  }
  const std::size_t strata[] = {units.size()};
  std::vector<double> drawn;
  bootstrap.for_each_block(strata, [&](std::size_t first, const Rows<const std::uint16_t>& times) {
    for (std::size_t k = 0; k < times.lanes; ++k) {
      drawn.clear();
      for (std::size_t u = 0; u < units.size(); ++u) drawn.insert(drawn.end(), times.at(u, k), units[u]);
      result.values[1 + first + k] = statistic(std::span<const double>(drawn));
    }
  });
  return result;
}

void ClaimScores::check_count(std::string_view function, const Arguments& arguments, std::size_t most) {
  if (arguments.empty() || arguments.size() > most)
    throw Error(cat("'", function, "' takes 1 to ", most, " arguments, got ", arguments.size()));
}

ClaimScores::ClaimScores(std::vector<ClaimSource> sources, ClaimView view, Rng rng)
    : sources_(std::move(sources)), view_(std::move(view)), rng_(rng) {}

std::vector<std::string> ClaimScores::functions() const {
  std::vector<std::string> names = {"score", "values", "curve", "own_curve", "curve_spread"};
  const MetricSet& metrics = sources_.front().study->metric_set;
  for (std::size_t i = 0; i < metrics.size(); ++i) names.push_back(metrics.name(i));
  return names;
}

FormulaValue ClaimScores::call(std::string_view function, const Arguments& arguments) const {
  if (function == "values") return values(arguments);
  if (function.ends_with("curve") || function == "curve_spread") return curve(function, arguments);
  return score(function == "score" ? view_.metric : std::string(function), arguments);
}

std::optional<std::size_t> ClaimScores::fewest_seeds() const { return std::exchange(fewest_seeds_, std::nullopt); }

Sampled ClaimScores::measured(const std::string& metric, const std::string& policy, const std::string& sweep,
                              std::span<const double> at) const {
  const Place place = find(sweep.empty() ? Arguments{{policy}} : Arguments{{policy}, {sweep}}, metric);
  count_seeds(place);
  const std::vector<Sampled>& all = cells(place, metric);
  std::size_t cell = 0;
  for (std::size_t a = 0; a < at.size(); ++a) {
    const std::vector<double>& values = place.source->study->sweeps[place.sweep].axes[a].values;
    const auto found = std::ranges::find(values, at[a]);
    if (found == values.end()) throw NotTestable(cat("not measured: ", sweep, " at ", at[a]));
    cell = cell * values.size() + static_cast<std::size_t>(found - values.begin());
  }
  return all[cell];
}

ClaimScores::Place ClaimScores::find(const Arguments& arguments, std::string_view function) const {
  const std::string& policy = arguments[0].as_text(cat("'", function, "'"));
  const std::string sweep = arguments.size() < 2 ? "" : arguments[1].as_text(cat("'", function, "'"));
  std::vector<std::string> policies, sweeps;
  for (const ClaimSource& source : sources_) {
    const Study& study = *source.study;
    const Place place{&source, index_of(study.policies, policy),
                      sweep.empty() ? Trial::kNominal : index_of(study.sweeps, sweep)};
    const bool has_policy = place.policy < study.policies.size();
    if (has_policy && (sweep.empty() || place.sweep < study.sweeps.size())) return place;
    std::ranges::move(names_of(study.policies), std::back_inserter(policies));
    if (has_policy) std::ranges::move(names_of(study.sweeps), std::back_inserter(sweeps));
  }
  if (std::ranges::find(policies, policy) == policies.end())
    throw Error(cat("unknown policy '", policy, "'", did_you_mean(policy, policies)));
  throw Error(cat("policy '", policy, "' has no sweep '", sweep, "'", did_you_mean(sweep, sweeps)));
}

const Sweep& ClaimScores::sweep_of(const FormulaValue& name) const {
  const std::string& text = name.as_text("'values'");
  std::vector<std::string> sweeps;
  for (const ClaimSource& source : sources_) {
    const std::size_t at = index_of(source.study->sweeps, text);
    if (at < source.study->sweeps.size()) return source.study->sweeps[at];
    std::ranges::move(names_of(source.study->sweeps), std::back_inserter(sweeps));
  }
  throw Error(cat("unknown sweep '", text, "'", did_you_mean(text, sweeps)));
}

const std::vector<std::size_t>& ClaimScores::members(const Place& place) const {
  const auto [known, is_new] = members_.try_emplace(cat(place.source - sources_.data(), "/", place.policy));
  if (is_new) known->second = find_members(place);
  if (known->second.empty())
    throw NotTestable(
        cat("no training of '", place.source->study->policies[place.policy].name, "' ended with a policy"));
  return known->second;
}

std::vector<std::size_t> ClaimScores::find_members(const Place& place) const {
  const StudyPolicy& policy = place.source->study->policies[place.policy];
  std::vector<std::size_t> members;
  for (std::size_t member = 0; member < policy.count(); ++member) members.push_back(member);
  const PolicyTraining* training = policy.training();
  if (training == nullptr) return members;
  const std::string key = seeds_key(*place.source->study, policy);
  for (const ClaimSource& source : sources_) {
    for (const StudyPolicy& other : source.study->policies) {
      if (!other.training() || seeds_key(*source.study, other) != key) continue;
      const std::set<std::int64_t> left = seeds_left(source, other);
      std::erase_if(members, [&](std::size_t member) { return !left.contains(training->seeds[member]); });
    }
  }
  std::ranges::sort(members, {}, [&](std::size_t member) { return training->seeds[member]; });
  return members;
}

void ClaimScores::count_seeds(const Place& place) const {
  const StudyPolicy& policy = place.source->study->policies[place.policy];
  if (!policy.training() && policy.count() < 2) return;
  const std::size_t count = members(place).size();
  fewest_seeds_ = std::min(fewest_seeds_.value_or(count), count);
}

FormulaValue ClaimScores::score(const std::string& metric, const Arguments& arguments) const {
  check_count(metric, arguments, 3);
  const Place place = find(arguments, metric);
  count_seeds(place);
  if (place.sweep == Trial::kNominal) return {cells(place, metric).front()};
  const Sweep& sweep = place.source->study->sweeps[place.sweep];
  const std::vector<Sweep::Axis>& axes = sweep.axes;
  const std::vector<Sampled>& all = cells(place, metric);
  if (axes.size() == 1) {
    if (arguments.size() == 3) throw Error("a curve has one axis; its value at a level is at(score(…), level)");
    FormulaList curve = listed(levels_of(sweep, 0), all);
    if (sweep.along_levels()) add_margin(place, metric, curve);
    return {std::move(curve)};
  }
  if (arguments.size() < 3) return {listed({}, all)};
  const Sampled& row = arguments[2].as_number(cat("'", metric, "'"));
  const auto at = std::ranges::find(axes[0].values, row.estimate());
  if (at == axes[0].values.end())
    throw Error(cat("the grid has no ", axes[0].parameter, " of ", row.estimate(), "; see values(grid)"));
  const std::size_t width = axes[1].values.size();
  const auto first = static_cast<std::size_t>(at - axes[0].values.begin()) * width;
  return {listed(axes[1].values, std::span(all).subspan(first, width))};
}

FormulaValue ClaimScores::values(const Arguments& arguments) const {
  check_count("values", arguments, 2);
  const Sweep& sweep = sweep_of(arguments[0]);
  const double which = arguments.size() == 2 ? arguments[1].as_number("'values'").estimate() : 1.0;
  if (!(which >= 1.0) || which > static_cast<double>(sweep.axes.size()))
    throw Error(cat("the sweep has ", sweep.axes.size(), sweep.axes.size() == 1 ? " axis" : " axes", ", not ", which));
  const std::vector<double> levels = levels_of(sweep, static_cast<std::size_t>(which) - 1);
  std::vector<Sampled> constants;
  for (const double level : levels) constants.push_back(Sampled::constant(level));
  return {listed(levels, constants)};
}

const std::vector<Sampled>& ClaimScores::cells(const Place& place, const std::string& metric) const {
  const std::string key = cat(place.source - sources_.data(), "/", place.policy, "/", place.sweep, "/", metric);
  const auto known = known_.find(key);
  return known != known_.end() ? known->second : known_.emplace(key, read_cells(place, metric)).first->second;
}

void ClaimScores::add_margin(const Place& place, const std::string& metric, FormulaList& curve) const {
  const Sweep& sweep = place.source->study->sweeps[place.sweep];
  curve.no_margin = levels_obstacle(sweep);
  if (!curve.no_margin.empty() || place.source->measured == nullptr) return;
  const Place nominal{place.source, place.policy, Trial::kNominal};
  try {
    const std::string survival = place.source->study->metric_set.name_of(MetricRole::survival);
    if (!survival.empty()) curve.no_margin = survival_obstacle(cells(nominal, survival).front().estimate());
    Sampled undisturbed = cells(nominal, metric).front();
    if (undisturbed.n < 2) undisturbed = Sampled::constant(undisturbed.estimate());  // one episode, from a fixed start
    curve.undisturbed = std::move(undisturbed);
  } catch (const NotTestable& missing) {
    curve.no_margin = missing.what();
    return;
  }
  if (sweep.disturbed.empty() && sweep.parameters.empty()) {
    curve.added = {{*curve.undisturbed}};
    curve.added_axis = {0.0};
  }
  add_levels(place, metric, curve);
  if (view_.over_seeds != Statistic::mean || draws_one(place)) return;  // the table's margins are of the mean
  curve.margin_data = [this, place, metric] {
    const std::size_t start = index_of(place.source->study->starts, view_.start);
    return read_margin_data(*place.source->measured, {place.policy, place.sweep, start}, metric, members(place));
  };
}

void ClaimScores::add_levels(const Place& place, const std::string& metric, FormulaList& curve) const {
  const ClaimSource& source = *place.source;
  if (source.measured == nullptr) return;
  const std::size_t start = index_of(source.study->starts, view_.start);
  const std::size_t count = members(place).size();
  source.measured->for_each_added_level(place.policy, place.sweep, [&](double level, const MemberRows& rows) {
    if (rows.members() != count || !rows.has(metric) || level >= curve.axis.back()) return;
    const Matrix<double> values = rows.values(start, metric);
    curve.added.push_back({sampled(place, unit_values(values.view()), over_units(place))});
    curve.added_axis.push_back(level);
  });
}

std::vector<Sampled> ClaimScores::read_cells(const Place& place, const std::string& metric) const {
  const Study& study = *place.source->study;
  const bool is_share = study.metric_set[study.metric_set.index(metric, {"score"})].traits().zero_or_one;
  const std::size_t start = index_of(study.starts, view_.start);
  if (start == study.starts.size()) throw Error(cat("the study '", study.name, "' has no start '", view_.start, "'"));
  if (place.source->measured == nullptr) {
    std::size_t count = 1;
    for (std::size_t a = 0; place.sweep != Trial::kNominal && a < study.sweeps[place.sweep].axes.size(); ++a)
      count *= levels_of(study.sweeps[place.sweep], a).size();
    return std::vector<Sampled>(count, Sampled{{1.0, 1.0}});  // measured: no constants
  }
  std::vector<std::string> missing;
  std::vector<Sampled> cells;
  std::vector<float> all_units;
  const Measurements& measured = *place.source->measured;
  MemberRows rows = measured.rows({place.policy, place.sweep, members(place)}, missing);
  if (!missing.empty()) throw NotTestable(cat("not measured: ", missing.front()));
  if (!rows.has(metric)) throw NotTestable(cat("not measured: ", metric, " of ", study.policies[place.policy].name));
  while (rows.next()) {
    const Matrix<double> values = rows.values(start, metric);
    const std::vector<double> units = unit_values(values.view());
    all_units.insert(all_units.end(), units.begin(), units.end());
    Sampled cell = sampled(place, units, over_units(place));
    if (is_share && cell.n > 1 && !draws_one(place)) {
      const std::string key = seeds_key(study, study.policies[place.policy]);
      const Rng noise = rng_.split("shares").split(key);
      const std::string own = cat(study.name, "/", place.sweep, "/", metric, "/", cells.size());
      cell = sampled_share(std::move(cell), values.rows() * values.lanes(), noise, noise.split(own));
    }
    const bool alone = !study.policies[place.policy].training() && cell.n == 1;
    if (alone && rows.repeats(start)) cell.limit = kSameEpisodes;
    cells.push_back(std::move(cell));
  }
  if (cells.empty()) throw NotTestable(cat("not measured: ", study.policies[place.policy].name));
  if (place.source->log != nullptr) {
    const StudyPolicy& policy = study.policies[place.policy];
    place.source->log->note({place.source->name, policy.name,
                             place.sweep == Trial::kNominal ? "" : study.sweeps[place.sweep].name, view_.start, metric,
                             hash_hex(seeds_key(study, policy)).substr(0, 8), cells.front().n, std::move(all_units)});
  }
  return cells;
}

}  // namespace gust
