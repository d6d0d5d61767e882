#include "gust/control/cascade.h"
#include "gust/study/policies/policy_entry.h"

namespace gust {
namespace {

struct Pd final : PolicySource {
  static constexpr std::tuple<> kFields = {};

  void prepare(const PolicyContext& context) override {
    if (context.equations("pd").spec().cascade) return;
    throw error_at(context.place, "the plant ", context.setup.plant.kind, " has no policy 'pd'; try lqr or zero");
  }
  std::string canonical(const PolicyMember&) const override { return "pd\n"; }
  std::unique_ptr<Policy> make(const Setup& setup, const PolicyMember&) const override {
    const Plant& plant = setup.equations("pd", {});
    return cascade_policy(plant, *plant.spec().cascade);
  }
};

}  // namespace

PolicyKind policy_pd() {
  return policy_entry<Pd>(
      {"pd",
       "A cascade of two proportional-derivative loops with the gains that the plant knows; the quadrotor has one. It "
       "needs the whole range of the actuators and fails where command_clip = \"box\".",
       "docs/policies.md 2", "plant = { kind = \"quadrotor\" }\n\n[[policy]]\nname = \"pd\"\nkind = \"pd\""});
}

}  // namespace gust
