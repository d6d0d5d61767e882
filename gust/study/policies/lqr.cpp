#include "gust/control/lqr.h"

#include "gust/study/policies/policy_entry.h"

namespace gust {
namespace {

struct Lqr final : PolicySource {
  Written q{"the reward's", "list of numbers"};
  Written r{"the reward's", "list of numbers"};

  static constexpr std::tuple kFields = {
      field("q", &Lqr::q,
            "weights of the states, the diagonal of Q; by default the reward's, where what it leaves free weighs 0.1",
            non_negative),
      field("r", &Lqr::r,
            "weights of the actions, the diagonal of R; by default the reward's, where an effort of a policy's whole "
            "authority weighs at least 0.01",
            positive),
  };

  void prepare(const PolicyContext& context) override {
    const Plant& plant = context.equations("lqr");
    const LqrWeights standard = reward_weights(plant.spec());
    weights_ = {numbers_or(q, "q", standard.q), numbers_or(r, "r", standard.r)};
    try {
      lqr_gain(plant, weights_);
    } catch (const Error& error) {
      throw error_at(context.place, error.what());
    }
  }

  std::string canonical(const PolicyMember&) const override {
    return cat("lqr q ", canonical_text(weights_.q), " r ", canonical_text(weights_.r), "\n");
  }

  std::unique_ptr<Policy> make(const Setup& setup, const PolicyMember&) const override {
    return lqr_policy(setup.equations("lqr", {}), weights_);
  }

 private:
  LqrWeights weights_;
};

}  // namespace

PolicyKind policy_lqr() {
  return policy_entry<Lqr>(
      {"lqr",
       "The linear-quadratic regulator of the plant, linearised at its goal. Along a moving reference its gain varies "
       "in time, about the best motion that iterated linear-quadratic steps find.",
       "docs/policies.md 1",
       "[[policy]]\nname = \"lqr\"\nkind = \"lqr\"\nq    = [1, 0.1, 1, 0.1]  # the cart-pole's states"});
}

}  // namespace gust
