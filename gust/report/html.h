#pragma once

#include <string>
#include <string_view>

#include "gust/report/page.h"

namespace gust {

/// The text as well-formed UTF-8 that shows what it says: broken bytes, control characters other than tab and newline,
/// and marks that turn the direction of writing become U+FFFD.
std::string clean_text(std::string_view text);

/// The text as HTML, inside an element or a quoted attribute.
std::string escaped(std::string_view text);

/// A number with as many decimals as three digits of scale need: 0.4567 at scale 0.5 is "0.457"; "–" where it is not
/// known, "∞" where it has no end.
std::string decimal(double value, double scale);

/// "[0.44, 0.49]", or nothing where there is no interval or it has no width; an end beyond the grid is "∞".
std::string interval_text(const Page::Estimate& estimate, double scale);

/// A number to three digits, on its own.
std::string short_number(double value);

/// "&nbsp;N" behind a number, " (m, rad)" where there are several units, nothing where there is none. HTML.
std::string unit_html(const std::string& unit);

/// "34 %" of a share.
std::string percent(double share);

/// "1 policy", "3 policies".
std::string counted(std::size_t count, std::string_view one, std::string_view many);

/// The bytes in base64.
std::string base64(std::string_view bytes);

}  // namespace gust
