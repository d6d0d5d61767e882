#include "gust/control/disturber.h"

#include <algorithm>

namespace gust {

Disturber::Disturber(std::span<const Injection> injections, const DisturbedLoop& loop, std::size_t lanes)
    : injections_(injections),
      loop_(loop),
      signals_(lanes),
      factors_(injections.size(), lanes),
      levels_(injections.size(), lanes),
      splits_(std::size(kSites), lanes),
      memory_(injections.size()),
      fresh_(injections.size()),
      on_(lanes) {
  for (std::size_t i = 0; i < injections.size(); ++i) {
    if (!injections[i].is_effect()) continue;
    may_split_ = may_split_ || (loop.substeps > 1 && injections[i].effect->may_split());
    memory_[i].resize(lanes);
    fresh_[i].resize(lanes);
    const std::size_t channels = injections[i].factors.size();
    nothing_.resize(std::max(nothing_.size(), channels));
    if (injections[i].site == Site::kAction) loop_.resting_action.resize(channels);
  }
}

void Disturber::begin(std::size_t lane, const EpisodeStart& start) {
  GUST_CHECK(start.levels.size() == injections_.size() && (injections_.empty() || start.signals));
  signals_[lane] = start.signals;
  for (const Site site : kSites) splits_.at(static_cast<std::size_t>(site), lane) = 0;
  for (std::size_t i = 0; i < injections_.size(); ++i) {
    const Injection& injection = injections_[i];
    factors_.at(i, lane) = injection.factor(start.levels[i]);
    levels_.at(i, lane) = start.levels[i];
    if (!injection.is_effect()) continue;
    const EffectPlace place = place_of(injection.site);
    memory_[i][lane].resize(injection.factors.size() * injection.effect->memory(start.levels[i], place));
    fresh_[i][lane] = 1;
    const auto split = static_cast<double>(injection.effect->split(start.levels[i], place));
    if (split > 0) splits_.at(static_cast<std::size_t>(injection.site), lane) = split;
  }
}

void Disturber::apply(Site site, std::span<const std::int64_t> step, Rows<double> signal, Rows<const double> offset,
                      Rows<double> early) noexcept {
  const bool disturbed = std::ranges::any_of(injections_, [&](const Injection& each) { return each.site == site; });
  if (disturbed) apply_to({0, signal.lanes}, site, step, signal, early);
  for (const Rows<double>& part : {signal, early}) {
    for (std::size_t i = 0; part.rows > 0 && i < offset.rows; ++i) {
      for (std::size_t lane = 0; lane < offset.lanes; ++lane) part.at(i, lane) += offset.at(i, lane);
    }
  }
}

void Disturber::apply(Site site, std::int64_t step, Rows<double> signal, std::size_t lane) noexcept {
  apply_to({lane, 1}, site, std::span(&step, 1), signal, {});
}

void Disturber::apply_to(const Lanes& lanes, Site site, std::span<const std::int64_t> step, Rows<double> signal,
                         Rows<double> early) noexcept {
  for (std::size_t i = 0; i < injections_.size(); ++i) {
    if (injections_[i].site != site) continue;
    if (injections_[i].is_effect()) {
      map(i, lanes, step, signal, early);
      continue;
    }
    for (std::size_t n = 0; n < lanes.count; ++n) {
      add(i, step[n], signal, lanes.first + n);
      if (early.rows > 0) add(i, step[n], early, lanes.first + n);
    }
  }
}

void Disturber::add(std::size_t injection, std::int64_t step, Rows<double> signal, std::size_t lane) noexcept {
  const std::int64_t k = std::min(step, loop_.steps);
  const double factor = factors_.at(injection, lane);
  for (std::size_t c = 0; c < injections_[injection].factors.size(); ++c)
    signal.at(c, lane) += factor * signals_[lane]->channel(injection, c)[k];
}

/// Windows are those of waveforms: an observation belongs to the control step before it, that of reset to the first.
void Disturber::map(std::size_t injection, const Lanes& lanes, std::span<const std::int64_t> step, Rows<double> signal,
                    Rows<double> early) noexcept {
  const Injection& by = injections_[injection];
  const bool seen = by.site == Site::kObservation;
  for (std::size_t n = 0; n < lanes.count; ++n) {
    const std::int64_t at = seen && step[n] > 0 ? step[n] - 1 : step[n];
    on_[lanes.first + n] = at >= by.start && at < by.end ? 1 : 0;
  }
  const std::size_t channels = by.factors.size();
  EffectBatch batch{.place = place_of(by.site), .early = early, .late = signal.first_rows(channels)};
  batch.factors = by.factors;
  if (!seen)
    batch.rest = by.site == Site::kAction ? std::span(loop_.resting_action) : std::span(nothing_).first(channels);
  batch.level = levels_.row(injection);
  batch.on = on_;
  batch.fresh = fresh_[injection];
  batch.memory = memory_[injection];
  batch.first = lanes.first;
  batch.count = lanes.count;
  by.effect->apply(batch);
}

}  // namespace gust
