#include "gust/report/check_page.h"

#include "gust/core/error.h"

namespace gust {
namespace {

void check_band(const Page::Band& band, std::size_t length) {
  GUST_CHECK(band.value.size() == length);
  GUST_CHECK(band.low.empty() || band.low.size() == length);
  GUST_CHECK(band.high.size() == band.low.size());
}

void check_cell(const Page& page, std::size_t sweep, std::size_t policy, std::size_t start) {
  GUST_CHECK(sweep < page.sweeps.size());
  GUST_CHECK(policy < page.policies.size());
  GUST_CHECK(start < page.starts.size());
}

void check_grid(const Page& page, const Page::Grid& grid) {
  for (const auto& layer : grid.layers) {
    GUST_CHECK(layer.policy < page.policies.size() && layer.start < page.starts.size());
    GUST_CHECK(layer.metric < page.metrics.size());
    GUST_CHECK(layer.values.size() == grid.columns.values.size() * grid.rows.values.size());
  }
}

void check_traces(const std::vector<Page::Trace>& traces, std::size_t length) {
  for (const auto& trace : traces) GUST_CHECK(trace.values.size() == length);
}

void check_episode(const Page& page, const Page::Episode& episode) {
  GUST_CHECK(episode.policy < page.policies.size() && episode.start < page.starts.size());
  GUST_CHECK(episode.sweep == Page::kNone || episode.sweep < page.sweeps.size());
  GUST_CHECK(episode.rate > 0);
  const std::size_t steps = episode.reward.size();
  check_traces(episode.states, steps + 1);
  check_traces(episode.reference, steps + 1);
  check_traces(episode.commanded, steps);
  check_traces(episode.memory, steps);
  check_traces(episode.applied, steps);
  for (const auto& push : episode.disturbances) GUST_CHECK(push.trace.values.size() == steps);
  GUST_CHECK(episode.failed_step == Page::kNone || episode.failed_step <= steps);
}

}  // namespace

void check_page(const Page& page) {
  for (const std::size_t metric : {page.survival_metric, page.saturation_metric}) {
    GUST_CHECK(metric == Page::kNone || metric < page.metrics.size());
  }
  GUST_CHECK(page.margins.empty() || page.margin_metric < page.metrics.size());
  for (const auto& curve : page.curves) {
    check_cell(page, curve.sweep, curve.policy, curve.start);
    GUST_CHECK(curve.metric < page.metrics.size());
    check_band(curve.band, curve.levels.empty() ? page.sweeps[curve.sweep].levels.size() : curve.levels.size());
  }
  for (const auto& margin : page.margins) {
    check_cell(page, margin.sweep, margin.policy, margin.start);
    GUST_CHECK(margin.episode == Page::kNone || margin.episode < page.episodes.size());
  }
  for (const auto& comparison : page.comparisons) {
    GUST_CHECK(comparison.a < page.policies.size() && comparison.b < page.policies.size());
    GUST_CHECK(comparison.start < page.starts.size());
    GUST_CHECK(comparison.sweep == Page::kNone || comparison.sweep < page.sweeps.size());
  }
  for (const auto& grid : page.grids) check_grid(page, grid);
  for (const auto& learning : page.learning) {
    GUST_CHECK(learning.policy < page.policies.size());
    GUST_CHECK(learning.score < page.learning_scores.size());
    check_band(learning.mean, learning.steps.size());
    for (const auto& run : learning.runs) GUST_CHECK(run.steps.size() == run.score.size());
  }
  for (const auto& episode : page.episodes) check_episode(page, episode);
}

}  // namespace gust
