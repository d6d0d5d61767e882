#pragma once

#include <span>
#include <vector>

#include "gust/eval/evaluate.h"
#include "gust/store/rows.h"
#include "gust/study/text/study.h"

namespace gust {

/// Writes the rows of each cell as soon as it is complete.
class CellCollector {
 public:
  /// All three must outlive it.
  CellCollector(const Study& study, const Evaluation& evaluation, RowsWriter& rows);

  /// Episodes come in the order of evaluate().
  void take(const EpisodeIndex& index, const Episode& episode);
  /// A metric of the episode that was taken last.
  double last(std::size_t metric) const { return last_[metric]; }

 private:
  const Study& study_;
  std::size_t per_start_;
  std::vector<double> last_;
  std::vector<double> cell_;
  RowsWriter& rows_;
};

}  // namespace gust
