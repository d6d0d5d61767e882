#include "gust/study/cell_collector.h"

#include "gust/study/trials.h"

namespace gust {

CellCollector::CellCollector(const Study& study, const Evaluation& evaluation, RowsWriter& rows)
    : study_(study),
      per_start_(static_cast<std::size_t>(evaluation.episodes) * study.metric_set.size()),
      cell_(evaluation.starts.size() * per_start_),
      rows_(rows) {}

void CellCollector::take(const EpisodeIndex& index, const Episode& episode) {
  const std::size_t count = study_.metric_set.size();
  last_ = index.start * per_start_ + static_cast<std::size_t>(index.episode) * count;
  measure(study_, episode, std::span(cell_).subspan(last_, count));
  if (last_ + count == cell_.size()) rows_.append_cell(cell_);
}

}  // namespace gust
