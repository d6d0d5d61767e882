#pragma once

#include "gust/report/page.h"
#include "gust/study/summary/comparison.h"

namespace gust {

/// What the page says about its making; the command that makes the page knows it.
struct PageContext {
  std::string run_command;     ///< makes the results again
  std::string folder;          ///< where they lie
  std::string export_command;  ///< gives all numbers
  std::vector<std::pair<std::string, std::string>> provenance;
  std::vector<std::string> warnings;  ///< trials that failed, with reasons
  std::vector<SweepComparison> comparisons = {};
  std::string start = {};  ///< the name of the one that leads; empty: starts_to_tell()
};

/// The page of a study from its summary.
Page study_page(const Study& study, const Summary& summary, const PageContext& context);

}  // namespace gust
