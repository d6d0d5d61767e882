#include "gust/agents/agent.h"

namespace gust {

#define GUST_ENTRY(name) Entry<Agent> agent_##name();
#include "gust/agents/list.inc"
#undef GUST_ENTRY

const Catalog<Agent>& agents() {
  static const Catalog<Agent> catalog("agent", {
#define GUST_ENTRY(name) agent_##name(),
#include "gust/agents/list.inc"
#undef GUST_ENTRY
                                               });
  return catalog;
}

}  // namespace gust
