#include "gust/control/validate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gust/control/closed_loop.h"
#include "gust/core/text.h"

namespace gust {
namespace {

/// The recordings charge the disturbed action and saturate it afterwards.
const Readings kRecordedReadings{
    .effort = "disturbed", .saturate = "after", .command_clip = "none", .tap_point = "com"};

/// Some consecutive control steps, one a lane: lane i is the step that leads to record first + 1 + i.
struct Stretch {
  std::size_t first;
  std::size_t lanes;
};

Matrix<double> cut(const Matrix<double>& all, std::size_t from, std::size_t lanes) {
  Matrix<double> part(all.rows(), lanes);
  for (std::size_t i = 0; i < all.rows(); ++i)
    std::ranges::copy_n(&all.at(i, from), static_cast<std::ptrdiff_t>(lanes), part.row(i).begin());
  return part;
}

Matrix<double> difference(const Matrix<double>& a, const Matrix<double>& b) {
  Matrix<double> result(a.rows(), a.lanes());
  for (std::size_t i = 0; i < a.rows(); ++i) {
    for (std::size_t lane = 0; lane < a.lanes(); ++lane) result.at(i, lane) = a.at(i, lane) - b.at(i, lane);
  }
  return result;
}

EpisodeStart start_at(const Recording& recording, std::size_t record) {
  EpisodeStart start{{}, nominal_parameters(recording.plant->spec()), {}, {}, static_cast<std::int64_t>(record)};
  for (std::size_t i = 0; i < recording.state.rows(); ++i) start.state.push_back(recording.state.at(i, record));
  return start;
}

/// The plant by itself: recorded applied action and force.
void check_plant(const Recording& recording, const Stretch& at, Validation& result) {
  const Plant& plant = *recording.plant;
  const std::size_t states = plant.spec().state.size();
  Matrix<double> state(states + plant.spec().hidden, at.lanes);
  Matrix<double> parameters(plant.spec().parameters.size(), at.lanes);
  for (std::size_t lane = 0; lane < at.lanes; ++lane) {
    for (std::size_t i = 0; i < states; ++i) state.at(i, lane) = recording.state.at(i, at.first + lane);
    for (std::size_t i = 0; i < parameters.rows(); ++i) parameters.at(i, lane) = plant.spec().parameters[i].nominal;
    plant.begin(state.view(), lane, at.first + lane > 0);
  }
  const Matrix<double> action = cut(recording.applied, at.first + 1, at.lanes);
  const Matrix<double> force = cut(recording.force, at.first + 1, at.lanes);

  plant.advance({state.view(), parameters.view(), action.view(), force.view()});

  for (std::size_t i = 0; i < states; ++i) {
    for (std::size_t lane = 0; lane < at.lanes; ++lane) {
      const std::size_t record = at.first + 1 + lane;
      result.one_step[i].take(state.at(i, lane) - recording.state.at(i, record), record);
    }
  }
}

double squared_error(const Recording& recording, const ClosedLoop& loop, std::size_t lane) {
  double sum = 0;
  for (std::size_t i = 0; i < recording.error_weights.size(); ++i) {
    const double error = recording.error_weights[i] * (loop.state().at(i, lane) - loop.goal().at(i, lane));
    sum += error * error;
  }
  return sum;
}

bool reached_goal(const Recording& recording, const ClosedLoop& loop, std::size_t lane) {
  double sum = 0;
  for (std::size_t i = 0; i < recording.state.rows(); ++i) {
    const double error = loop.state().at(i, lane) - loop.goal().at(i, lane);
    sum += error * error;
  }
  return std::sqrt(sum) < recording.goal_tolerance;
}

JudgedParts parts_of(const Recording& recording) {
  const bool disturbed = recording.has("a_noisy");
  return {.applied = disturbed && recording.has("a_applied"),
          .reward = recording.has("reward") && (disturbed || recording.plant->spec().action_weight == 0),
          .squared_error = recording.has("sq_err"),
          .out_of_bounds = recording.has("out_of_bounds"),
          .done = recording.has("done"),
          .time_limit = recording.has("timelimit"),
          .closed_loop = recording.controller() && recording.commanded() && recording.observation.rows() > 0};
}

/// Whether a lane's flags are those of the record, where they are recorded. The time limit is only told where nothing
/// else ends the episode.
bool flags_equal(const Recording& recording, const ClosedLoop& loop, std::size_t lane, std::size_t record,
                 const JudgedParts& parts) {
  const auto flag = [&](Recorded row) { return recording.outcome.at(static_cast<std::size_t>(row), record) != 0; };
  const bool ended = loop.failed(lane) || reached_goal(recording, loop, lane);
  const bool time_limit = record >= recording.steps() && !ended;
  return (!parts.out_of_bounds || flag(Recorded::kOutOfBounds) == loop.failed(lane)) &&
         (!parts.done || flag(Recorded::kDone) == (ended || time_limit)) &&
         (!parts.time_limit || flag(Recorded::kTimeLimit) == time_limit);
}

/// The loop charges actions from the plant's own goal; the recording's may be another.
double reward_of(const Recording& recording, const ClosedLoop& loop, std::size_t lane, std::size_t record) {
  const PlantSpec& spec = recording.plant->spec();
  if (recording.action_goal == spec.action_goal) return loop.reward()[lane];
  double more = 0;
  for (std::size_t i = 0; i < spec.action.size(); ++i) {
    const double action = recording.disturbed.at(i, record);
    const double theirs = action - recording.action_goal[i];
    const double ours = action - spec.action_goal[i];
    more += theirs * theirs - ours * ours;
  }
  return loop.reward()[lane] * std::exp(-spec.action_weight * more);
}

void judge_lane(const Recording& recording, const ClosedLoop& loop, std::size_t lane, std::size_t record,
                Validation& result) {
  const auto recorded = [&](Recorded row) { return recording.outcome.at(static_cast<std::size_t>(row), record); };
  if (result.parts.applied) {
    for (std::size_t i = 0; i < recording.applied.rows(); ++i)
      result.applied.take(loop.applied().at(i, lane) - recording.applied.at(i, record), record);
  }
  if (result.parts.reward) {
    const double reward = recorded(Recorded::kReward);
    result.reward.take(
        reward_of(recording, loop, lane, record) - (recording.exponential_reward ? reward : std::exp(reward)), record);
  }
  if (result.parts.squared_error) {
    const double squared = recorded(Recorded::kSquaredError);
    result.squared_error.take((squared_error(recording, loop, lane) - squared) / std::max(1.0, squared), record);
  }
  if (flags_equal(recording, loop, lane, record, result.parts)) return;
  if (result.flags_differ++ == 0) result.first_flag = record;
}

/// The order of a control step: recorded command, recorded share of the disturbances, and all else the loop's own.
void check_order(const Recording& recording, const Stretch& at, Validation& result) {
  ClosedLoop loop(*recording.plant, kRecordedReadings, {}, at.lanes);
  for (std::size_t lane = 0; lane < at.lanes; ++lane) loop.begin(lane, start_at(recording, at.first + lane));
  for (std::size_t i = recording.state.rows(); i < recording.observation.rows(); ++i) {
    for (std::size_t lane = 0; lane < at.lanes; ++lane) {
      const std::size_t record = at.first + lane;
      result.reference.take(loop.observation().at(i, lane) - recording.observation.at(i, record), record);
    }
  }
  const Matrix<double> command = cut(recording.command, at.first + 1, at.lanes);
  const Matrix<double> force_offset = cut(recording.force, at.first + 1, at.lanes);
  const Matrix<double> action_offset =
      difference(cut(recording.disturbed, at.first + 1, at.lanes), cut(recording.physical, at.first + 1, at.lanes));

  loop.step(command.view(), {.action = action_offset.view(), .force = force_offset.view()});

  for (std::size_t lane = 0; lane < at.lanes; ++lane) judge_lane(recording, loop, lane, at.first + 1 + lane, result);
}

/// The recorded controller on the model's own state, with the recorded noise.
void check_loop(const Recording& recording, Validation& result) {
  const Plant& plant = *recording.plant;
  const std::unique_ptr<Policy> policy = recording.controller();
  ClosedLoop loop(plant, kRecordedReadings, {}, 1);
  loop.begin(0, start_at(recording, 0));
  const std::size_t states = recording.state.rows();
  const Matrix<double> action_noise = difference(recording.disturbed, recording.physical);
  Matrix<double> seen(recording.observation.rows(), 1);
  Matrix<double> command(recording.command.rows(), 1);
  for (std::size_t k = 0; k < result.judged; ++k) {
    for (std::size_t i = 0; i < states; ++i) {
      const double noise = recording.observation.at(i, k) - recording.state.at(i, k);
      seen.at(i, 0) = loop.state().at(i, 0) + noise;
    }
    for (std::size_t i = states; i < seen.rows(); ++i) seen.at(i, 0) = loop.observation().at(i, 0);
    policy->act(seen.view(), loop.steps_done(), command.view());
    const Matrix<double> force_offset = cut(recording.force, k + 1, 1);
    const Matrix<double> action_offset = cut(action_noise, k + 1, 1);
    loop.step(command.view(), {.action = action_offset.view(), .force = force_offset.view()});
    for (std::size_t i = 0; i < states; ++i) {
      result.closed_loop[i].take(loop.state().at(i, 0) - recording.state.at(i, k + 1), k + 1);
    }
  }
}

/// Steps before the first record in which the ground may touch the plant.
std::size_t steps_off_ground(const Recording& recording) {
  std::vector<double> state(recording.state.rows());
  for (std::size_t record = 1; record <= recording.steps(); ++record) {
    for (std::size_t i = 0; i < state.size(); ++i) state[i] = recording.state.at(i, record);
    if (recording.plant->near_ground(state)) return record - 1;
  }
  return recording.steps();
}

/// The largest error of a list, as a sentence, if it is beyond a tolerance.
std::string fault_in(const std::vector<WorstError>& errors, const PlantSpec& spec, double tolerance,
                     std::string_view mode) {
  const auto by_size = [](const WorstError& a, const WorstError& b) { return a.error < b.error; };
  const auto worst = std::max_element(errors.begin(), errors.end(), by_size);
  if (worst == errors.end() || worst->error <= tolerance) return {};
  const Component& state = spec.state[static_cast<std::size_t>(worst - errors.begin())];
  return format("{} is off by {:.2g} {} at k = {} ({})", state.name, worst->error, state.unit, worst->record, mode);
}

std::string fault_of(const Validation& result, const Recording& recording, const Tolerances& tolerances) {
  const PlantSpec& spec = recording.plant->spec();
  if (result.judged == 0) return cat("0 of ", recording.steps(), " steps judged: near the ground from k = 1");
  if (std::string fault = fault_in(result.one_step, spec, tolerances.step, "one step"); !fault.empty()) return fault;
  const auto beyond = [&](const char* what, const WorstError& worst) {
    return worst.error <= tolerances.step ? ""
                                          : format("{} is off by {:.2g} at k = {}", what, worst.error, worst.record);
  };
  for (std::string fault :
       {beyond("a_applied", result.applied), beyond("reward", result.reward), beyond("sq_err", result.squared_error),
        beyond("the reference in the observation", result.reference)}) {
    if (!fault.empty()) return fault;
  }
  if (result.flags_differ > 0) {
    return cat("flags differ in ", result.flags_differ, " records, first at k = ", result.first_flag);
  }
  return fault_in(result.closed_loop, spec, tolerances.loop, "closed loop");
}

}  // namespace

void WorstError::take(double difference, std::size_t at) {
  const double size = std::abs(difference);
  if (size <= error) return;
  error = std::isnan(size) ? std::numeric_limits<double>::infinity() : size;
  record = at;
}

Validation validate(const Recording& recording, const Tolerances& tolerances) {
  constexpr std::size_t kLanes = 512;
  const PlantSpec& spec = recording.plant->spec();
  Validation result;
  result.one_step.resize(spec.state.size());
  result.parts = parts_of(recording);
  result.judged = steps_off_ground(recording);
  for (std::size_t first = 0; first < result.judged; first += kLanes) {
    const Stretch at{first, std::min(kLanes, result.judged - first)};
    check_plant(recording, at, result);
    check_order(recording, at, result);
  }
  if (result.parts.closed_loop) {
    result.closed_loop.resize(spec.state.size());
    check_loop(recording, result);
  }
  result.fault = fault_of(result, recording, tolerances);
  return result;
}

std::string not_recorded(const Recording& recording, const JudgedParts& parts) {
  std::vector<std::string> names;
  if (!parts.applied) names.emplace_back("applied");
  if (!parts.reward) names.emplace_back("reward");
  if (!parts.squared_error) names.emplace_back("sq_err");
  if (!parts.flags()) names.emplace_back("flags");
  if (parts.flags() && !parts.out_of_bounds) names.emplace_back("out_of_bounds");
  if (parts.flags() && !parts.done) names.emplace_back("done");
  if (parts.flags() && !parts.time_limit) names.emplace_back("timelimit");
  if (recording.controller() && !parts.closed_loop) names.emplace_back("closed loop");
  const PlantSpec& spec = recording.plant->spec();
  if (spec.observations() > spec.state.size() && recording.observation.rows() == 0) names.emplace_back("reference");
  names.insert(names.end(), recording.dropped.begin(), recording.dropped.end());
  return join(names, ", ");
}

std::string missing_forces(const Recording& recording) {
  std::vector<std::string> missing;
  for (const std::string& name : force_columns("f", recording.plant->spec())) {
    if (!recording.has(name)) missing.push_back(name);
  }
  if (missing.empty()) return {};
  return missing.size() == recording.plant->spec().force.size() ? "no force" : cat("no ", join(missing, ", "));
}

}  // namespace gust
