#pragma once

#include "gust/control/closed_loop.h"

namespace gust {

/// Where an adversary acts and how far it reaches. Its action v, one number a channel of the site, becomes
///
///   w = scale clip(v, -1, 1) + offset        [physical units of the site]
///
/// which is added to the site's disturbance for one control step (docs/disturbances.md 4): a force, a share of the
/// actuator's input, or what the next observation is off by. The reference simulator takes the observation site and
/// then ignores it.
struct AdversarySite {
  Site site = Site::kDynamics;
  double scale = 0.1;
  double offset = 0.0;
};

/// How many numbers an adversary at this site gives.
inline std::size_t adversary_channels(const AdversarySite& at, const Interface& spec) {
  return channels_of(at.site, spec).size();
}

/// What the site feels of an adversary's action; both channels x lanes. `value` may be the action.
void adversary_value(const AdversarySite& at, Rows<const double> action, Rows<double> value) noexcept;

/// One step of the loop with the protagonist's commands and the values that an adversary adds at a site.
void step_against(ClosedLoop& loop, Rows<const double> command, Site site, Rows<const double> value) noexcept;

}  // namespace gust
