#pragma once

#include <cmath>
#include <memory>

#include "gust/eval/metric.h"

namespace gust {

/// The metric of a struct with `static constexpr MetricTraits kTraits` and `double value(const Episode&) const`. It is
/// one of all plants, or of those that `static bool applies(const Interface&)` names. With `static constexpr Quotient
/// kQuotient` it is a quotient of means.
template <class Options>
class OptionsMetric final : public Metric {
 public:
  explicit OptionsMetric(const Options& options) : options_(options) {}
  double value(const Episode& episode) const override { return options_.value(episode); }
  std::optional<Quotient> quotient() const override {
    if constexpr (requires { Options::kQuotient; }) return Options::kQuotient;
    return std::nullopt;
  }
  const MetricTraits& traits() const override { return Options::kTraits; }
  bool applies(const Interface& spec) const override {
    if constexpr (requires { Options::applies(spec); }) return Options::applies(spec);
    return true;
  }

 private:
  Options options_;
};

template <class Options>
Entry<Metric> metric_entry(std::string name, std::string summary, std::string source) {
  return make_entry<Metric, Options>(
      std::move(name), std::move(summary), std::move(source),
      [](const Options& options) { return std::make_unique<OptionsMetric<Options>>(options); });
}

/// The sum over the time, in control steps as a number.
inline double steps_of(const EpisodePart& part) { return static_cast<double>(part.steps); }

// Three ways to make one root mean squared error (docs/metrics.md 1.2), over the steps of a part.
inline double rmse_all(const EpisodePart& part) { return std::sqrt(part.squared_error / steps_of(part)); }
inline double rmse_masked(const EpisodePart& part) { return std::sqrt(part.squared_masked_error / steps_of(part)); }
inline double root_sum(const EpisodePart& part) { return std::sqrt(part.squared_error); }

/// Whether a plant's state has a component of this name at a position.
inline bool has_state(const Interface& spec, std::size_t component, std::string_view name) {
  return component < spec.state.size() && spec.state[component].name == name;
}

/// The largest size of a state component; NaN where a state was no number, which makes the sum of errors NaN too.
inline double max_abs(const EpisodePart& part, std::size_t component) {
  return std::isnan(part.squared_error) ? part.squared_error : part.max_abs_state[component];
}

}  // namespace gust
