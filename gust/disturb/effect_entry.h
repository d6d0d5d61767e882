#pragma once

#include <algorithm>
#include <memory>

#include "gust/disturb/effect.h"

namespace gust {

/// The effect of a struct of options with these functions, of which the last two may be missing:
///
/// - EffectValue apply(EffectValue, double level, const EffectPlace&, std::span<double> memory) const noexcept
/// - std::string_view unit() const
/// - double limit(double rate) const
/// - std::size_t memory(double level, const EffectPlace&) const: numbers that it remembers of each channel
/// - std::int64_t split(double level, const EffectPlace&) const: it changes signals within a control step
///
/// At the first value of an episode its memory is filled with what the signal was before: the rest value of an action,
/// 0 of a force, the first value itself of an observation.
template <class Options>
class OptionsEffect final : public Effect {
 public:
  explicit OptionsEffect(const Options& options) : options_(options) {}

  void apply(const EffectBatch& batch) const noexcept override {
    for (std::size_t lane = batch.first; lane < batch.first + batch.count; ++lane) apply_lane(batch, lane);
  }
  std::size_t memory(double level, const EffectPlace& place) const override {
    if constexpr (requires { options_.memory(level, place); }) return options_.memory(level, place);
    return 0;
  }
  std::int64_t split(double level, const EffectPlace& place) const override {
    if constexpr (kMaySplit) return options_.split(level, place);
    return 0;
  }
  bool may_split() const override { return kMaySplit; }
  std::string_view unit() const override { return options_.unit(); }
  double limit(double rate) const override { return options_.limit(rate); }
  bool random() const override {
    if constexpr (requires { Options::kRandom; }) return Options::kRandom;
    return false;
  }

 private:
  static constexpr bool kMaySplit =
      requires(const Options& options, const EffectPlace& place) { options.split(0.0, place); };

  void apply_lane(const EffectBatch& batch, std::size_t lane) const noexcept {
    const std::span<double> all = batch.memory[lane];
    const std::size_t size = all.size() / std::max<std::size_t>(1, batch.late.rows);
    for (std::size_t c = 0; c < batch.late.rows; ++c) {
      if (batch.factors[c] == 0) continue;
      const std::span<double> remembered = all.subspan(c * size, size);
      const double late = batch.late.at(c, lane);
      const EffectValue value{batch.early.rows > 0 ? batch.early.at(c, lane) : late, late};
      if (batch.fresh[lane]) std::ranges::fill(remembered, batch.rest.empty() ? late : batch.rest[c]);
      const EffectValue mapped = options_.apply(value, batch.level[lane], batch.place, remembered);
      if (!batch.on[lane]) continue;
      batch.late.at(c, lane) = mapped.late;
      if (batch.early.rows > 0) batch.early.at(c, lane) = mapped.early;
    }
    batch.fresh[lane] = 0;
  }

  Options options_;
};

template <class Options>
Entry<Effect> effect_entry(std::string name, std::string summary, std::string source) {
  return make_entry<Effect, Options>(
      std::move(name), std::move(summary), std::move(source),
      [](const Options& options) { return std::make_unique<OptionsEffect<Options>>(options); });
}

}  // namespace gust
