#include "gust/study/trials/trace_choice.h"

#include <algorithm>
#include <cmath>

namespace gust {

void TraceChoice::offer(const EpisodeIndex& index, double score) {
  const Scored scored{std::isnan(score) ? -std::numeric_limits<double>::infinity() : sign_ * score, index};
  const auto less = [](const Scored& a, const Scored& b) { return a.score < b.score; };
  if (rule_.median > 0 && index.episode == 0) firsts_.push_back(scored);
  if (rule_.worst == 0) return;
  const bool full = static_cast<std::int64_t>(worst_.size()) >= rule_.worst;
  if (full && scored.score >= worst_.back().score) return;
  worst_.insert(std::upper_bound(worst_.begin(), worst_.end(), scored, less), scored);
  if (full) worst_.pop_back();
}

std::vector<EpisodeIndex> TraceChoice::chosen() const {
  std::vector<EpisodeIndex> indices;
  for (const Scored& scored : worst_) indices.push_back(scored.index);
  std::vector<Scored> ranked = firsts_;
  std::ranges::stable_sort(ranked, {}, &Scored::score);
  const auto count = std::min<std::int64_t>(rule_.median, static_cast<std::int64_t>(ranked.size()));
  const std::int64_t first = (static_cast<std::int64_t>(ranked.size()) - count) / 2;
  for (std::int64_t i = 0; i < count; ++i) indices.push_back(ranked[static_cast<std::size_t>(first + i)].index);
  return indices;
}

}  // namespace gust
