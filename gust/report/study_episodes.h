#pragma once

#include "gust/report/page.h"
#include "gust/study/summary/summary.h"

namespace gust {

/// Episodes that were kept whole, as the page replays them. `sweep_at` gives each sweep's place on the page.
std::vector<Page::Episode> kept_episodes(const Study& study, const std::vector<KeptTraces>& kept,
                                         const std::vector<std::size_t>& sweep_at);

}  // namespace gust
