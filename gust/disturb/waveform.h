#pragma once

#include <span>

#include "gust/core/catalog.h"
#include "gust/core/rng.h"

namespace gust {

/// Where a wave that goes on from episode to episode is after its last value.
struct WaveState {
  double value = 0;
  double direction = 1;  ///< 1 away from zero, -1 back to it
};

/// The shape of a disturbance over one episode, one scalar per control step; a level scales it, or is part of it.
///
/// A waveform is open loop: it knows the step and a random stream, and nothing of plant, policy or site.
class Waveform {
 public:
  virtual ~Waveform() = default;

  /// Writes the value for step k of an episode into out[k]; rate is the control rate [Hz]. Of a shape that a level does
  /// not scale these are the values of the first episode at level 1.
  /// Equal arguments give equal bits, on any thread and for any batch size.
  virtual void fill(std::span<double> out, double rate, Rng rng) const = 0;

  /// Whether a level multiplies the values. Where it does not, it sets the shape, and the shape goes on from episode to
  /// episode: go_on() writes it.
  virtual bool scales() const = 0;

  /// Writes the next values at a level into out and moves the state behind them; rng is the stream of this episode.
  virtual void go_on(WaveState& state, std::span<double> out, double level, Rng rng) const = 0;

  /// Whether the values depend on the random stream: each channel then has its own.
  virtual bool random() const = 0;

  /// The last control step at which the shape begins to act, for windows that can be checked; 0 if from the start.
  virtual std::int64_t onset() const = 0;

  /// Periods per second of a wave that repeats [Hz], its harmonics not counted; 0 if it does not repeat.
  virtual double frequency() const = 0;
};

/// Every waveform there is, in the order of waveforms/list.inc.
const Catalog<Waveform>& waveforms();

}  // namespace gust
