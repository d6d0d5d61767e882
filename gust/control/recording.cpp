#include "gust/control/recording.h"

#include <algorithm>
#include <cmath>

#include "gust/control/cascade.h"
#include "gust/control/lqr.h"
#include "gust/control/recording_csv.h"
#include "gust/control/recording_description.h"
#include "gust/control/tracking.h"
#include "gust/core/math.h"

namespace gust {
namespace {

constexpr Meaning kNeededColumns[] = {
    {"x, x_dot, theta, theta_dot", "true state after the step, a column for each of the plant's [m, m/s, rad, rad/s]"},
    {"a_applied",
     "what pushed the plant [N], or else a_noisy, a_phys or a_raw; a_applied0, a_applied1 where there are two"},
};
constexpr Meaning kColumns[] = {
    {"k", "number of the record: 0 is the reset, k follows control step k - 1"},
    {"t", "of the record, k / ctrl_freq after that of the first [s]"},
    {"a_raw", "what the controller asked for in that step, in its own unit"},
    {"a_phys", "the same in physical units [N]"},
    {"a_noisy", "with all that disturbed the action, before the actuator saturates [N]"},
    {"f_x, f_z", "external force during the step, 0 if there was none [N]"},
    {"adv_x, adv_z", "an adversary's share of f_x, f_z, 0 if there was none [N]"},
    {"obs0, obs1, obs2, …",
     "the state as the controller saw it; where a trajectory is tracked, then the next reference"},
    {"reward, sq_err", "of the state after the step"},
    {"out_of_bounds, done, timelimit", "0 or 1 after the step"},
};
constexpr const char* kOutcomes[] = {"reward", "sq_err", "out_of_bounds", "done", "timelimit"};

/// One action has its plain name, several are numbered.
std::vector<std::string> action_columns(const std::string& name, const PlantSpec& spec) {
  if (spec.action.size() == 1) return {name};
  std::vector<std::string> names;
  for (std::size_t i = 0; i < spec.action.size(); ++i) names.push_back(cat(name, i));
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

/// A logger's clock begins anywhere, and may be off by less than half a control step.
decltype(CsvColumn::wrong) wrong_time(double rate) {
  return [rate, begin = 0.0](double value, std::size_t record) mutable {
    if (record == 0) begin = value;
    const double time = begin + static_cast<double>(record) / rate;
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

enum class Missing { kError, kSkipped, kZero };

/// The columns to read, and the batches that they are to become.
class Columns {
 public:
  explicit Columns(Recording& recording) : recording_(recording) {}

  /// One row a name. Where they may be skipped the first one decides, and the batch stays empty; where they may be 0
  /// each for itself.
  void take(const std::vector<std::string>& names, Matrix<double>* to, CsvColumn like, Missing missing) {
    if (names.empty()) return;
    if (missing == Missing::kSkipped && !recording_.has(names.front())) return drop(names);
    groups_.push_back({to, {}});
    for (const std::string& name : names) {
      const bool there = missing != Missing::kZero || recording_.has(name);
      groups_.back().rows.push_back(there ? std::optional(wanted.size()) : std::nullopt);
      like.name = name;
      if (there) wanted.push_back(like);
    }
  }

  void hand_out(const Matrix<double>& all) const {
    for (const auto& [to, rows] : groups_) {
      if (to == nullptr) continue;
      *to = Matrix<double>(rows.size(), all.lanes());
      for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows[i]) std::ranges::copy(all.row(*rows[i]), to->row(i).begin());
      }
    }
  }

  std::vector<CsvColumn> wanted;

 private:
  void drop(const std::vector<std::string>& names) {
    std::vector<std::string> there;
    std::ranges::copy_if(names, std::back_inserter(there),
                         [&](const std::string& name) { return recording_.has(name); });
    if (!there.empty()) recording_.dropped.push_back(cat(join(there, ", "), " (no ", names.front(), ")"));
  }

  struct Group {
    Matrix<double>* to;  // null for columns that must be right, and are not used
    std::vector<std::optional<std::size_t>> rows;
  };
  Recording& recording_;
  std::vector<Group> groups_;
};

Columns columns_of(Recording& recording) {
  const PlantSpec& spec = recording.plant->spec();
  const CsvColumn filled{}, after_reset{.name = {}, .blank_first = true};
  Columns columns(recording);
  columns.take(state_columns(spec), &recording.state, filled, Missing::kError);
  for (std::size_t i = 0; i < spec.state.size(); ++i) columns.wanted[i].wrong = wrong_start(recording.state, i);
  columns.take({"k"}, nullptr, {.name = {}, .wrong = wrong_counter}, Missing::kSkipped);
  columns.take({"t"}, nullptr, {.name = {}, .wrong = wrong_time(spec.control_rate)}, Missing::kSkipped);
  const bool any = recording.commanded() || recording.has("a_noisy");
  columns.take(action_columns("a_raw", spec), &recording.command, after_reset, Missing::kSkipped);
  columns.take(action_columns("a_phys", spec), &recording.physical, after_reset, Missing::kSkipped);
  columns.take(action_columns("a_noisy", spec), &recording.disturbed, after_reset, Missing::kSkipped);
  columns.take(action_columns("a_applied", spec), &recording.applied, after_reset,
               any ? Missing::kSkipped : Missing::kError);
  columns.take(force_columns("f", spec), &recording.force, after_reset, Missing::kZero);
  columns.take(force_columns("adv", spec), nullptr, after_reset, Missing::kZero);
  columns.take(observation_columns(spec), &recording.observation, filled, Missing::kSkipped);
  columns.take({kOutcomes, kOutcomes + 5}, &recording.outcome, after_reset, Missing::kZero);
  for (CsvColumn& column : columns.wanted) {
    if (std::ranges::find(kOutcomes + 2, kOutcomes + 5, column.name) != kOutcomes + 5) column.wrong = wrong_flag;
  }
  return columns;
}

/// Each component of a batch through f(value, component).
template <class F>
Matrix<double> mapped(const Matrix<double>& from, F&& f) {
  Matrix<double> to(from.rows(), from.lanes());
  for (std::size_t i = 0; i < from.rows(); ++i) {
    for (std::size_t lane = 0; lane < from.lanes(); ++lane) to.at(i, lane) = f(from.at(i, lane), i);
  }
  return to;
}

/// What is not recorded of the action follows from what is, as if nothing had disturbed it.
void fill_actions(Recording& recording) {
  const PlantSpec& spec = recording.plant->spec();
  const auto physical = [&](double value, std::size_t i) {
    return spec.action_offset[i] + spec.action_scale[i] * value;
  };
  const auto saturated = [&](double value, std::size_t i) {
    return clip(value, spec.action_low[i], spec.action_high[i]);
  };
  const auto commanded = [&](double value, std::size_t i) {
    return (value - spec.action_offset[i]) / spec.action_scale[i];
  };
  if (!recording.has("a_phys") && recording.has("a_raw")) recording.physical = mapped(recording.command, physical);
  if (!recording.has("a_noisy"))
    recording.disturbed = recording.has("a_applied") ? recording.applied : recording.physical;
  if (!recording.has("a_applied")) recording.applied = mapped(recording.disturbed, saturated);
  if (!recording.commanded()) recording.physical = recording.disturbed;
  if (!recording.has("a_raw")) recording.command = mapped(recording.physical, commanded);
}

std::string lines_of(std::span<const Meaning> meanings) {
  std::string text;
  for (const Meaning& meaning : meanings) text += fmt::format("  {:<32}{}\n", meaning.name, meaning.text);
  return text;
}

}  // namespace

std::vector<std::string> force_columns(const std::string& prefix, const PlantSpec& spec) {
  std::vector<std::string> names;
  for (const Component& force : spec.force) names.push_back(cat(prefix, "_", force.name.substr(1)));
  return names;
}

bool Recording::has(std::string_view column) const {
  const std::string first = column.starts_with("a_") ? cat(column, "0") : std::string(column);
  return std::ranges::any_of(columns, [&](const std::string& one) { return one == column || one == first; });
}

std::unique_ptr<Policy> Recording::controller() const {
  if (gain.size() == 0) return cascade ? cascade_policy(*plant, *cascade) : nullptr;
  std::vector<FeedbackKnot> knots = reference_knots(*plant, gain);
  for (FeedbackKnot& knot : knots)
    knot.action = Eigen::Map<const Eigen::VectorXd>(action_goal.data(), knot.action.size());
  return feedback_policy(*plant, std::move(knots));
}

Recording read_recording(const NamedBytes& description, const NamedBytes& records) {
  const CsvText csv{records.bytes, records.name};
  Recording recording = read_description(description, csv_header(csv));
  const Columns columns = columns_of(recording);
  const auto count = static_cast<std::size_t>(recording.plant->spec().steps) + 1;
  columns.hand_out(read_csv(csv, columns.wanted, count));
  fill_actions(recording);
  if (recording.force.rows() == 0) recording.force = Matrix<double>(recording.plant->spec().force.size(), count);
  return recording;
}

std::string recording_format() {
  return cat(
      "A recording is two files, NAME.json and NAME.csv. The JSON file must hold\n", lines_of(recording_keys()),
      "must hold, where it is to be judged,\n", lines_of(judged_recording_keys()), "and may hold\n",
      lines_of(optional_recording_keys()),
      "Other keys and null are ignored. The CSV file has a header line and columns in any order. Needed are\n",
      lines_of(kNeededColumns), "What else it has is judged:\n", lines_of(kColumns),
      "Record 0 may leave its actions, forces, reward and sq_err blank. Several actions are numbered, as a_raw0, "
      "a_raw1.\n");
}

}  // namespace gust
