#pragma once

#include <span>
#include <string>
#include <string_view>

#include "gust/report/page.h"

namespace gust {

/// What the page's scripts can draw: "curves", "survival", "learning", "parameters", "grids", "disturbances",
/// "replay".
std::span<const std::string_view> chart_kinds();

/// Whether the page has anything to draw in a chart of this kind.
bool has_chart(const Page& page, std::string_view kind);

/// "How the policies learned"
std::string_view chart_title(std::string_view kind);

/// The place of a chart, with its caption; the scripts fill it.
std::string chart_html(const Page& page, std::string_view kind, std::string_view id = "");

}  // namespace gust
