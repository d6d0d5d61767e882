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

/// How a page's data go beside those of others.
struct DataShare {
  std::size_t limit = 0;            ///< bytes, in place of the page's own
  std::vector<std::size_t> places;  ///< of each policy in the order of colours, dashes and markers
};

PageData page_data(const Page& page, const DataShare& share);

}  // namespace gust
