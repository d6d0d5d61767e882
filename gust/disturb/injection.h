#pragma once

#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gust/core/catalog.h"
#include "gust/disturb/effect.h"
#include "gust/disturb/waveform.h"
#include "gust/sim/interface.h"

namespace gust {

/// Where a disturbance enters the loop: what the policy sees, what it does, or what pulls at the plant.
enum class Site { kObservation, kAction, kDynamics };

inline constexpr Site kSites[] = {Site::kObservation, Site::kAction, Site::kDynamics};

std::string_view site_name(Site site);
Site site_from(std::string_view name, const Place& place);

/// The components that a site disturbs: what is measured, the physical action, the external force.
/// Empty if there is no such site.
const std::vector<Component>& channels_of(Site site, const Interface& spec);

/// The names of the sites that there are.
std::vector<std::string> sites_of(const Interface& spec);

/// A disturbance at a site: a waveform that is added or an effect that maps the signal; which channels, how strongly,
/// and during which control steps.
struct Injection {
  Site site = Site::kAction;
  Made<Waveform> waveform;      ///< without an object where it is an effect
  Made<Effect> effect;          ///< without an object where it is a waveform
  std::vector<double> factors;  ///< per channel; 0 leaves a channel alone, an effect knows 1 beside it
  double level = 1.0;
  std::int64_t start = 0;  ///< window in control steps; the shape itself always runs from step 0
  std::int64_t end = std::numeric_limits<std::int64_t>::max();  ///< exclusive

  bool is_effect() const { return effect.object != nullptr; }
  /// Of the waveform or the effect.
  const std::string& kind() const { return is_effect() ? effect.kind : waveform.kind; }
  std::string shape() const { return is_effect() ? effect.canonical() : waveform.canonical(); }
  bool random() const { return is_effect() ? effect->random() : waveform->random(); }
  /// The first control step at which the shape acts, and how often it repeats [Hz]; 0 where there is no such thing.
  std::int64_t onset() const { return is_effect() ? 0 : waveform->onset(); }
  double frequency() const { return is_effect() ? 0 : waveform->frequency(); }
  /// Whether the level leaves the shape of a waveform alone.
  bool scales() const { return is_effect() || waveform->scales(); }

  /// What multiplies its signals at a level: the level, or 1 where that is part of the shape.
  double factor(double at_level) const { return scales() ? at_level : 1.0; }

  /// All that makes the disturbance, but not its level.
  std::string canonical() const;
};

/// Why a disturbance has no such level; empty if it may have it.
std::string level_complaint(const Injection& injection, double level);

/// What disturbances together must not have: two effects at a site that change signals within a control step. Empty if
/// they may be together.
std::string together_complaint(std::span<const Injection> injections);

/// Reads site, waveform or effect, channels or mask, start, end and level from a table. Keys that are not its own must
/// be named in `also`.
Injection read_injection(const Table& table, const Interface& spec, const std::vector<std::string>& also = {});

class Signals;

/// What shapes need that a level does not scale: the level of each injection (1 where none are given), and what
/// disturbed the episode before, on which they go on; nothing of the first episode.
struct WaveHistory {
  std::span<const double> levels = {};
  const Signals* before = nullptr;
};

/// The values of some injections over one episode, to be multiplied by Injection::factor(level): channel c of injection
/// i at index k. For actions and dynamics the index is the control step. For observations it is the number of the
/// observation: 0 is reset's. Random waveforms are drawn by that number; deterministic ones follow the control step,
/// and both the observation of reset and that of step 0 see step 0 (docs/disturbances.md 1). A shape that goes on from
/// episode to episode has one value a control step, at the observation site one an observation, of every episode to its
/// horizon: it goes on where that of the episode before ends.
class Signals {
 public:
  /// Streams are named by site, position among the injections of that site, and channel: nothing else moves them.
  Signals(std::span<const Injection> injections, const Interface& spec, Rng episode, const WaveHistory& history = {});

  /// The values of one channel, steps + 1 of them.
  const double* channel(std::size_t injection, std::size_t channel) const {
    return values_.data() + (first_[injection] + channel) * length_;
  }

 private:
  std::size_t length_;
  std::vector<std::size_t> first_;
  std::vector<double> values_;
  std::vector<WaveState> ends_;  // of each channel, after the last value of the episode
};

/// Whether a level scales all shapes: each episode's signals are then the same at every level and stand alone.
bool all_scale(std::span<const Injection> injections);

/// What disturbs the episodes of one cell of a sweep, or of one environment of a training, drawn one after the other.
/// Episode e has the stream episodes.split(e); all of it depends on e alone, and not on what was asked for before.
class SignalSequence {
 public:
  /// The injections and the spec must outlive it. One level an injection.
  SignalSequence(std::span<const Injection> injections, const Interface& spec, std::vector<double> levels, Rng episodes)
      : injections_(injections), spec_(spec), levels_(std::move(levels)), episodes_(episodes) {}

  /// The signals of an episode; null without injections. Later episodes cost least if asked for in order.
  std::shared_ptr<const Signals> at(std::int64_t episode);

 private:
  std::span<const Injection> injections_;
  const Interface& spec_;
  std::vector<double> levels_;
  Rng episodes_;
  std::shared_ptr<const Signals> last_;
  std::int64_t next_ = 0;  // number of the episode after last_
};

}  // namespace gust
