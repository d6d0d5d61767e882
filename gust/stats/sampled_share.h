#pragma once

#include "gust/core/rng.h"
#include "gust/stats/sampled.h"

namespace gust {

/// A share of successes with resamples that have the interval of share_interval: Wilson's over its trials, and where
/// `share` was resampled over seeds that of the bootstrap too, whichever end lies further out. Resamples of successes
/// alone have no width where all succeed or none does, and then decide a claim with two episodes (decision 14).
///
/// The order of the resamples stays, so what shares of one policy have in common cancels in a difference and adds up in
/// a mean. Where data give no order, half of the resamples are ordered as `together` says, which is the same for all
/// shares of a policy, and half as `alone` says, which is another one for each: so neither a difference nor a mean of
/// shares at the boundary is narrower than it should be.
Sampled sampled_share(Sampled share, std::size_t trials, const Rng& together, const Rng& alone);

}  // namespace gust
