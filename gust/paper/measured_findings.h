#pragma once

#include <string>
#include <vector>

#include "gust/paper/paper_results.h"

namespace gust {

/// What a reproduction's measurements say beyond the verdicts: early failures, saturation, the linear regulator,
/// budgets. A sentence each, empty where the data say nothing of it.
std::vector<std::string> measured_findings(const PaperResults& results);

/// Whether it helps to train with the noise of the test, from the first start that is not random and from random ones;
/// empty where no figure has maps of it, or the paper no words for it.
std::string training_noise_sentence(const PaperResults& results);

}  // namespace gust
