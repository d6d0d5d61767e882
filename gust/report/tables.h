#pragma once

#include <string>

#include "gust/report/page.h"

namespace gust {

/// The page's tables as HTML. Each is empty where there is nothing to show.

/// Sweep by policy, one table a start; the interval is drawn in each cell on the sweep's own scale.
std::string margins_table(const Page& page);

/// Each pair of policies, sweep by sweep; the first pair is open.
std::string comparisons_html(const Page& page);

/// The smallest margins of each site, one table a start, with a way to an episode that was kept.
std::string smallest_margins(const Page& page);

std::string claims_list(const Page& page);

/// Versions, seeds, machine, commands and the study's text.
std::string provenance_html(const Page& page);

}  // namespace gust
