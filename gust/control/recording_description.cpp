#include "gust/control/recording_description.h"

#include <algorithm>
#include <cmath>

#include "gust/control/recording_json.h"

namespace gust {
namespace {

constexpr std::int64_t kMostSteps = 200'000;
constexpr double kMostRatio = 1e6;
constexpr double kMostSubsteps = 1e8;  // some seconds of work

constexpr Meaning kKeys[] = {
    {"plant", "kind of plant (gust list plants)"},
    {"ctrl_freq", "how often the controller acted [Hz]"},
    {"pyb_freq", "integration steps of the model [Hz], a whole multiple of ctrl_freq"},
    {"steps", "control steps; the CSV file has one record more, the reset"},
    {"gravity", "[m/s^2]"},
    {"plant_params", "the plant's parameters by name (gust describe plant cartpole)"},
    {"goal", "state to hold, one number a state"},
    {"goal_tolerance", "done when |state - goal| is below this; 0 for never"},
    {"normalized_action", "true if a_raw is in [-1, 1], false if it is physical"},
    {"action_bounds", "[[lowest], [highest]] that the actuator gives [N]"},
    {"policy", "{\"type\": \"lqr\"} is run in closed loop and needs lqr_gain; any other is an open loop"},
    {"rew_state_weight", "w of the reward exp(-sum w e^2 - w_u u^2), one number or one a state"},
    {"rew_act_weight", "w_u of the reward, which charges a_noisy"},
    {"rew_exponential", "true; false if the column reward holds -sum w e^2 - w_u u^2"},
    {"sq_err_weights", "v of sq_err = sum (v e)^2, one number a state"},
};
constexpr Meaning kOptionalKeys[] = {
    {"name", "what the output calls it; else the name of the file"},
    {"lqr_gain", "K of u = -K (observation - goal), one number a state"},
    {"init_state", "must then equal record 0"},
    {"task", "must then be \"stabilization\""},
    {"u_goal", "must then be the plant's: [0] for the cart-pole"},
};

/// The value of a key that must be there.
const Value& need(const Table& table, std::string_view key) {
  if (const Value* value = table.find(key)) return *value;
  std::vector<std::string> strange = table.keys();
  std::erase_if(strange, [](const std::string& name) {
    const auto same = [&](const Meaning& known) { return known.name == name; };
    return std::any_of(std::begin(kKeys), std::end(kKeys), same) ||
           std::any_of(std::begin(kOptionalKeys), std::end(kOptionalKeys), same);
  });
  const std::string meant = nearest(key, strange);
  throw error_at(table.place, "'", key, "' is missing",
                 meant.empty() ? "" : cat("; is it the one called '", meant, "'?"), " (gust validate --help)");
}

Value number_value(const Table& table, std::string_view key, const Range& range) {
  const Value& value = need(table, key);
  double number = 0;
  read_value(number, value, key, range);
  return {number, value.place};
}

/// A list of `count` numbers.
Value list_value(const Table& table, std::string_view key, std::size_t count) {
  const Value& value = need(table, key);
  const Value::List& list = value.as_list(key);
  if (list.size() != count) throw error_at(value.place, "'", key, "' must have ", count, " numbers, got ", list.size());
  for (const Value& number : list) number.as_number(key);
  return value;
}

/// The same, or one number that stands for all.
Value spread_value(const Table& table, std::string_view key, std::size_t count) {
  const Value& value = need(table, key);
  if (!value.is_number()) return list_value(table, key, count);
  value.as_number(key);
  return {Value::List(count, value), value.place};
}

const Entry<Plant>& plant_kind(const Table& description) {
  const Value& kind = need(description, "plant");
  const std::string& name = kind.as_text("plant");
  const std::vector<std::string> names = plants().names();
  if (std::find(names.begin(), names.end(), name) != names.end()) return plants().at(name);
  throw error_at(kind.place, "unknown plant '", name, "'", did_you_mean(name, names), "; known are ",
                 join(names, ", "));
}

/// The rates and the length, checked under the names that the file gives them.
void set_rates(Table& options, const Table& description) {
  const Value control = number_value(description, "ctrl_freq", positive);
  const Value physics = number_value(description, "pyb_freq", positive);
  const Value& steps = need(description, "steps");
  std::int64_t count = 0;
  read_value(count, steps, "steps", between(1, kMostSteps));
  const double ratio = physics.as_number("") / control.as_number("");
  if (ratio < 1 || ratio > kMostRatio || ratio != std::round(ratio)) {
    throw error_at(physics.place, "'pyb_freq' must be 1, 2, … ", kMostRatio, " times 'ctrl_freq', got ",
                   physics.as_number(""), " and ", control.as_number(""));
  }
  if (ratio * static_cast<double>(count) > kMostSubsteps) {
    throw error_at(physics.place, "'pyb_freq' asks for more than ", kMostSubsteps, " integration steps in all");
  }
  options.set("control_rate", control);
  options.set("physics_rate", physics);
  options.set("steps", steps);
}

/// The limit of an actuator that gives as much to one side as to the other.
Value force_limit(const Table& description) {
  const Value& value = need(description, "action_bounds");
  std::vector<double> ends;
  for (const Value& bound : value.as_list("action_bounds")) {
    const std::vector<double> numbers = bound.as_numbers("action_bounds");
    ends.insert(ends.end(), numbers.begin(), numbers.end());
  }
  if (ends.size() == 2 && ends[1] > 0 && ends[0] == -ends[1]) return {ends[1], value.place};
  throw error_at(value.place, "'action_bounds' must be [[-limit], [limit]] with limit > 0");
}

void set_parameters(Table& options, const Table& description, const PlantSpec& spec) {
  const Table& given = need(description, "plant_params").as_table("plant_params");
  for (const Parameter& parameter : spec.parameters) {
    if (given.contains(parameter.name)) continue;
    throw error_at(given.place, "'plant_params' lacks '", parameter.name, "' [", parameter.unit, "]");
  }
  for (const auto& [name, value] : given.items) {
    if (options.contains(name)) throw error_at(value.place, "'", name, "' is no parameter of the plant");
    options.set(name, value);
  }
}

/// The plant as the file describes it.
Made<Plant> make_plant(const Table& description) {
  const Entry<Plant>& kind = plant_kind(description);
  const Made<Plant> standard = kind.make(Table{{}, description.place});
  const std::size_t states = standard->spec().state.size();
  Table options{{}, description.place};
  set_rates(options, description);
  options.set("gravity", number_value(description, "gravity", non_negative));
  options.set("goal", list_value(description, "goal", states));
  const Value& normalized = need(description, "normalized_action");
  options.set("normalized_action", {normalized.as_bool("normalized_action"), normalized.place});
  options.set("force_limit", force_limit(description));
  options.set("state_weights", spread_value(description, "rew_state_weight", states));
  options.set("action_weight", spread_value(description, "rew_act_weight", 1).as_list("").front());
  set_parameters(options, description, standard->spec());
  return kind.make(options);
}

void check_task(const Table& description, const PlantSpec& spec) {
  const Value* task = description.find("task");
  if (task != nullptr && task->as_text("task") != "stabilization") {
    throw error_at(task->place, "'task' must be \"stabilization\", got '", task->as_text("task"), "'");
  }
  if (!description.contains("u_goal")) return;
  const Value u_goal = list_value(description, "u_goal", spec.action.size());
  if (u_goal.as_numbers("u_goal") != spec.action_goal) {
    throw error_at(u_goal.place, "'u_goal' must be ", canonical_text(spec.action_goal));
  }
}

/// Row by row, as a flat list.
Eigen::MatrixXd read_gain(const Table& description, const PlantSpec& spec) {
  const auto rows = static_cast<Eigen::Index>(spec.action.size());
  const auto columns = static_cast<Eigen::Index>(spec.state.size());
  const std::size_t count = spec.action.size() * spec.state.size();
  const std::vector<double> numbers = list_value(description, "lqr_gain", count).as_numbers("lqr_gain");
  Eigen::MatrixXd gain(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) gain(i, j) = numbers[static_cast<std::size_t>(i * columns + j)];
  }
  return gain;
}

/// The file's name without folders and ending.
std::string stem(const std::string& name) {
  const std::size_t folder = name.find_last_of('/');
  const std::string file = folder == std::string::npos ? name : name.substr(folder + 1);
  return file.substr(0, file.find_last_of('.'));
}

}  // namespace

