#include "gust/sim/distribution.h"

namespace gust {

#define GUST_ENTRY(name) Entry<Distribution> distribution_##name();
#include "gust/sim/distributions/list.inc"
#undef GUST_ENTRY

const Catalog<Distribution>& distributions() {
  static const Catalog<Distribution> catalog("distribution", {
#define GUST_ENTRY(name) distribution_##name(),
#include "gust/sim/distributions/list.inc"
#undef GUST_ENTRY
                                                             });
  return catalog;
}

}  // namespace gust
