#pragma once

#include <span>

#include "gust/agents/off_policy_options.h"
#include "gust/nn/adam.h"

namespace gust {

/// The weight of the entropy (docs/algorithms.md 2.2): fixed, or moved along the gradient of -log alpha mean(log pi +
/// target), at log alpha.
class Temperature {
 public:
  Temperature(const OffPolicyOptions& options, std::size_t actions);

  double value() const { return value_; }
  double log_value() const { return log_value_; }

  /// One step after the policy's actions had these log densities; nothing where the temperature is fixed.
  void update(std::span<const float> log_density);

  template <class Archive, class Self>
  static void archive(Archive& archive, Self& self) {
    archive.number(self.log_value_);
    archive.number(self.value_);
    archive.block(std::span(self.adam_.first));
    archive.block(std::span(self.adam_.second));
    archive.number(self.adam_.beta1_power);
    archive.number(self.adam_.beta2_power);
  }

 private:
  bool automatic_;
  double target_entropy_;
  AdamOptions adam_options_;
  double log_value_;
  double value_;
  AdamState<double> adam_;
};

}  // namespace gust
