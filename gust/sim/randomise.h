#pragma once

#include <span>

#include "gust/sim/distribution.h"
#include "gust/sim/interface.h"

namespace gust {

/// A parameter of the plant that is sampled for every episode.
struct ParameterDraw {
  std::size_t parameter = 0;  ///< in the order of the plant's spec
  Made<Distribution> distribution;
  double offset = 0;  ///< added to what is drawn: the nominal value where ranges are additive, else 0
};

/// Domain randomisation (docs/disturbances.md 5): parameters drawn at the start of an episode, independently, and held
/// over it.
struct Randomisation {
  std::string name;  ///< of a preset's range, for people; empty if the study spells it out
  std::vector<ParameterDraw> draws;

  /// All that makes the draws; empty if there are none.
  std::string canonical(const Interface& spec) const;
  /// For people: "mid", or the parameters that are drawn.
  std::string label(const Interface& spec) const;
};

/// Reads "mode" (absolute, the default, or additive: the draw is added to the nominal value) and a distribution for
/// each parameter by name: its "kind" (uniform if it says none) and all of its options. An Error at the place for an
/// unknown parameter, and for a range that lets it be zero or less.
Randomisation read_randomisation(const Table& table, const Interface& spec);

/// The parameters of an episode; those that are not drawn are nominal. Each has a stream of its own, by its name.
std::vector<double> draw_parameters(std::span<const ParameterDraw> draws, const Interface& spec, const Rng& episode);

}  // namespace gust
