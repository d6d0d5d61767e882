#pragma once

#include <vector>

#include "gust/study/text/study.h"

namespace gust {

/// Chooses which episodes of a sweep to keep, from their scores as they come: the worst of all, and those in the
/// middle among the first episodes of each cell and start. Ties go to the earlier episode.
class TraceChoice {
 public:
  TraceChoice(const TraceRule& rule, bool higher_is_better) : rule_(rule), sign_(higher_is_better ? 1.0 : -1.0) {}

  void offer(const EpisodeIndex& index, double score);
  /// Worst first, then the middle ones.
  std::vector<EpisodeIndex> chosen() const;

 private:
  struct Scored {
    double score;  // the lower the worse
    EpisodeIndex index;
  };

  TraceRule rule_;
  double sign_;
  std::vector<Scored> worst_;   // ascending, at most rule_.worst
  std::vector<Scored> firsts_;  // one a cell and start
};

}  // namespace gust
