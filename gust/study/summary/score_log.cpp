#include "gust/study/summary/score_log.h"

#include <bit>

#include "gust/core/csv.h"
#include "gust/core/error.h"

namespace gust {

void ScoreLog::note(Curve curve) {
  const std::scoped_lock lock(mutex_);
  std::vector<std::string> key = {curve.study, curve.policy, curve.sweep, curve.start, curve.metric};
  curves_.try_emplace(std::move(key), std::move(curve));
}

std::string ScoreLog::index() const {
  std::string text = csv_line({"study", "policy", "sweep", "start", "metric", "trainings", "units", "cells", "first"});
  std::size_t first = 0;
  for (const auto& [key, curve] : curves_) {
    text += csv_line({curve.study, curve.policy, curve.sweep, curve.start, curve.metric, curve.trainings,
                      cat(curve.units), cat(curve.values.size() / curve.units), cat(first)});
    first += curve.values.size();
  }
  return text;
}

std::string ScoreLog::values() const {
  static_assert(std::endian::native == std::endian::little);
  std::string bytes;
  for (const auto& [key, curve] : curves_)
    bytes.append(reinterpret_cast<const char*>(curve.values.data()), curve.values.size() * sizeof(float));
  return bytes;
}

}  // namespace gust
