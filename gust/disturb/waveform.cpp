#include "gust/disturb/waveform.h"

namespace gust {

#define GUST_ENTRY(name) Entry<Waveform> waveform_##name();
#include "gust/disturb/waveforms/list.inc"
#undef GUST_ENTRY

const Catalog<Waveform>& waveforms() {
  static const Catalog<Waveform> catalog("waveform", {
#define GUST_ENTRY(name) waveform_##name(),
#include "gust/disturb/waveforms/list.inc"
#undef GUST_ENTRY
                                                     });
  return catalog;
}

}  // namespace gust
