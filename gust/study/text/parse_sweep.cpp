#include <algorithm>
#include <cmath>

#include "gust/study/text/parse.h"

namespace gust {
namespace {

constexpr std::size_t kMostCells = 2'000'000;

/// Far numbers overflow and near ones run together.
void check_ascending(const std::vector<double>& values, std::string_view what, const Place& place) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) throw error_at(place, "'", what, "' must be finite numbers, got ", values[i]);
    if (i > 0 && !(values[i - 1] < values[i]))
      throw error_at(place, "'", what, "' must ascend, got ", values[i - 1], " before ", values[i]);
  }
}

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
  if (!std::isfinite(high - low))
    throw error_at(to->place, "'from' and 'to' lie too far apart, got ", low, " and ", high);
  std::vector<double> values;
  for (std::int64_t i = 0; i < points; ++i) {
    const double share = points == 1 ? 0.0 : static_cast<double>(i) / static_cast<double>(points - 1);
    values.push_back(i == points - 1 && points > 1 ? high : low + (high - low) * share);
  }
  check_ascending(values, what, table.place);
  return values;
}

/// Values of a parameter: absolute, or factors of the nominal value.
Sweep::Axis parameter_axis(const std::string& name, const Value& values, double unit, const Study& study) {
  const Interface& spec = study.setup.plant->spec();
  Sweep::Axis axis{name, parameter_index(spec, name, values.place), parse_levels(values, name)};
  for (double& value : axis.values) {
    value *= unit;
    if (!(value > 0)) throw error_at(values.place, "'", name, "' must be > 0, got ", value);
  }
  check_ascending(axis.values, name, values.place);
  return axis;
}

void parse_vary(const Table& table, const Study& study, Sweep& sweep) {
  check_keys(table, {"name", "vary", "scale", "values", "params", "disturb"}, "a sweep over a parameter");
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

/// Two parameters, or one and the level of a disturbance.
void parse_grid(const Table& table, const Study& study, Sweep& sweep) {
  const Table& grid = table.find("grid")->as_table("grid");
  if (grid.items.size() != 2) throw error_at(grid.place, "'grid' needs two axes, got ", grid.items.size());
  if (grid.contains("level")) {
    sweep.injection = parse_injection(table, study.setup.plant->spec(), {"name", "grid", "params", "disturb"});
  } else {
    check_keys(table, {"name", "grid", "params", "disturb"}, "a sweep over a grid");
  }
  for (const auto& [name, values] : grid.items) {
    sweep.axes.push_back(name == "level" ? Sweep::Axis{{}, 0, parse_levels(values, name)}
                                         : parameter_axis(name, values, 1.0, study));
  }
}

void parse_disturbance(const Table& table, const Study& study, Sweep& sweep) {
  const Value* levels = table.find("levels");
  if (levels == nullptr)
    throw error_at(table.place, "sweep '", sweep.name, "' needs 'levels', such as { from = 0, to = 15, count = 11 }");
  if (table.contains("level")) throw error_at(table.find("level")->place, "a sweep has 'levels', not a 'level'");
  sweep.injection = parse_injection(table, study.setup.plant->spec(), {"name", "levels", "params", "disturb"});
  const auto* word = std::get_if<std::string>(&levels->data);
  if (word != nullptr && *word != "auto")
    throw error_at(levels->place, "'levels' must be a list, a range or \"auto\", got '", *word, "'");
  sweep.automatic = word != nullptr;
  if (sweep.automatic && !study.setup.plant->spec().fails)
    throw error_at(levels->place, "\"auto\" looks for the level that fails, and an episode of '",
                   study.setup.plant.kind, "' cannot fail; give the levels");
  sweep.axes.push_back({});
  if (!sweep.automatic) sweep.axes.front().values = parse_levels(*levels, "levels");
}

/// What is different in all cells of a sweep: parameters of the plant, and disturbances that are on.
void parse_setting(const Table& table, const Study& study, Sweep& sweep) {
  const Interface& spec = study.setup.plant->spec();
  if (const Value* disturb = table.find("disturb")) sweep.disturbed = parse_disturb(*disturb, spec);
  const Value* params = table.find("params");
  for (const auto& [name, value] : params ? params->as_table("params").items : Table{}.items) {
    const std::size_t index = parameter_index(spec, name, value.place);
    const bool swept = std::ranges::find(sweep.axes, name, &Sweep::Axis::parameter) != sweep.axes.end();
    if (swept) throw error_at(value.place, "'", name, "' is what the sweep varies");
    sweep.parameters.emplace_back(index, parameter_value(value, spec.parameters[index]));
  }
}

/// Levels that the effect of a sweep cannot have, and effects that cannot be together.
void check_effects(const Table& table, const Study& study, const Sweep& sweep) {
  std::vector<Injection> all = study.always;
  all.insert(all.end(), sweep.disturbed.begin(), sweep.disturbed.end());
  if (sweep.injection) all.push_back(*sweep.injection);
  const std::string together = together_complaint(all);
  if (!together.empty()) throw error_at(table.place, together);
  for (const Sweep::Axis& axis : sweep.axes) {
    if (!sweep.injection || !axis.parameter.empty() || axis.values.empty()) continue;
    const std::string level = level_complaint(*sweep.injection, axis.values.front());
    const Value* levels = table.find(table.contains("grid") ? "grid" : "levels");
    if (!level.empty()) throw error_at(levels->place, level);
  }
}

}  // namespace

double parameter_value(const Value& value, const Parameter& parameter) {
  const auto* text = std::get_if<std::string>(&value.data);
  const bool scaled = text != nullptr && text->starts_with('x');
  const Value number = scaled ? value_from_text(text->substr(1), value.place) : value;
  const double result = number.as_number(parameter.name) * (scaled ? parameter.nominal : 1.0);
  if (!(result > 0)) throw error_at(value.place, "'", parameter.name, "' must be > 0, got ", result);
  return result;
}

std::vector<double> parse_levels(const Value& value, std::string_view what) {
  if (const auto* table = std::get_if<Table>(&value.data)) return spaced(*table, what);
  std::vector<double> levels = value.as_numbers(what);
  if (levels.empty()) throw error_at(value.place, "'", what, "' must not be empty");
  check_ascending(levels, what, value.place);
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
  parse_setting(table, study, sweep);
  check_effects(table, study, sweep);
  if (sweep.cells() > kMostCells)
    throw error_at(table.place, "sweep '", sweep.name, "' has ", sweep.cells(), " cells; at most ", kMostCells);
  return sweep;
}

}  // namespace gust
