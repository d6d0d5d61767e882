#pragma once

#include "gust/agents/off_policy_options.h"

namespace gust {

/// Risk-averse actor-critic (Urpi et al. 2021) on soft actor-critic (docs/algorithms.md 5). The defaults are what was
/// published, with two critics: the profile `raac`.
struct RaacOptions : OffPolicyOptions {
  double alpha = 0.3;
  double kappa = 1.0;
  std::int64_t fractions = 32;
  std::int64_t target_fractions = 32;
  std::int64_t actor_fractions = 8;
  std::string fraction_sets = "shared";
  bool stratified = false;
  bool raac_inv_alpha = false;
  std::int64_t critics = 2;
  std::int64_t cosines = 16;
  std::int64_t head = 32;

  static constexpr std::tuple kFields = std::tuple_cat(
      OffPolicyOptions::kFields,
      std::tuple{
          field("alpha", &RaacOptions::alpha,
                "risk level: the actor raises the mean of the worst share alpha of returns",
                Range{.low = 0, .high = 1, .low_open = true}),
          field("kappa", &RaacOptions::kappa,
                "where the loss turns from a square into a line; quantiles are exact only if returns spread far wider",
                between(1e-6, 1e6)),
          field("fractions", &RaacOptions::fractions, "quantiles of the critic an update", between(1, 256)),
          field("target_fractions", &RaacOptions::target_fractions, "quantiles of what follows an update",
                between(1, 256)),
          field("actor_fractions", &RaacOptions::actor_fractions, "quantiles below alpha that the actor raises",
                between(1, 256)),
          field("fraction_sets", &RaacOptions::fraction_sets,
                "shared: one set of fractions a minibatch; own: each transition draws its own, which takes longer",
                one_of("shared|own")),
          field("stratified", &RaacOptions::stratified,
                "the actor's fractions are spread over their interval, one in each part"),
          field("raac_inv_alpha", &RaacOptions::raac_inv_alpha,
                "multiply the actor's risk by 1 / alpha, as printed: the same as a temperature times alpha"),
          field("critics", &RaacOptions::critics, "critics; of two the actor raises the lesser", between(1, 2)),
          field("cosines", &RaacOptions::cosines, "that a fraction is embedded by", between(1, 256)),
          field("head", &RaacOptions::head, "width of the layer above trunk and embedding", between(1, 1024)),
      });

  /// The critics' heads, which see every fraction, come on top.
  double work() const { return OffPolicyOptions::work() * (1 + 2.26 * static_cast<double>(fractions) / 32); }
};

}  // namespace gust
