#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "gust/disturb/waveform.h"
#include "gust/sim/plant.h"

namespace gust {

/// Where a disturbance enters the loop: what the policy sees, what it does, or what pulls at the plant.
enum class Site { kObservation, kAction, kDynamics };

inline constexpr Site kSites[] = {Site::kObservation, Site::kAction, Site::kDynamics};

std::string_view site_name(Site site);
Site site_from(std::string_view name, const Place& place);

/// The components that a site disturbs: the state part of the observation, the physical action, the external force.
const std::vector<Component>& channels_of(Site site, const PlantSpec& spec);

/// A waveform at a site: which channels, how strongly, and during which control steps.
struct Injection {
  Site site = Site::kAction;
  Made<Waveform> waveform;
  std::vector<double> factors;  ///< per channel; 0 leaves a channel alone
  double level = 1.0;
  std::int64_t start = 0;  ///< window in control steps; the shape itself always runs from step 0
  std::int64_t end = std::numeric_limits<std::int64_t>::max();  ///< exclusive

  /// All that makes the disturbance, but not its level.
  std::string canonical() const;
};

/// Reads site, waveform, channels or mask, start, end and level from a table. Keys that are not its own must be named
/// in `also`.
Injection read_injection(const Table& table, const PlantSpec& spec, const std::vector<std::string>& also = {});

/// The values of some injections over one episode at level 1: channel c of injection i at index k. For actions and
/// dynamics the index is the control step. For observations it is the number of the observation: 0 is reset's.
/// Random waveforms are drawn by that number; deterministic ones follow the control step, and both the observation of
/// reset and that of step 0 see step 0 (tasks 3.1).
class Signals {
 public:
  /// Streams are named by site, position among the injections of that site, and channel: nothing else moves them.
  Signals(std::span<const Injection> injections, const PlantSpec& spec, Rng episode);

  /// The values of one channel, steps + 1 of them.
  const double* channel(std::size_t injection, std::size_t channel) const {
    return values_.data() + (first_[injection] + channel) * length_;
  }

 private:
  std::size_t length_;
  std::vector<std::size_t> first_;
  std::vector<double> values_;
};

}  // namespace gust
