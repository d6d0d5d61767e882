#include "gust/sim/plant.h"

namespace gust {

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
