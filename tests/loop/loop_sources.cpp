// The loops of a program that has a thermostat and a drift. This file takes the place of gust/control/loop_sources.cpp.
#include "gust/control/loop_source.h"

namespace gust {

Entry<LoopSource> loop_thermostat();
Entry<LoopSource> loop_drift();

const Catalog<LoopSource>& loop_sources() {
  static const Catalog<LoopSource> catalog("plant", {loop_thermostat(), loop_drift()});
  return catalog;
}

}  // namespace gust
