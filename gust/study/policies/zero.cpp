#include "gust/study/policies/policy_entry.h"

namespace gust {
namespace {

struct Zero final : PolicySource {
  static constexpr std::tuple<> kFields = {};

  std::string canonical(const PolicyMember&) const override { return "zero\n"; }
  std::unique_ptr<Policy> make(const Setup& setup, const PolicyMember&) const override {
    const Interface& spec = setup.plant->spec();
    return zero_policy(spec.observations(), spec.action.size());
  }
};

}  // namespace

PolicyKind policy_zero() {
  return policy_entry<Zero>({"zero", "Does nothing: the plant by itself, each action 0 in the policy's unit.", "gust",
                             "[[policy]]\nname = \"nothing\"\nkind = \"zero\""});
}

}  // namespace gust
