#include <algorithm>
#include <cmath>

#include "gust/eval/claim.h"
#include "gust/study/parse.h"

namespace gust {
namespace {

constexpr std::size_t kMostCells = 2'000'000;

std::vector<double> spaced(const Table& table, std::string_view what) {
  check_keys(table, {"from", "to", "count"}, what);
  const Value* from = table.find("from");
  const Value* to = table.find("to");
  const Value* count = table.find("count");
  if (!from || !to || !count)
    throw error_at(table.place, "'", what, "' needs from, to and count, such as { from = 0, to = 15, count = 11 }");
  std::int64_t points = 0;
  read_value(points, *count, "count", between(1, static_cast<double>(kMostCells)));
  const double low = from->as_number("from");
  const double high = to->as_number("to");
  if (points > 1 && !(low < high)) throw error_at(to->place, "'to' must be above 'from', got ", low, " and ", high);
  std::vector<double> values;
  for (std::int64_t i = 0; i < points; ++i) {
    const double share = points == 1 ? 0.0 : static_cast<double>(i) / static_cast<double>(points - 1);
    values.push_back(i == points - 1 && points > 1 ? high : low + (high - low) * share);
  }
  return values;
}

/// Values of a parameter: absolute, or factors of the nominal value.
Sweep::Axis parameter_axis(const std::string& name, const Value& values, double unit, const Study& study) {
  const PlantSpec& spec = study.setup.plant->spec();
  Sweep::Axis axis{name, parameter_index(spec, name, values.place), parse_levels(values, name)};
  for (double& value : axis.values) {
    value *= unit;
    if (!(value > 0)) throw error_at(values.place, "'", name, "' must be > 0, got ", value);
  }
  return axis;
}

void parse_vary(const Table& table, const Study& study, Sweep& sweep) {
  check_keys(table, {"name", "vary", "scale", "values"}, "a sweep over a parameter");
  const Value* scale = table.find("scale");
  const Value* values = table.find("values");
  if ((scale == nullptr) == (values == nullptr)) {
    throw error_at(table.place,
                   "a sweep over a parameter needs either 'values' or 'scale' (factors of the nominal value)");
  }
  const std::string& name = table.find("vary")->as_text("vary");
  const std::size_t index = parameter_index(study.setup.plant->spec(), name, table.find("vary")->place);
  const double nominal = study.setup.plant->spec().parameters[index].nominal;
  sweep.axes.push_back(scale ? parameter_axis(name, *scale, nominal, study)
                             : parameter_axis(name, *values, 1.0, study));
}

void parse_grid(const Table& table, const Study& study, Sweep& sweep) {
  check_keys(table, {"name", "grid"}, "a sweep over a grid");
  const Table& grid = table.find("grid")->as_table("grid");
  if (grid.items.size() != 2) throw error_at(grid.place, "'grid' needs two parameters, got ", grid.items.size());
  for (const auto& [name, values] : grid.items) sweep.axes.push_back(parameter_axis(name, values, 1.0, study));
}

void parse_disturbance(const Table& table, const Study& study, Sweep& sweep) {
  const Value* levels = table.find("levels");
  if (levels == nullptr)
    throw error_at(table.place, "sweep '", sweep.name, "' needs 'levels', such as { from = 0, to = 15, count = 11 }");
  if (table.contains("level")) throw error_at(table.find("level")->place, "a sweep has 'levels', not a 'level'");
  sweep.injection = read_injection(table, study.setup.plant->spec(), {"name", "levels"});
  const auto* word = std::get_if<std::string>(&levels->data);
  if (word != nullptr && *word != "auto")
    throw error_at(levels->place, "'levels' must be a list, a range or \"auto\", got '", *word, "'");
  sweep.automatic = word != nullptr;
  sweep.axes.push_back({});
  if (!sweep.automatic) sweep.axes.front().values = parse_levels(*levels, "levels");
}

/// What stands on an axis: all of it if that is short, else the value nearest to the one that was wanted.
std::string offer(const Sweep::Axis& axis, double wanted) {
  constexpr std::size_t kShort = 12;
  const std::vector<double>& values = axis.values;
  if (values.size() <= kShort) return cat("it has ", canonical_text(values));
  const auto nearest = std::ranges::min_element(values, {}, [&](double v) { return std::abs(v - wanted); });
  return cat("the nearest of its ", values.size(), " is ", *nearest);
}

/// One value per axis of the sweep: `level`, or the parameters by name.
std::vector<double> claim_point(const Table& where, const Sweep& sweep) {
  std::vector<double> at;
  for (const Sweep::Axis& axis : sweep.axes) {
    const std::string key = axis.parameter.empty() ? "level" : axis.parameter;
    const Value* value = where.find(key);
    if (value == nullptr) throw error_at(where.place, "'where' needs '", key, "' for sweep '", sweep.name, "'");
    const double wanted = value->as_number(key);
    const auto nearest = std::ranges::find_if(
        axis.values, [&](double v) { return std::abs(v - wanted) <= 1e-9 * std::max(1.0, std::abs(v)); });
    if (nearest == axis.values.end() && !sweep.automatic) {
      throw error_at(value->place, "sweep '", sweep.name, "' has no ", key, " ", wanted, "; ", offer(axis, wanted));
    }
    if (sweep.automatic && wanted < 0) throw error_at(value->place, "automatic levels begin at 0, got ", wanted);
    at.push_back(nearest == axis.values.end() ? wanted : *nearest);
  }
  return at;
}

}  // namespace

std::vector<double> parse_levels(const Value& value, std::string_view what) {
  if (const auto* table = std::get_if<Table>(&value.data)) return spaced(*table, what);
  std::vector<double> levels = value.as_numbers(what);
  if (levels.empty()) throw error_at(value.place, "'", what, "' must not be empty");
  for (std::size_t i = 1; i < levels.size(); ++i) {
    if (!(levels[i - 1] < levels[i])) {
      throw error_at(value.place, "'", what, "' must ascend, got ", levels[i - 1], " before ", levels[i]);
    }
  }
  return levels;
}

Sweep parse_sweep(const Table& table, const Study& study) {
  Sweep sweep;
  sweep.name = checked_name(table, "name", "a sweep");
  sweep.place = table.place;
  if (table.contains("vary")) {
    parse_vary(table, study, sweep);
  } else if (table.contains("grid")) {
    parse_grid(table, study, sweep);
  } else {
    parse_disturbance(table, study, sweep);
  }
  if (sweep.cells() > kMostCells)
    throw error_at(table.place, "sweep '", sweep.name, "' has ", sweep.cells(), " cells; at most ", kMostCells);
  return sweep;
}

StudyClaim parse_claim_of(const Table& table, const Study& study) {
  check_keys(table, {"id", "text", "where", "holds", "required"}, "a claim");
  StudyClaim claim;
  claim.place = table.place;
  claim.id = checked_name(table, "id", "a claim");
  if (table.contains("text")) claim.text = required_text(table, "text", "a claim");
  claim.holds = required_text(table, "holds", "a claim");
  std::vector<std::string> names;
  for (std::size_t i = 0; i < study.metric_set.size(); ++i) names.push_back(study.metric_set.name(i));
  parse_claim(claim.holds, names, table.find("holds")->place);
  if (const Value* required = table.find("required")) claim.required = required->as_bool("required");

  const Value* where_value = table.find("where");
  if (where_value == nullptr)
    throw error_at(table.place, "a claim needs 'where', such as { policy = \"ppo\", sweep = \"step\", level = 2 }");
  const Table& where = where_value->as_table("where");
  const Value* policy = where.find("policy");
  if (policy == nullptr) throw error_at(where.place, "'where' needs a 'policy'");
  claim.policy = named(study.policies, *policy, "policy").name;
  std::vector<std::string> known = {"policy", "sweep", "start"};
  claim.start = study.starts.front().name;
  for (const StartProtocol& start : study.starts) {
    if (start.random) claim.start = start.name;  // the protocol that carries intervals
  }
  if (const Value* start = where.find("start")) claim.start = named(study.starts, *start, "start").name;
  if (const Value* name = where.find("sweep")) {
    const Sweep& sweep = named(study.sweeps, *name, "sweep");
    claim.sweep = sweep.name;
    claim.at = claim_point(where, sweep);
    for (const Sweep::Axis& axis : sweep.axes) known.push_back(axis.parameter.empty() ? "level" : axis.parameter);
  } else if (const Value* level = where.find("level")) {
    throw error_at(level->place, "a 'level' needs its 'sweep' beside it; without one a claim is about no disturbance");
  }
  check_keys(where, known, "'where'");
  return claim;
}

}  // namespace gust
