#include "gust/control/recording.h"

#include <algorithm>
#include <cmath>

#include "gust/control/cascade.h"
#include "gust/control/lqr.h"
#include "gust/control/recording_csv.h"
#include "gust/control/recording_description.h"

namespace gust {
namespace {

constexpr Meaning kColumns[] = {
    {"k", "number of the record: 0 is the reset, k follows control step k - 1"},
    {"t", "k / ctrl_freq [s]"},
    {"a_raw", "what the controller asked for in that step, in its own unit; a_raw0, a_raw1 where there are two"},
    {"a_phys", "the same in physical units [N]"},
    {"a_noisy", "with all that disturbed the action, before the actuator saturates [N]"},
    {"a_applied", "what pushed the plant [N]"},
    {"f_x, f_z", "external force during the step, 0 if there was none [N]"},
    {"adv_x, adv_z", "an adversary's share of f_x, f_z, 0 if there was none [N]"},
    {"x, x_dot, theta, theta_dot", "true state after the step, a column for each of the plant's [m, m/s, rad, rad/s]"},
    {"obs0, obs1, obs2, …",
     "the state as the controller saw it; where a trajectory is tracked, then the next reference"},
    {"reward, sq_err", "of the state after the step"},
    {"out_of_bounds, done, timelimit", "0 or 1 after the step"},
};

/// One action has its plain name, several are numbered.
std::vector<std::string> action_columns(const std::string& name, const PlantSpec& spec) {
  if (spec.action.size() == 1) return {name};
  std::vector<std::string> names;
  for (std::size_t i = 0; i < spec.action.size(); ++i) names.push_back(cat(name, i));
  return names;
}

/// "f_x" for the force "fx".
std::vector<std::string> force_columns(const std::string& prefix, const PlantSpec& spec) {
  std::vector<std::string> names;
  for (const Component& force : spec.force) names.push_back(cat(prefix, "_", force.name.substr(1)));
  return names;
}

std::vector<std::string> state_columns(const PlantSpec& spec) {
  std::vector<std::string> names;
  for (const Component& state : spec.state) names.push_back(state.name);
  return names;
}

std::vector<std::string> observation_columns(const PlantSpec& spec) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < spec.observations(); ++i) names.push_back(cat("obs", i));
  return names;
}

std::string wrong_flag(double value, std::size_t) { return value == 0 || value == 1 ? "" : "0 or 1"; }

std::string wrong_counter(double value, std::size_t record) {
  return value == static_cast<double>(record) ? "" : cat(record, ", the number of the record");
}

/// A logger's clock may be off by less than half a control step.
decltype(CsvColumn::wrong) wrong_time(double rate) {
  return [rate](double value, std::size_t record) {
    const double time = static_cast<double>(record) / rate;
    return std::abs(value - time) * rate < 0.5 ? "" : cat(time, " (k / ctrl_freq)");
  };
}

/// The first record is the initial state that the description gives, if it gives one.
decltype(CsvColumn::wrong) wrong_start(const Matrix<double>& start, std::size_t component) {
  if (start.lanes() == 0) return {};
  return [from = start.at(component, 0)](double value, std::size_t record) {
    return record > 0 || std::abs(value - from) < 1e-9 ? "" : cat(from, " as in 'init_state'");
  };
}

/// The columns to read, and the batches that they are to become.
class Columns {
 public:
  void want(const std::vector<std::string>& names, Matrix<double>* to, bool blank_first) {
    groups_.push_back({to, wanted.size(), names.size()});
    for (const std::string& name : names) wanted.push_back({name, blank_first});
  }

  void hand_out(const Matrix<double>& all) const {
    for (const auto& [to, first, count] : groups_) {
      if (to == nullptr) continue;
      *to = Matrix<double>(count, all.lanes());
      for (std::size_t i = 0; i < count; ++i) std::ranges::copy(all.row(first + i), to->row(i).begin());
    }
  }

  std::vector<CsvColumn> wanted;

 private:
  struct Group {
    Matrix<double>* to;  // null for columns that must be there and right, and are not used
    std::size_t first, count;
  };
  std::vector<Group> groups_;
};

Columns columns_of(Recording& recording) {
  const PlantSpec& spec = recording.plant->spec();
  Columns columns;
  columns.want(state_columns(spec), &recording.state, false);
  for (std::size_t i = 0; i < spec.state.size(); ++i) columns.wanted[i].wrong = wrong_start(recording.state, i);
  columns.want({"k"}, nullptr, false);
  columns.wanted.back().wrong = wrong_counter;
  columns.want({"t"}, nullptr, false);
  columns.wanted.back().wrong = wrong_time(spec.control_rate);
  columns.want(action_columns("a_raw", spec), &recording.command, true);
  columns.want(action_columns("a_phys", spec), &recording.physical, true);
  columns.want(action_columns("a_noisy", spec), &recording.disturbed, true);
  columns.want(action_columns("a_applied", spec), &recording.applied, true);
  columns.want(force_columns("f", spec), &recording.force, true);
  columns.want(force_columns("adv", spec), nullptr, true);
  columns.want(observation_columns(spec), &recording.observation, false);
  columns.want({"reward", "sq_err", "out_of_bounds", "done", "timelimit"}, &recording.outcome, true);
  for (std::size_t i = columns.wanted.size() - 3; i < columns.wanted.size(); ++i) columns.wanted[i].wrong = wrong_flag;
  return columns;
}

std::string lines_of(std::span<const Meaning> meanings) {
  std::string text;
  for (const Meaning& meaning : meanings) text += fmt::format("  {:<32}{}\n", meaning.name, meaning.text);
  return text;
}

}  // namespace

std::unique_ptr<Policy> Recording::controller() const {
  if (gain.size() > 0) return feedback_policy(*plant, gain);
  return cascade ? cascade_policy(*plant, *cascade) : nullptr;
}

Recording read_recording(const NamedBytes& description, const NamedBytes& records) {
  Recording recording = read_description(description);
  const Columns columns = columns_of(recording);
  const auto count = static_cast<std::size_t>(recording.plant->spec().steps) + 1;
  columns.hand_out(read_csv({records.bytes, records.name}, columns.wanted, count));
  return recording;
}

std::string recording_format() {
  return cat("A recording is two files, NAME.json and NAME.csv. The JSON file must hold\n", lines_of(recording_keys()),
             "and may hold\n", lines_of(optional_recording_keys()),
             "Other keys and null are ignored. The CSV file has a header line and these columns in any order; record 0 "
             "may leave\nits actions, forces, reward and sq_err blank:\n",
             lines_of(kColumns));
}

}  // namespace gust
