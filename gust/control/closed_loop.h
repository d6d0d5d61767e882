#pragma once

#include "gust/control/actuator.h"
#include "gust/control/loop.h"
#include "gust/sim/plant.h"

namespace gust {

/// Which action the reward charges; see Readings.
enum class Effort { kCommanded, kDisturbed, kApplied };

/// What is added at the sites beside the disturbances, in physical units: an adversary's share, or one that was
/// recorded. Absent rows are zero.
struct Offsets {
  Rows<const double> observation = {};  ///< to the state part of the observation after the step
  Rows<const double> action = {};
  Rows<const double> force = {};
};

/// The loop of a plant: the only place where equations of motion, disturbance and command meet. The plant and the
/// injections must outlive it.
class ClosedLoop final : public Loop {
 public:
  ClosedLoop(const Plant& plant, const Readings& readings, std::span<const Injection> injections, std::size_t lanes);

  void begin(std::size_t lane, const EpisodeStart& start) override;
  void step(Rows<const double> command) noexcept override { step(command, {}); }
  /// The same with what is added at the sites.
  void step(Rows<const double> command, const Offsets& offsets) noexcept;

  const Plant& plant() const { return plant_; }
  const PlantSpec& spec() const override { return plant_.spec(); }
  std::size_t lanes() const override { return lanes_; }
  std::int64_t steps_done(std::size_t lane) const { return counter_[lane]; }
  std::span<const std::int64_t> steps_done() const override { return counter_; }

  /// What the policy sees now: the disturbed state, then the references ahead; spec().observations() x lanes.
  Rows<const double> observation() const override { return observation_.view(); }
  StepRecord record() const override;

  // Parts of the record.
  Rows<const double> state() const { return state_.view().first_rows(plant_.spec().state.size()); }
  /// The reference that the last step's reward compared with.
  Rows<const double> goal() const { return goal_.view(); }
  Rows<const double> commanded() const { return actuator_.commanded(); }
  Rows<const double> disturbed() const { return actuator_.disturbed(); }
  Rows<const double> applied() const { return actuator_.applied(); }
  Rows<const double> force() const { return force_.view(); }
  /// Reward of the last step, charged with the effort that the readings name.
  std::span<const double> reward() const;
  std::span<const double> reward_commanded() const { return reward_commanded_.row(0); }
  std::span<const double> reward_disturbed() const { return reward_disturbed_.row(0); }
  /// Whether the true state has left the safe set in the last step, or is not finite.
  bool failed(std::size_t lane) const { return failed_[lane]; }

 private:
  void set_forces(Rows<const double> offset) noexcept;
  void advance() noexcept;
  void judge() noexcept;
  void charge(Rows<const double> action, std::span<double> reward) const noexcept;
  void observe(Rows<const double> offset) noexcept;
  void show_references(std::size_t lane) noexcept;
  void set_goal() noexcept;
  std::span<const double> reference(std::int64_t sample) const noexcept;

  const Plant& plant_;
  Effort effort_;
  Disturber disturber_;
  Actuator actuator_;
  std::size_t lanes_;
  std::vector<double> references_;  // state by state
  std::vector<std::int64_t> counter_;
  std::vector<std::uint8_t> failed_, touched_ground_;
  Matrix<double> state_, parameters_, goal_, observation_;
  Matrix<double> force_;
  // Where signals change within a control step: what comes before the change, and after how many substeps it lies.
  Matrix<double> early_force_, early_observation_, substeps_;
  Matrix<double> reward_commanded_, reward_disturbed_, reward_applied_, cost_;
};

/// A start state of the training distribution: nominal plus uniform, drawn from the episode's stream.
std::vector<double> random_start(const PlantSpec& spec, Rng episode);

}  // namespace gust
