// Nothing but this function: a program may replace the file by its own.
#include "gust/control/loop_source.h"

namespace gust {

#define GUST_ENTRY(name) Entry<LoopSource> loop_##name();
#include "gust/control/loops/list.inc"
#undef GUST_ENTRY

const Catalog<LoopSource>& loop_sources() {
  static const Catalog<LoopSource> catalog("plant", {
#define GUST_ENTRY(name) loop_##name(),
#include "gust/control/loops/list.inc"
#undef GUST_ENTRY
                                                    });
  return catalog;
}

}  // namespace gust