std::span<const Meaning> recording_keys() { return kKeys; }
std::span<const Meaning> optional_recording_keys() { return kOptionalKeys; }

Recording read_description(const NamedBytes& file) {
  const Table description = read_json_table(file.bytes, file.name);
  Recording recording;
  recording.plant = make_plant(description);
  const PlantSpec& spec = recording.plant->spec();
  const std::size_t states = spec.state.size();
  check_task(description, spec);
  const Value* name = description.find("name");
  recording.name = name ? name->as_text("name") : stem(file.name);
  const Value& policy = need(description, "policy");
  recording.policy = need(policy.as_table("policy"), "type").as_text("type");
  if (recording.policy == "lqr") recording.gain = read_gain(description, spec);
  recording.goal_tolerance = number_value(description, "goal_tolerance", non_negative).as_number("");
  recording.exponential_reward = need(description, "rew_exponential").as_bool("rew_exponential");
  recording.error_weights = list_value(description, "sq_err_weights", states).as_numbers("");
  if (description.contains("init_state")) {
    const std::vector<double> start = list_value(description, "init_state", states).as_numbers("");
    recording.state = Matrix<double>(states, 1);
    for (std::size_t i = 0; i < states; ++i) recording.state.at(i, 0) = start[i];
  }
  return recording;
}

}  // namespace gust
