#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "gust/control/loop.h"

namespace gust {

/// Sums over the steps of an episode, from the true state after each step. What the loop does not tell stays 0, and no
/// metric is made of it.
struct EpisodePart {
  std::int64_t steps = 0;
  double return_sum = 0;        ///< reward as the readings charge it
  double return_commanded = 0;  ///< NaN where the loop has one reward only
  double return_disturbed = 0;
  double squared_error = 0;          ///< sum of |state - goal|^2, all components, angles not wrapped
  double squared_masked_error = 0;   ///< the same over the components with error_weights
  double squared_state = 0;          ///< sum of |state|^2, all components, angles not wrapped
  std::int64_t saturated_steps = 0;  ///< steps in which the actuator could not give the disturbed sum
  std::vector<double> max_abs_state;
  std::vector<double> final_state;
};

/// An action of the policy that was NaN or infinite.
struct NotFiniteAction {
  std::int64_t step = 0;           ///< control steps before it
  double value = 0;                ///< what it was
  std::vector<double> state = {};  ///< the true state in which it was given; empty: the one in which the episode began
};

/// "the policy gave NaN at step 3, state x = 0.1 m, …": for people.
std::string not_finite_text(const NotFiniteAction& action, const Interface& spec);

/// What is remembered of one episode: up to its end if failure ends it, and over the whole horizon as if it did not.
/// All metrics are functions of this.
struct Episode {
  EpisodePart ended;  ///< up to and with the step that failed
  EpisodePart whole;  ///< all steps of the horizon
  bool failed = false;
  std::int64_t safe_steps = 0;  ///< steps up to and with the one that failed; all of them if none did
  bool over = false;            ///< ended without a failure, before the horizon
  bool touched_ground = false;
  bool finite = true;  ///< false if a state or reward was no finite number; sums are then NaN where it entered
  std::optional<NotFiniteAction> not_finite = {};  ///< the first one, before the episode failed
  double control_rate = 0;
  std::int64_t horizon = 0;
  std::size_t angle = 0;  ///< which state component is the angle

  /// The part that counts when failure does or does not terminate.
  const EpisodePart& part(bool terminate) const { return terminate ? ended : whole; }
};

/// Watches every lane of a loop from its begin() on, through the horizon.
class EpisodeMeter {
 public:
  EpisodeMeter(const Interface& spec, std::size_t lanes);

  /// Forgets what it knew of a lane.
  void begin(std::size_t lane);
  /// Takes in the loop's last step; what the interface says is told must be there.
  void record(const StepRecord& step);
  const Episode& episode(std::size_t lane) const { return episodes_[lane]; }

 private:
  void record_lane(const StepRecord& step, std::size_t lane);

  const Interface& spec_;
  std::vector<Episode> episodes_;
};

}  // namespace gust
