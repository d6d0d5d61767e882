#pragma once

#include <string>
#include <vector>

#include "gust/paper/paper_results.h"
#include "gust/paper/reproduction_page.h"

namespace gust {

/// The page of what a reproduction found. `command` is the one that ran it.
ReproductionPage reproduction_page(const PaperResults& results, const std::string& command);

/// What the paper prints in a table beside what the study found; empty where the figure is no table.
std::vector<ReproductionPage::TableCell> table_of(const Paper& paper, const PaperFigure& figure, const Study& study,
                                                  const Summary& summary);

/// The scores of one map from one start: rows are the levels of the trainings, columns those of the test. Empty where
/// the study lacks a policy or the sweep.
std::vector<Estimate> map_cells(const PaperMap& map, const Study& study, const Summary& summary, std::size_t metric,
                                std::size_t start);

/// What a reproduction found, in sentences that are made from the numbers.
struct Findings {
  std::vector<std::string> opening;  ///< at most ten, in the order of what matters
  std::vector<std::string> further;
};
Findings findings(const PaperResults& results);
/// The first part of them.
std::vector<std::string> opening_findings(const PaperResults& results);

/// The same results as a text in Markdown: docs/reproduce.md.
std::string reproduction_text(const PaperResults& results, const std::string& command);

}  // namespace gust
