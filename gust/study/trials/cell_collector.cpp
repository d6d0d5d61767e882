#include "gust/study/trials/cell_collector.h"

#include "gust/study/trials/trials.h"

namespace gust {

CellCollector::CellCollector(const Study& study, const Evaluation& evaluation, RowsWriter& rows)
    : study_(study),
      per_start_(static_cast<std::size_t>(evaluation.episodes) * study.metric_set.stored().size()),
      last_(study.metric_set.size()),
      cell_(evaluation.starts.size() * per_start_),
      rows_(rows) {}

void CellCollector::take(const EpisodeIndex& index, const Episode& episode) {
  measure(study_, episode, last_);
  const std::vector<std::size_t>& stored = study_.metric_set.stored();
  std::size_t at = index.start * per_start_ + static_cast<std::size_t>(index.episode) * stored.size();
  for (const std::size_t metric : stored) cell_[at++] = last_[metric];
  if (at == cell_.size()) rows_.append_cell(cell_);
}

}  // namespace gust
