#pragma once

#include "gust/agents/cvar.h"
#include "gust/agents/off_policy_options.h"
#include "gust/agents/return_law.h"

namespace gust {

/// Worst cases policy gradients (Tang et al. 2020) on soft actor-critic (docs/algorithms.md 4). The defaults are what
/// was published: the profile `wcpg`.
struct WcpgOptions : OffPolicyOptions {
  double alpha_min = 0.01;
  double alpha_max = 1.0;
  double alpha = 0.3;
  bool alpha_relabel = false;
  std::string cvar_coef = "correct";
  std::string variance_target = "second_moment";
  std::string variance_loss = "wasserstein";
  bool entropy_in_variance = true;

  static constexpr Range kLevel{.low = 0, .high = 1, .low_open = true};
  static constexpr std::tuple kFields = std::tuple_cat(
      OffPolicyOptions::kFields,
      std::tuple{
          field("alpha_min", &WcpgOptions::alpha_min,
                "least risk level: every episode draws one from U(alpha_min, alpha_max), and keeps it", kLevel),
          field("alpha_max", &WcpgOptions::alpha_max, "greatest risk level; equal to alpha_min for a fixed one",
                kLevel),
          field("alpha", &WcpgOptions::alpha,
                "level at which the finished policy acts, unless it is told another; alpha_min where that is fixed",
                kLevel),
          field("alpha_relabel", &WcpgOptions::alpha_relabel,
                "sample a transition's level again whenever it is learned from; plants do not know it"),
          field("cvar_coef", &WcpgOptions::cvar_coef,
                "correct: phi(z) / alpha at the quantile z; literal: phi(alpha) / Phi(alpha), as printed",
                one_of("correct|literal")),
          field("variance_target", &WcpgOptions::variance_target,
                "second_moment: published, noisy where values are large; squared_td: of the temporal difference",
                one_of("second_moment|squared_td")),
          field("variance_loss", &WcpgOptions::variance_loss,
                "wasserstein: published, too low on sampled targets; unbiased: half the squared error of the variance; "
                "divergence: Kullback-Leibler's, unbiased and in the unit of the mean's",
                one_of("wasserstein|unbiased|divergence")),
          field("entropy_in_variance", &WcpgOptions::entropy_in_variance,
                "the variance is that of the soft return, entropy included"),
      });

  void check(const Place& place) const {
    OffPolicyOptions::check(place);
    if (alpha_min > alpha_max)
      throw error_at(place, "'alpha_min' must be at most 'alpha_max' = ", alpha_max, ", got ", alpha_min);
    if (variance_loss == "divergence" && variance_target != "squared_td")
      throw error_at(place, "'variance_loss' divergence needs 'variance_target' squared_td: the other may be negative");
    if (alpha_min < alpha_max && (alpha < alpha_min || alpha > alpha_max))
      throw error_at(place, "'alpha' must be from 'alpha_min' to 'alpha_max', ", alpha_min, " to ", alpha_max, ", got ",
                     alpha);
  }

  /// Level of the finished policy.
  double acts_at() const { return alpha_min == alpha_max ? alpha_min : alpha; }
  CvarForm cvar_form() const { return cvar_coef == "literal" ? CvarForm::kLiteral : CvarForm::kCorrect; }
  ReturnLossOptions loss() const {
    const VarianceLoss form = variance_loss == "wasserstein" ? VarianceLoss::kWasserstein
                              : variance_loss == "unbiased"  ? VarianceLoss::kUnbiased
                                                             : VarianceLoss::kDivergence;
    return {discount, variance_target == "second_moment", form, entropy_in_variance};
  }
};

}  // namespace gust
