#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "gust/core/rows.h"
#include "gust/disturb/injection.h"

namespace gust {

/// How an episode begins: true state, plant parameters, and what disturbs it.
struct EpisodeStart {
  std::vector<double> state;               ///< visible components
  std::vector<double> parameters;          ///< in the order of the plant's spec
  std::vector<double> levels;              ///< one per injection
  std::shared_ptr<const Signals> signals;  ///< shared: many lanes meet the same noise at their own levels
  std::int64_t step = 0;                   ///< control steps that lie before; the plant is then in motion
};

/// Disturbs the signals of a batch of episodes, one a lane, site by site. Every loop uses it, so that there is one
/// order: the disturbances of a site in the order in which the study lists them, then what an adversary adds.
///
/// A loop calls apply() once a control step for each site that it has, with the signal as it is without disturbances:
/// the action before the actuator's bounds, the force (0) before the plant moves, and the observation after it. The
/// bits of a lane do not depend on the others.
class Disturber {
 public:
  /// The injections must outlive it. Episodes have `steps` control steps; beyond them the last value is held.
  Disturber(std::span<const Injection> injections, std::int64_t steps, std::size_t lanes);

  /// Puts a lane at the start of an episode.
  void begin(std::size_t lane, const EpisodeStart& start);

  /// Disturbs the signal of a site in every lane, channels x lanes: `step` tells the control steps that each lane's
  /// episode has behind it, `offset` is added last, in its rows.
  void apply(Site site, std::span<const std::int64_t> step, Rows<double> signal, Rows<const double> offset) noexcept;
  /// The same for one lane, without an offset: the observation with which its episode begins.
  void apply(Site site, std::int64_t step, Rows<double> signal, std::size_t lane) noexcept;

 private:
  std::span<const Injection> injections_;
  std::int64_t steps_;
  std::vector<std::shared_ptr<const Signals>> signals_;  // of each lane
  Matrix<double> factors_;                               // injections x lanes
};

}  // namespace gust
