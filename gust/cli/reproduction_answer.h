#pragma once

#include <string>

#include "gust/paper/paper_results.h"

namespace gust {

/// Claims with all their parts, under the reading that decides and the others; for a terminal.
std::string claims_text(const PaperResults& results);

/// A line for each verdict, and what was found in a few sentences; for a terminal.
std::string verdicts_text(const PaperResults& results);

/// Both as one JSON object.
std::string verdicts_json(const PaperResults& results);

}  // namespace gust
