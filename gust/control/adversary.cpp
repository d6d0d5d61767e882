#include "gust/control/adversary.h"

#include "gust/core/math.h"

namespace gust {

void adversary_value(const AdversarySite& at, Rows<const double> action, Rows<double> value) noexcept {
  for (std::size_t i = 0; i < value.rows; ++i) {
    for (std::size_t lane = 0; lane < value.lanes; ++lane)
      value.at(i, lane) = at.scale * clip(action.at(i, lane), -1.0, 1.0) + at.offset;
  }
}

void step_against(ClosedLoop& loop, Rows<const double> command, Site site, Rows<const double> value) noexcept {
  switch (site) {
    case Site::kDynamics:
      return loop.step(command, {.force = value});
    case Site::kAction:
      return loop.step(command, {.action = value});
    default:
      return loop.step(command, {.observation = value});
  }
}

}  // namespace gust
