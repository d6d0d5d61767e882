#include "gust/control/disturber.h"

#include <algorithm>

namespace gust {

Disturber::Disturber(std::span<const Injection> injections, std::int64_t steps, std::size_t lanes)
    : injections_(injections), steps_(steps), signals_(lanes), factors_(injections.size(), lanes) {}

void Disturber::begin(std::size_t lane, const EpisodeStart& start) {
  GUST_CHECK(start.levels.size() == injections_.size() && (injections_.empty() || start.signals));
  signals_[lane] = start.signals;
  for (std::size_t i = 0; i < injections_.size(); ++i) factors_.at(i, lane) = injections_[i].factor(start.levels[i]);
}

void Disturber::apply(Site site, std::span<const std::int64_t> step, Rows<double> signal,
                      Rows<const double> offset) noexcept {
  const bool disturbed = std::ranges::any_of(injections_, [&](const Injection& each) { return each.site == site; });
  for (std::size_t lane = 0; disturbed && lane < signal.lanes; ++lane) apply(site, step[lane], signal, lane);
  for (std::size_t i = 0; i < offset.rows; ++i) {
    for (std::size_t lane = 0; lane < offset.lanes; ++lane) signal.at(i, lane) += offset.at(i, lane);
  }
}

void Disturber::apply(Site site, std::int64_t step, Rows<double> signal, std::size_t lane) noexcept {
  const std::int64_t k = std::min(step, steps_);
  for (std::size_t i = 0; i < injections_.size(); ++i) {
    if (injections_[i].site != site) continue;
    // Here a disturbance that maps the signal, with memory of this lane, takes the place of the sum.
    const double factor = factors_.at(i, lane);
    for (std::size_t c = 0; c < injections_[i].factors.size(); ++c) {
      signal.at(c, lane) += factor * signals_[lane]->channel(i, c)[k];
    }
  }
}

}  // namespace gust
