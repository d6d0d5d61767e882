#pragma once

#include <functional>
#include <span>

#include "gust/control/disturber.h"
#include "gust/control/policy.h"

namespace gust {

/// What happened in the last control step of a batch. Rows are components x lanes, spans have one number a lane; what a
/// loop cannot tell is empty.
struct StepRecord {
  std::span<const double> reward;
  std::span<const std::uint8_t> failed = {};  ///< 1 where the step failed
  std::span<const std::uint8_t> over = {};    ///< 1 where the episode has ended without a failure: no step counts after
  std::span<const double> not_finite_command = {};  ///< 0 where the command was finite, else the NaN or infinity in it
  std::span<const std::uint8_t> touched_ground = {};  ///< 1 where the ground was touched since the episode began
  std::span<const double> reward_commanded = {};      ///< rewards under both efforts that recordings have
  std::span<const double> reward_disturbed = {};
  Rows<const double> state = {}, goal = {};  ///< true state after the step, and what it should be
  Rows<const double> commanded = {}, disturbed = {}, applied = {};  ///< actions, physical; see Actuator
  Rows<const double> force = {};                                    ///< at the dynamics site
};

/// A batch of episodes, one a lane, stepped together: a policy's commands go in, observations and what happened come
/// out. Evaluation, learning curves and metrics know nothing else.
///
/// Every lane is by itself: it begins and begins again without touching the others, and its bits do not depend on them.
/// A loop applies its own disturbances, by a Disturber, at every site that its interface has.
class Loop {
 public:
  virtual ~Loop() = default;

  virtual const Interface& spec() const = 0;
  virtual std::size_t lanes() const = 0;

  /// Puts a lane at the start of an episode; its first observation is there afterwards.
  virtual void begin(std::size_t lane, const EpisodeStart& start) = 0;
  /// One control step of every lane with these commands, actions x lanes in the policy's unit.
  virtual void step(Rows<const double> command) = 0;

  /// What the policy sees now, disturbed; spec().observations() x lanes.
  virtual Rows<const double> observation() const = 0;
  /// Control steps done in each lane's episode.
  virtual std::span<const std::int64_t> steps_done() const = 0;
  /// Of the last step; before the first one only the state is meant.
  virtual StepRecord record() const = 0;
};

/// Runs one episode in every lane, over the whole horizon: a failure ends nothing here. `watch` is called before the
/// first step and after each one.
void run_episodes(Loop& loop, Policy& policy, std::span<const EpisodeStart> starts,
                  const std::function<void(std::int64_t steps)>& watch);

}  // namespace gust
