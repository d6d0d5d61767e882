#pragma once

#include "gust/agents/ppo_options.h"
#include "gust/control/adversary.h"

namespace gust {

/// PPO's options, which hold for both sides, and where the other side acts: what RARL and RAP share
/// (docs/algorithms.md 3.1).
struct AdversarialOptions : PpoOptions {
  std::string site = "dynamics";
  double scale = 0.1;
  double offset = 0.0;

  static constexpr std::tuple kFields = std::tuple_cat(
      PpoOptions::kFields,
      std::tuple{
          field("site", &AdversarialOptions::site, "where an adversary acts", one_of("dynamics|action|observation")),
          field("scale", &AdversarialOptions::scale,
                "an adversary's action, clipped to [-1, 1], is added there times this, in the site's unit", positive),
          field("offset", &AdversarialOptions::offset, "what is added there besides, in the site's unit"),
      });

  AdversarySite against() const { return {site_from(site, {"site"}), scale, offset}; }

  /// Throws Error at the place if the plant has nothing at the site.
  void check_plant(const PlantSpec& spec, const Place& place) const {
    if (adversary_channels(against(), spec) > 0) return;
    throw error_at(place, "the plant has nothing at the site '", site, "' that an adversary could act on");
  }
};

}  // namespace gust
