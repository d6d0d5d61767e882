#pragma once

#include "gust/study/trials/trials.h"

namespace gust {

/// What the stored trials of a study say against its policies, one sentence for each policy at most: it gave NaN or an
/// infinite action (step and state), or, if its file is foreign, it fails undisturbed within a second.
std::vector<std::string> policy_notes(const Study& study, const Plan& plan, const Store& store);

inline constexpr double kAtOnce = 1.0;  ///< s within which a policy that fails has failed at once

/// "it fails within a second in 20 of 25 undisturbed episodes; " if most do, else an empty text.
std::string failure_hint_text(std::size_t early, std::size_t episodes);

}  // namespace gust
