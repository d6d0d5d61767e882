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
    {"action_bounds", "[[lowest], [highest]] that the actuators give, one number each [N]"},
};
constexpr Meaning kJudgedKeys[] = {
    {"goal", "state to hold, one number a state; of reward, sq_err, done and the policies lqr and pd"},
    {"goal_tolerance", "done when |state - goal| is below this; 0 for never"},
    {"normalized_action", "true if a_raw is in [-1, 1], false if it is physical"},
    {"rew_state_weight", "w of the reward exp(-sum w e^2 - w_u u^2), one number or one a state"},
    {"rew_act_weight", "w_u of the reward, which charges a_noisy from u_goal"},
    {"rew_exponential", "true; false if the column reward holds -sum w e^2 - w_u u^2"},
    {"sq_err_weights", "v of sq_err = sum (v e)^2, one number a state"},
};
constexpr Meaning kOptionalKeys[] = {
    {"name", "what the output calls it; else the name of the file"},
    {"policy",
     "{\"type\": \"lqr\"} is run in closed loop and needs lqr_gain, \"pd\" pd_gains; others are an open loop"},
    {"lqr_gain", "K of u = u_goal - K (observation - goal), one number a state"},
    {"init_state", "must then equal record 0"},
    {"pd_gains", "of the quadrotor's cascade: kx, kdx, th_max, kz, kdz, kth, kq; M, Iyy, arm that it believes in"},
    {"task", "\"stabilization\"; for the quadrotor also \"traj_tracking\", its default circle"},
    {"u_goal", "of reward and lqr, physical; else the plant's: 0 for the cart-pole, its weight for the quadrotor"},
};

