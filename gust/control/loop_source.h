#pragma once

#include <memory>

#include "gust/control/loop.h"
#include "gust/core/catalog.h"

namespace gust {

class Plant;

/// Where episodes begin.
struct StartProtocol {
  std::string name;           ///< "nominal", "random", or the text of an explicit state
  bool random = false;        ///< sampled from the distribution of starts, seeded by the number of the episode
  std::vector<double> state;  ///< if not random
};

inline StartProtocol random_starts() { return {"random", true, {}}; }

/// Where loops come from: a plant of the catalogue, or anything else that can be reset and stepped. Immutable; loops
/// that it makes must not outlive it.
class LoopSource {
 public:
  virtual ~LoopSource() = default;

  virtual const Interface& spec() const = 0;

  /// The starts of a study that names none; levels are searched for from the first one.
  virtual std::vector<StartProtocol> starts() const = 0;
  /// EpisodeStart::state for an episode with these random streams.
  virtual std::vector<double> start_state(const StartProtocol& start, Rng episode) const = 0;
  /// Why no episode can begin there; empty if it can.
  virtual std::string start_complaint(const StartProtocol& /*start*/) const { return {}; }

  /// The injections must outlive the loop.
  virtual std::unique_ptr<Loop> make(std::span<const Injection> injections, std::size_t lanes) const = 0;

  /// What one control step of one lane takes on one core, guessed.
  virtual double seconds_per_step() const { return 1e-7; }

  /// The equations of motion, if loops are made of a plant; else null.
  virtual const Plant* plant() const { return nullptr; }
};

/// The sources of loops that are no plants, by the `kind` of a study's plant, in the order of loops/list.inc. A program
/// that brings loops of its own defines this function itself, and the linker leaves ours out (docs/extending.md).
const Catalog<LoopSource>& loop_sources();

}  // namespace gust
