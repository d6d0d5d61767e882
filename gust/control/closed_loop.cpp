#include "gust/control/closed_loop.h"

#include <algorithm>
#include <cmath>

#include "gust/core/math.h"

namespace gust {
namespace {

Matrix<double> filled_rows(std::size_t lanes, const std::vector<double>& values) {
  Matrix<double> matrix(values.size(), lanes);
  for (std::size_t i = 0; i < values.size(); ++i) std::ranges::fill(matrix.row(i), values[i]);
  return matrix;
}

/// f on every pack of a row; rows are padded, so whole packs may be run.
template <class F>
void for_each_pack(std::size_t lanes, F&& f) {
  for (std::size_t lane = 0; lane < lanes; lane += kPackLanes) f(lane);
}

DisturbedLoop disturbed_loop(const PlantSpec& spec) {
  return {spec.steps, spec.control_rate, std::lround(spec.physics_rate / spec.control_rate), spec.action_goal};
}

Effort effort_from(std::string_view name) {
  if (name == "commanded") return Effort::kCommanded;
  return name == "disturbed" ? Effort::kDisturbed : Effort::kApplied;
}

}  // namespace

ClosedLoop::ClosedLoop(const Plant& plant, const Readings& readings, std::span<const Injection> injections,
                       std::size_t lanes)
    : plant_(plant),
      effort_(effort_from(readings.effort)),
      disturber_(injections, disturbed_loop(plant.spec()), lanes),
      actuator_(plant.spec(), readings, lanes, disturber_.may_split()),
      lanes_(lanes),
      counter_(lanes, 0),
      failed_(lanes, 0),
      touched_ground_(lanes, 0),
      state_(plant.spec().state.size() + plant.spec().hidden, lanes),
      parameters_(filled_rows(Matrix<double>::padded(lanes), nominal_parameters(plant.spec()))),
      goal_(plant.spec().state.size(), lanes),
      observation_(plant.spec().observations(), lanes),
      force_(plant.spec().force.size(), lanes),
      reward_commanded_(1, lanes),
      reward_disturbed_(1, lanes),
      reward_applied_(1, lanes),
      cost_(1, lanes) {
  const std::size_t states = goal_.rows();
  if (disturber_.may_split()) {
    early_force_ = Matrix<double>(plant.spec().force.size(), lanes);
    early_observation_ = Matrix<double>(states, lanes);
    substeps_ = Matrix<double>(std::size(kSites), lanes);
  }
  references_.resize(plant.spec().references * states);
  for (std::size_t sample = 0; sample < plant.spec().references; ++sample)
    plant.reference(sample, std::span(references_).subspan(sample * states, states));
  for (std::size_t i = 0; i < states; ++i) std::ranges::fill(goal_.row(i), references_[i]);
}

void ClosedLoop::begin(std::size_t lane, const EpisodeStart& start) {
  const PlantSpec& spec = plant_.spec();
  GUST_CHECK(start.state.size() == spec.state.size() && start.parameters.size() == spec.parameters.size());
  counter_[lane] = start.step;
  failed_[lane] = touched_ground_[lane] = 0;
  disturber_.begin(lane, start);
  for (std::size_t i = 0; i < spec.state.size(); ++i) state_.at(i, lane) = start.state[i];
  for (std::size_t i = 0; i < spec.parameters.size(); ++i) parameters_.at(i, lane) = start.parameters[i];
  plant_.begin(state_.view(), lane, start.step > 0);
  for (std::size_t i = 0; i < spec.state.size(); ++i) observation_.at(i, lane) = start.state[i];
  show_references(lane);
  disturber_.apply(Site::kObservation, counter_[lane], observation_.view(), lane);
}

void ClosedLoop::step(Rows<const double> command, const Offsets& offsets) noexcept {
  actuator_.act(command, counter_, disturber_, offsets.action);
  set_forces(offsets.force);
  advance();
  for (std::int64_t& counter : counter_) ++counter;
  set_goal();
  judge();
  observe(offsets.observation);
}

/// Moves the plant; in two parts where a signal changes within the step in any lane.
void ClosedLoop::advance() noexcept {
  const Motion motion{state_.view(), parameters_.view(), actuator_.applied(), force_.view()};
  if (!disturber_.may_split()) return plant_.advance(motion);
  const double substeps = std::round(plant_.spec().physics_rate / plant_.spec().control_rate);
  for (const Site site : kSites) {
    const std::span<const double> split = disturber_.split(site);
    const std::span<double> at = substeps_.row(static_cast<std::size_t>(site));
    for (std::size_t lane = 0; lane < lanes_; ++lane)
      at[lane] = site == Site::kObservation ? substeps - split[lane] : split[lane];
  }
  const auto of = [&](Site site) {
    return Rows<const double>{substeps_.row(static_cast<std::size_t>(site)).data(), 1, lanes_, 0};
  };
  const SplitStep split{.action = actuator_.applied_early(),
                        .force = early_force_.view(),
                        .action_until = of(Site::kAction),
                        .force_until = of(Site::kDynamics),
                        .seen_after = of(Site::kObservation),
                        .seen = early_observation_.view()};
  plant_.advance({motion.state, motion.parameters, motion.action, motion.force, &split});
}

/// Set once a control step and held over its substeps.
void ClosedLoop::set_forces(Rows<const double> offset) noexcept {
  for (std::size_t i = 0; i < force_.rows(); ++i) std::ranges::fill(force_.row(i), 0.0);
  for (std::size_t i = 0; i < early_force_.rows(); ++i) std::ranges::fill(early_force_.row(i), 0.0);
  disturber_.apply(Site::kDynamics, counter_, force_.view(), offset, early_force_.view());
}

/// State `sample` of the reference, which stands still at its end.
std::span<const double> ClosedLoop::reference(std::int64_t sample) const noexcept {
  const std::size_t states = goal_.rows();
  const auto last = static_cast<std::int64_t>(plant_.spec().references) - 1;
  return std::span(references_).subspan(static_cast<std::size_t>(std::min(sample, last)) * states, states);
}

/// What the state after the step is compared with.
void ClosedLoop::set_goal() noexcept {
  if (plant_.spec().references == 1) return;
  const auto lag = static_cast<std::int64_t>(plant_.spec().reference_lag);
  for (std::size_t lane = 0; lane < lanes_; ++lane) {
    const auto goal = reference(counter_[lane] - lag);
    for (std::size_t i = 0; i < goal.size(); ++i) goal_.at(i, lane) = goal[i];
  }
}

/// The references ahead, after the state in the observation. The first observation never lags (docs/plants.md 2.4).
void ClosedLoop::show_references(std::size_t lane) noexcept {
  const PlantSpec& spec = plant_.spec();
  const auto lag = static_cast<std::int64_t>(counter_[lane] > 0 ? spec.reference_lag : 0);
  for (std::size_t ahead = 1; ahead <= spec.horizon; ++ahead) {
    const auto shown = reference(counter_[lane] - lag + static_cast<std::int64_t>(ahead));
    for (std::size_t i = 0; i < shown.size(); ++i) observation_.at(ahead * shown.size() + i, lane) = shown[i];
  }
}

/// Reward and failure come from the true state after the step.
void ClosedLoop::judge() noexcept {
  const PlantSpec& spec = plant_.spec();
  for_each_pack(lanes_, [&](std::size_t lane) {
    Pack cost{};
    for (std::size_t i = 0; i < spec.state.size(); ++i) {
      if (spec.state_weights[i] == 0.0) continue;
      const Pack value = load(&state_.at(i, lane));
      const Pack error = (spec.wraps[i] ? wrap_angle(value) : value) - load(&goal_.at(i, lane));
      cost += spec.state_weights[i] * error * error;
    }
    store(&cost_.at(0, lane), cost);
  });
  charge(commanded(), reward_commanded_.row(0));
  charge(disturbed(), reward_disturbed_.row(0));
  if (effort_ == Effort::kApplied) charge(applied(), reward_applied_.row(0));
  std::ranges::fill(failed_, std::uint8_t{0});
  for (std::size_t i = 0; i < spec.state.size(); ++i) {
    for (std::size_t lane = 0; lane < lanes_; ++lane) {
      const double value = state_.at(i, lane);
      const bool inside = value >= spec.fail_low[i] && value <= spec.fail_high[i] && std::isfinite(value);
      failed_[lane] |= static_cast<std::uint8_t>(!inside);  // NaN is never inside
    }
  }
  if (!spec.contact) return;
  for (std::size_t lane = 0; lane < lanes_; ++lane) touched_ground_[lane] = state_.at(*spec.contact, lane) != 0.0;
}

StepRecord ClosedLoop::record() const {
  return {.reward = reward(),
          .failed = failed_,
          .not_finite_command = actuator_.not_finite(),
          .touched_ground = touched_ground_,
          .reward_commanded = reward_commanded(),
          .reward_disturbed = reward_disturbed(),
          .state = state(),
          .goal = goal(),
          .commanded = commanded(),
          .disturbed = disturbed(),
          .applied = applied(),
          .force = force()};
}

std::span<const double> ClosedLoop::reward() const {
  switch (effort_) {
    case Effort::kCommanded:
      return reward_commanded_.row(0);
    case Effort::kDisturbed:
      return reward_disturbed_.row(0);
    default:
      return reward_applied_.row(0);
  }
}

/// reward = exp(-(cost + w_u sum (u - u_goal)^2)); docs/plants.md 1.5.
void ClosedLoop::charge(Rows<const double> action, std::span<double> reward) const noexcept {
  const PlantSpec& spec = plant_.spec();
  for_each_pack(lanes_, [&](std::size_t lane) {
    Pack effort{};
    for (std::size_t i = 0; i < action.rows; ++i) {
      const Pack difference = load(&action.at(i, lane)) - spec.action_goal[i];
      effort += difference * difference;
    }
    store(&reward[lane], gust::exp(-(load(&cost_.at(0, lane)) + spec.action_weight * effort)));
  });
}

void ClosedLoop::observe(Rows<const double> offset) noexcept {
  for (std::size_t i = 0; i < goal_.rows(); ++i) std::ranges::copy(state_.row(i), observation_.row(i).begin());
  if (plant_.spec().horizon > 0) {
    for (std::size_t lane = 0; lane < lanes_; ++lane) show_references(lane);
  }
  disturber_.apply(Site::kObservation, counter_, observation_.view(), offset, early_observation_.view());
}

std::vector<double> random_start(const PlantSpec& spec, Rng episode) {
  const Rng rng = episode.split("start");
  std::vector<double> state = spec.start;
  for (std::size_t i = 0; i < state.size(); ++i)
    state[i] += spec.start_offset[i] + spec.start_range[i] * (2.0 * rng.uniform(i) - 1.0);
  return state;
}

}  // namespace gust
