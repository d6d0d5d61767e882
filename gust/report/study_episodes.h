#pragma once

#include "gust/report/page.h"
#include "gust/study/plan.h"
#include "gust/study/store.h"

namespace gust {

/// The episodes that the trials of a plan kept whole, as the page replays them. `sweep_at` gives each sweep's place on
/// the page. A bounded number is taken, spread over the sweeps.
std::vector<Page::Episode> kept_episodes(const Study& study, const Plan& plan, const Store& store,
                                         const std::vector<std::size_t>& sweep_at);

}  // namespace gust
