#pragma once

#include <string>
#include <vector>

#include "gust/study/paper_results.h"

namespace gust {

/// What a reproduction's measurements say beyond the verdicts: training with noise, early failures, saturation, the
/// linear regulator, budgets. A sentence each, empty where the data say nothing of it.
std::vector<std::string> measured_findings(const PaperResults& results);

}  // namespace gust
