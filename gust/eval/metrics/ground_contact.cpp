#include "gust/eval/metric_entry.h"

namespace gust {
namespace {

struct GroundContact {
  static constexpr MetricTraits kTraits = {.title = "ground contact",
                                           .role = MetricRole::diagnostic,
                                           .higher_is_better = false,
                                           .zero_or_one = true,
                                           .needs = {.state = true}};
  static constexpr std::tuple<> kFields = {};

  static bool applies(const Interface& spec) { return spec.ground; }
  double value(const Episode& episode) const { return episode.touched_ground ? 1.0 : 0.0; }
};

}  // namespace

Entry<Metric> metric_ground_contact() {
  return metric_entry<GroundContact>(
      "ground_contact", "1 if the plant touched the ground, after which its motion is an approximation, else 0.",
      "gust (docs/plants.md 2.2)");
}

}  // namespace gust
