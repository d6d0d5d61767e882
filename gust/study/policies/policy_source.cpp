#include "gust/study/policies/policy_source.h"

namespace gust {

#define GUST_ENTRY(name) PolicyKind policy_##name();
#include "gust/study/policies/list.inc"
#undef GUST_ENTRY

const std::vector<PolicyKind>& policy_kinds() {
  static const std::vector<PolicyKind> kinds = {
#define GUST_ENTRY(name) policy_##name(),
#include "gust/study/policies/list.inc"
#undef GUST_ENTRY
  };
  return kinds;
}

std::vector<std::string> policy_kind_names() {
  std::vector<std::string> names;
  for (const PolicyKind& kind : policy_kinds()) names.push_back(kind.name);
  return names;
}

const PolicyKind& policy_kind(std::string_view name, const Place& place) {
  for (const PolicyKind& kind : policy_kinds()) {
    if (kind.name == name) return kind;
  }
  throw error_at(place, "unknown policy kind '", name, "'", did_you_mean(name, policy_kind_names()), "; kinds are ",
                 join(policy_kind_names(), ", "), " (gust list policies)");
}

}  // namespace gust
