#include "gust/agents/temperature.h"

#include "gust/core/math.h"

namespace gust {

Temperature::Temperature(const OffPolicyOptions& options, std::size_t actions)
    : automatic_(options.auto_temperature),
      target_entropy_(options.target_entropy * static_cast<double>(actions)),
      adam_options_{.rate = options.temperature_rate, .epsilon = options.adam_epsilon},
      log_value_(log(options.temperature)),
      value_(options.temperature),
      adam_(1) {}

void Temperature::update(std::span<const float> log_density) {
  if (!automatic_) return;
  double mean = 0.0;
  for (const float density : log_density) mean += density;
  mean /= static_cast<double>(log_density.size());
  double gradient = -(mean + target_entropy_);
  adam_step<double>(adam_options_, adam_, {&log_value_, 1}, {&gradient, 1});
  value_ = exp(log_value_);
}

}  // namespace gust
