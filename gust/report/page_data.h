#pragma once

#include <string>
#include <vector>

#include "gust/report/page.h"

namespace gust {

/// What the page's scripts draw from.
struct PageData {
  std::string json;                   // safe inside a script element
  std::vector<std::string> left_out;  // sentences: what did not fit in page.data_limit
};

PageData page_data(const Page& page);

}  // namespace gust
