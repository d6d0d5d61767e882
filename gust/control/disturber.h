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

/// What a loop is to those who disturb it.
struct DisturbedLoop {
  std::int64_t steps = 0;                   ///< control steps in an episode; beyond them the last value is held
  double rate = 1;                          ///< control steps a second [Hz]
  std::int64_t substeps = 1;                ///< moves in a control step; 1: it has no state in between
  std::vector<double> resting_action = {};  ///< what acts before an episode; empty: 0
};

/// Disturbs the signals of a batch of episodes, one a lane, site by site. Every loop uses it, so that there is one
/// order: the disturbances of a site in the order in which the study lists them, then what an adversary adds.
///
/// A loop calls apply() once a control step for each site that it has, with the signal as it is without disturbances:
/// the action before the actuator's bounds, the force (0) before the plant moves, and the observation after it. Where
/// the plant moves in substeps, a signal may change within a step: then there are two of it (EffectValue), and split()
/// says where the change lies. The bits of a lane do not depend on the others.
class Disturber {
 public:
  /// The injections must outlive it.
  Disturber(std::span<const Injection> injections, const DisturbedLoop& loop, std::size_t lanes);

  /// Puts a lane at the start of an episode.
  void begin(std::size_t lane, const EpisodeStart& start);

  /// Whether a signal may change within a control step; and of each lane how many substeps lie before the change of an
  /// action or a force, or after the moment that an observation shows. 0 where nothing changes.
  bool may_split() const { return may_split_; }
  std::span<const double> split(Site site) const { return splits_.row(static_cast<std::size_t>(site)); }

  /// Disturbs the signal of a site in every lane, channels x lanes: `step` tells the control steps that each lane's
  /// episode has behind it, `offset` is added last, in its rows.
  void apply(Site site, std::span<const std::int64_t> step, Rows<double> signal, Rows<const double> offset,
             Rows<double> early = {}) noexcept;
  /// The same for one lane, without an offset: the observation with which its episode begins.
  void apply(Site site, std::int64_t step, Rows<double> signal, std::size_t lane) noexcept;

 private:
  struct Lanes {
    std::size_t first, count;
  };
  void apply_to(const Lanes& lanes, Site site, std::span<const std::int64_t> step, Rows<double> signal,
                Rows<double> early) noexcept;
  void add(std::size_t injection, std::int64_t step, Rows<double> signal, std::size_t lane) noexcept;
  void map(std::size_t injection, const Lanes& lanes, std::span<const std::int64_t> step, Rows<double> signal,
           Rows<double> early) noexcept;
  EffectPlace place_of(Site site) const {
    return {loop_.rate, loop_.substeps, loop_.steps, site == Site::kObservation};
  }

  std::span<const Injection> injections_;
  DisturbedLoop loop_;
  bool may_split_ = false;
  std::vector<std::shared_ptr<const Signals>> signals_;   // of each lane
  Matrix<double> factors_, levels_;                       // injections x lanes
  Matrix<double> splits_;                                 // sites x lanes
  std::vector<std::vector<std::vector<double>>> memory_;  // of each injection and lane, of effects alone
  std::vector<std::vector<std::uint8_t>> fresh_;          // the same: no value of the episode has come yet
  std::vector<std::uint8_t> on_;                          // by lane, for the effect at hand
  std::vector<double> nothing_;                           // the force before an episode
};

}  // namespace gust
