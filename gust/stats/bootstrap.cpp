#include "gust/stats/bootstrap.h"

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "gust/core/error.h"
#include "gust/stats/statistics.h"

namespace gust {

double widened_tail(std::size_t units, double confidence) {
  GUST_CHECK(units > 1 && confidence > 0.0 && confidence < 1.0);
  const auto n = static_cast<double>(units);
  const boost::math::students_t student(n - 1.0);
  const double reach = boost::math::quantile(student, 0.5 + 0.5 * confidence) * std::sqrt(n / (n - 1.0));
  return boost::math::cdf(boost::math::normal(), -reach);
}

Bootstrap::Bootstrap(Rng rng, std::size_t resamples, double confidence)
    : rng_(rng), resamples_(resamples), confidence_(confidence) {
  GUST_CHECK(resamples > 0 && confidence > 0.0 && confidence < 1.0);
}

void Bootstrap::bound(Interval& interval, std::span<double> resampled) const {
  const double tail = 0.5 * (1.0 - confidence_);
  interval.low = quantile_reordering(resampled, tail);
  interval.high = quantile_reordering(resampled, 1.0 - tail);
}

const Bootstrap::Times* Bootstrap::kept(std::span<const std::size_t> strata) {
  constexpr std::size_t kMostDraws = std::size_t{1} << 20;  // 2 MB: 104 units at 10,000 resamples
  constexpr std::size_t kMostShapes = 32;
  const std::vector<std::size_t> key(strata.begin(), strata.end());
  const auto found = kept_.find(key);
  if (found != kept_.end()) return &found->second;
  std::size_t units = 0;
  for (const std::size_t size : strata) units += size;
  if (units * resamples_ > kMostDraws || kept_.size() == kMostShapes) return nullptr;
  Times& times = kept_.emplace(key, Times(units, resamples_)).first->second;
  draw(strata, 0, times.view());
  return &times;
}

std::size_t Bootstrap::group_size(std::size_t units) {
  return units <= kMostGroups ? 1 : (units + kMostGroups - 1) / kMostGroups;
}

void Bootstrap::draw(std::span<const std::size_t> strata, std::size_t first, Rows<std::uint16_t> times) const {
  std::fill_n(times.data, times.rows * times.stride, std::uint16_t{0});
  std::size_t offset = 0;
  for (std::size_t stratum = 0; stratum < strata.size(); ++stratum) {
    const std::size_t size = group_size(strata[stratum]);
    const std::size_t groups = strata[stratum] / size;
    const Rng rng = rng_.split(stratum);
    for (std::size_t lane = 0; lane < times.lanes; ++lane) {
      const std::size_t begin = (first + lane) * groups;
      std::uint64_t random = rng.bits(begin / 2);
      for (std::size_t i = begin; i < begin + groups; ++i) {
        if (i % 2 == 0) random = rng.bits(i / 2);
        const std::uint64_t half = i % 2 == 0 ? random & 0xffffffff : random >> 32;
        ++times.at(offset + size * (half * groups >> 32), lane);  // one of `groups`, with a bias below groups / 2^32
      }
    }
    for (std::size_t unit = 0; unit < groups * size; ++unit) {
      if (unit % size != 0) std::ranges::copy(times.row(offset + unit - unit % size), times.row(offset + unit).begin());
    }
    for (std::size_t unit = groups * size; unit < strata[stratum]; ++unit)
      std::ranges::fill(times.row(offset + unit), std::uint16_t{1});
    offset += strata[stratum];
  }
}

}  // namespace gust
