#include "gust/sim/plant.h"

#include <algorithm>

namespace gust {

std::size_t parameter_index(const PlantSpec& spec, const std::string& name, const Place& place) {
  std::vector<std::string> names;
  for (const Parameter& parameter : spec.parameters) names.push_back(parameter.name);
  const auto at = std::ranges::find(names, name);
  if (at == names.end()) {
    throw error_at(place, "unknown parameter '", name, "'", did_you_mean(name, names), "; the plant has ",
                   join(names, ", "));
  }
  return static_cast<std::size_t>(at - names.begin());
}

#define GUST_ENTRY(name) Entry<Plant> plant_##name();
#include "gust/sim/plants/list.inc"
#undef GUST_ENTRY

const Catalog<Plant>& plants() {
  static const Catalog<Plant> catalog("plant", {
#define GUST_ENTRY(name) plant_##name(),
#include "gust/sim/plants/list.inc"
#undef GUST_ENTRY
                                               });
  return catalog;
}

}  // namespace gust
