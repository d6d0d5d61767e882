#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "gust/core/catalog.h"
#include "gust/core/rows.h"

namespace gust {

/// What an effect knows of the signal that it maps.
struct EffectPlace {
  double rate = 0;            ///< control steps a second [Hz]
  std::int64_t substeps = 1;  ///< of the plant in a control step; 1 where they cannot be told apart
  std::int64_t steps = 0;     ///< control steps in an episode
  bool seen = false;          ///< an observation at the end of a control step; else the signal acts during the step
};

/// The value of a channel in one control step, which may change between two substeps. Of a signal that acts, `early`
/// acts first and `late` from there on. Of one that is seen, `early` was there before the end of the step and `late` at
/// its end. Where the change lies is Effect::split(). Without a change both are equal.
struct EffectValue {
  double early = 0;
  double late = 0;
};

/// The channels of one signal in a batch of episodes, one a lane, in one control step.
struct EffectBatch {
  EffectPlace place;
  Rows<double> early, late;               ///< channels x lanes; without `early` nothing changes within a step
  std::span<const double> factors;        ///< by channel; 0 leaves it alone
  std::span<const double> rest;           ///< by channel: the signal before an episode; empty: its first value
  std::span<const double> level;          ///< by lane
  std::span<const std::uint8_t> on;       ///< by lane: within the window; outside it remembers and changes nothing
  std::span<std::uint8_t> fresh;          ///< by lane: this is the first value of the episode; it is cleared
  std::span<std::vector<double>> memory;  ///< by lane: what each channel remembers, one after the other
  std::size_t first = 0, count = 0;       ///< the lanes to be mapped
};

/// A disturbance that maps a signal and remembers it, where a waveform adds one. The level says how strong it is, from
/// 0, which changes no bit.
class Effect {
 public:
  virtual ~Effect() = default;

  /// Maps a signal in place. The bits of a lane do not depend on the others.
  virtual void apply(const EffectBatch& batch) const noexcept = 0;

  /// Numbers that it remembers of each channel at a level.
  virtual std::size_t memory(double level, const EffectPlace& place) const = 0;

  /// How many substeps of a control step lie on the other side of the change: the first ones of a signal that acts, the
  /// last ones of one that is seen; 0 where the signal changes with the control steps alone.
  virtual std::int64_t split(double level, const EffectPlace& place) const = 0;
  /// Whether split() may be other than 0; a site has one such effect at most.
  virtual bool may_split() const = 0;

  /// What the level is measured in.
  virtual std::string_view unit() const = 0;
  /// Beyond this level the search for a failure ends.
  virtual double limit(double rate) const = 0;
  /// Whether it depends on random numbers.
  virtual bool random() const = 0;
};

/// Every effect there is, in the order of effects/list.inc.
const Catalog<Effect>& effects();

}  // namespace gust