/// The value of a key that must be there.
const Value& need(const Table& table, std::string_view key) {
  if (const Value* value = table.find(key)) return *value;
  std::vector<std::string> strange = table.keys();
  std::erase_if(strange, [](const std::string& name) {
    const auto has = [&](std::span<const Meaning> keys) {
      return std::ranges::find(keys, name, &Meaning::name) != keys.end();
    };
    return has(kKeys) || has(kJudgedKeys) || has(kOptionalKeys);
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

/// How recordings name a plant and its parameters, where gust has other names.
struct Dialect {
  std::string_view plant;
  std::string_view kind;
  std::vector<std::pair<std::string_view, std::string_view>> parameters;

  std::string parameter(std::string_view name) const {
    for (const auto& [theirs, ours] : parameters)
      if (ours == name) return std::string(theirs);
    return std::string(name);
  }
};

const std::vector<Dialect>& dialects() {
  static const std::vector<Dialect> all = {{"quad2d", "quadrotor", {{"M", "mass"}, {"Iyy", "inertia"}}}};
  return all;
}

Dialect dialect_of(const Table& description) {
  const Value& kind = need(description, "plant");
  const std::string& name = kind.as_text("plant");
  std::vector<std::string> names = plants().names();
  for (const Dialect& dialect : dialects()) {
    if (dialect.plant == name) return dialect;
    names.emplace_back(dialect.plant);
  }
  for (const Entry<Plant>& entry : plants().entries())  // they live as long as the program, and so do views of them
    if (entry.name == name) return {entry.name, entry.name, {}};
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

/// What the actuators give, each as much as the others: to one side as to the other, or from a least to a greatest.
void set_bounds(Table& options, const Table& description, const PlantSpec& spec) {
  const Value& value = need(description, "action_bounds");
  const std::size_t count = spec.action.size();
  std::vector<double> ends;
  for (const Value& bound : value.as_list("action_bounds")) {
    const std::vector<double> numbers = bound.as_numbers("action_bounds");
    if (numbers.size() == count && std::ranges::count(numbers, numbers.front()) == std::ssize(numbers))
      ends.push_back(numbers.front());
  }
  const bool symmetric = spec.action_low.front() < 0;
  if (ends.size() != 2 || ends[0] >= ends[1] || (symmetric && ends[0] != -ends[1])) {
    throw error_at(value.place, symmetric ? "'action_bounds' must be [[-limit], [limit]] with limit > 0"
                                          : "'action_bounds' must be [[low, low], [high, high]] with low < high");
  }
  if (!symmetric) options.set("thrust_low", {ends[0], value.place});
  options.set(symmetric ? "force_limit" : "thrust_high", {ends[1], value.place});
}

void set_parameters(Table& options, const Table& description, const Dialect& dialect, const PlantSpec& spec) {
  const Table& given = need(description, "plant_params").as_table("plant_params");
  std::vector<std::string> known;
  for (const Parameter& parameter : spec.parameters) {
    const std::string theirs = dialect.parameter(parameter.name);
    known.push_back(theirs);
    if (!given.contains(theirs)) {
      throw error_at(given.place, "'plant_params' lacks '", theirs, "' [", parameter.unit, "]");
    }
    options.set(parameter.name, *given.find(theirs));
  }
  for (const auto& [name, value] : given.items) {
    if (std::ranges::find(known, name) != known.end()) continue;
    if (options.contains(name)) throw error_at(value.place, "'", name, "' is no parameter of the plant");
    options.set(name, value);  // any other option of the plant
  }
}

/// A goal to hold, or the plant's own trajectory with the next reference in the observation.
void set_task(Table& options, const Table& description, const PlantSpec& spec, bool needed) {
  const Value* task = description.find("task");
  const bool choice = spec.references > 1;  // a plant that tracks by default can do either
  if (task != nullptr && choice && task->as_text("task") == "traj_tracking") {
    options.set("horizon", {std::int64_t{1}, task->place});
    return;
  }
  if (task != nullptr && task->as_text("task") != "stabilization") {
    throw error_at(task->place, "'task' must be \"stabilization\"", choice ? " or \"traj_tracking\"" : "", ", got '",
                   task->as_text("task"), "'");
  }
  if (needed || description.contains("goal")) options.set("goal", list_value(description, "goal", spec.state.size()));
  if (!choice) return;
  options.set("task", {std::string("stabilise"), description.place});
  options.set("horizon", {std::int64_t{0}, description.place});
}

/// The kind of the controller that acted; empty where it is not told.
std::string policy_of(const Table& description) {
  const Value* policy = description.find("policy");
  return policy == nullptr ? "" : need(policy->as_table("policy"), "type").as_text("type");
}

bool needs_goal(const Recording& recording) {
  const auto has = [&](std::string_view column) { return recording.has(column); };
  return recording.policy == "lqr" || recording.policy == "pd" || has("reward") || has("sq_err") || has("done") ||
         has("timelimit");
}

/// The plant as the file describes it.
Made<Plant> make_plant(const Table& description, const Recording& recording) {
  const Dialect dialect = dialect_of(description);
  const Entry<Plant>& kind = plants().at(dialect.kind);
  const Made<Plant> standard = kind.make(Table{{}, description.place});
  const PlantSpec& spec = standard->spec();
  Table options{{}, description.place};
  set_rates(options, description);
  options.set("gravity", number_value(description, "gravity", non_negative));
  set_task(options, description, spec, needs_goal(recording));
  if (recording.has("a_raw") || description.contains("normalized_action")) {
    const Value& normalized = need(description, "normalized_action");
    options.set("normalized_action", {normalized.as_bool("normalized_action"), normalized.place});
  }
  set_bounds(options, description, spec);
  if (recording.has("reward")) {
    options.set("state_weights", spread_value(description, "rew_state_weight", spec.state.size()));
    options.set("action_weight", spread_value(description, "rew_act_weight", 1).as_list("").front());
  }
  if (spec.contact) options.set("artefacts", {std::string("scg"), description.place});
  set_parameters(options, description, dialect, spec);
  return kind.make(options);
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

/// The reference simulator's controller of the quadrotor, with the mass, inertia, arm and gravity that it believes in,
/// whatever the plant's are. Its recordings obey
///   th_d = clip(6 kx (x_r - x) + 3 kdx (x_r' - x'), ±th_max)      thrust = M (g + 2 kz (z_r - z) + kdz (z_r' - z'))
///   moment = I (kth (th_d - th) - kq th')
/// to rounding error: the factors 6, 3 and 2 are measured, the names alone do not tell them.
Cascade read_cascade(const Table& description, const PlantSpec& spec) {
  const Table& gains = need(description, "pd_gains").as_table("pd_gains");
  const auto gain = [&](std::string_view name) { return number_value(gains, name, anything).as_number(""); };
  Cascade cascade{
      {6.0 * gain("kx"), 3.0 * gain("kdx"), 0, 0, 0, 0}, gain("th_max"), Eigen::MatrixXd(2, 6), Eigen::VectorXd(2)};
  const double lift = gain("M") / 2.0;
  const double gravity =
      gains.contains("gravity") ? gain("gravity") : number_value(description, "gravity", anything).as_number("");
  cascade.rest.setConstant(gain("M") * gravity / 2.0);
  const double twist = gain("Iyy") / (2.0 * number_value(gains, "arm", positive).as_number(""));
  const double up = 2.0 * gain("kz") * lift, up_rate = gain("kdz") * lift;
  const double turn = gain("kth") * twist, turn_rate = gain("kq") * twist;
  cascade.inner << 0, 0, up, up_rate, -turn, -turn_rate,  //
      0, 0, up, up_rate, turn, turn_rate;
  GUST_CHECK(spec.state.size() == 6 && spec.action.size() == 2);
  return cascade;
}

/// The file's name without folders and ending.
std::string stem(const std::string& name) {
  const std::size_t folder = name.find_last_of('/');
  const std::string file = folder == std::string::npos ? name : name.substr(folder + 1);
  return file.substr(0, file.find_last_of('.'));
}

}  // namespace

std::span<const Meaning> recording_keys() { return kKeys; }
std::span<const Meaning> judged_recording_keys() { return kJudgedKeys; }
std::span<const Meaning> optional_recording_keys() { return kOptionalKeys; }

Recording read_description(const NamedBytes& file, std::vector<std::string> columns) {
  const Table description = read_json_table(file.bytes, file.name);
  Recording recording;
  recording.columns = std::move(columns);
  recording.policy = policy_of(description);
  recording.plant = make_plant(description, recording);
  const PlantSpec& spec = recording.plant->spec();
  const std::size_t states = spec.state.size();
  const Value* name = description.find("name");
  recording.name = name ? name->as_text("name") : stem(file.name);
  recording.action_goal = description.contains("u_goal")
                              ? list_value(description, "u_goal", spec.action.size()).as_numbers("")
                              : spec.action_goal;
  if (recording.policy == "lqr") recording.gain = read_gain(description, spec);
  if (recording.policy == "pd" && spec.cascade) recording.cascade = read_cascade(description, spec);
  if (recording.has("done") || recording.has("timelimit"))
    recording.goal_tolerance = number_value(description, "goal_tolerance", non_negative).as_number("");
  if (recording.has("reward"))
    recording.exponential_reward = need(description, "rew_exponential").as_bool("rew_exponential");
  if (recording.has("sq_err"))
    recording.error_weights = list_value(description, "sq_err_weights", states).as_numbers("");
  if (description.contains("init_state")) {
    const std::vector<double> start = list_value(description, "init_state", states).as_numbers("");
    recording.state = Matrix<double>(states, 1);
    for (std::size_t i = 0; i < states; ++i) recording.state.at(i, 0) = start[i];
  }
  return recording;
}

}  // namespace gust
