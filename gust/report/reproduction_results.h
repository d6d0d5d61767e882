#pragma once

#include <string>
#include <vector>

#include "gust/report/reproduction_page.h"
#include "gust/study/paper_results.h"

namespace gust {

/// The page of what a reproduction found. `command` is the one that ran it.
ReproductionPage reproduction_page(const PaperResults& results, const std::string& command);

/// What the paper prints in a table beside what the study found; empty where the figure is no table.
std::vector<ReproductionPage::TableCell> table_of(const Paper& paper, const PaperFigure& figure, const Study& study,
                                                  const Summary& summary);

/// The policy of a map that was trained at a level.
std::string map_policy(const PaperMap& map, double level);

/// The scores of one map from one start: rows are the levels of the trainings, columns those of the test. Empty where
/// the study lacks a policy or the sweep.
std::vector<Estimate> map_cells(const PaperMap& map, const Study& study, const Summary& summary, std::size_t metric,
                                std::size_t start);

/// What stands at the top of page and text: how many claims hold, and what the paper could not see. Sentences, each
/// made from the numbers.
std::vector<std::string> findings(const PaperResults& results);

/// The same results as a text in Markdown: docs/reproduce.md.
std::string reproduction_text(const PaperResults& results, const std::string& command);

}  // namespace gust
