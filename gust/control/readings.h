#pragma once

#include "gust/core/fields.h"

namespace gust {

/// What the description of an experiment may leave open, decided once and passed on as a value.
struct Readings {
  std::string effort = "commanded";   ///< which action the reward charges
  std::string saturate = "after";     ///< when the actuator saturates, relative to the action disturbance
  std::string command_clip = "none";  ///< whether the policy's command is clipped to its action box first
  std::string tap_point = "com";      ///< where the dynamics site pulls

  static constexpr std::tuple kFields = {
      field("effort", &Readings::effort,
            "action that the reward charges: the command clipped to the actuator's bounds, the disturbed sum before "
            "saturation, or what the plant receives",
            one_of("commanded|disturbed|applied")),
      field("saturate", &Readings::saturate,
            "after: disturb, then clip to the actuator's bounds; before: clip the command to its box, then disturb",
            one_of("after|before")),
      field("command_clip", &Readings::command_clip,
            "box: clip the policy's command to its action box before anything else", one_of("none|box")),
      field("tap_point", &Readings::tap_point, "where a force at the dynamics site pulls, if the plant has a choice",
            one_of("com|tip")),
  };
};

}  // namespace gust
