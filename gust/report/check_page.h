#pragma once

#include "gust/report/page.h"

namespace gust {

/// Throws Bug where an index points outside its list or two lengths contradict each other.
void check_page(const Page& page);

}  // namespace gust
