#include "gust/disturb/effect.h"

namespace gust {

#define GUST_ENTRY(name) Entry<Effect> effect_##name();
#include "gust/disturb/effects/list.inc"
#undef GUST_ENTRY

const Catalog<Effect>& effects() {
  static const Catalog<Effect> catalog("effect", {
#define GUST_ENTRY(name) effect_##name(),
#include "gust/disturb/effects/list.inc"
#undef GUST_ENTRY
                                                 });
  return catalog;
}

}  // namespace gust
