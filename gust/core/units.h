#pragma once

#include <string>

#include "gust/core/value.h"

namespace gust {

/// How many of `unit` make one of the SI unit `si`: 100 for "cm" and "m", 180/pi for "deg" and "rad". An Error at the
/// place, with the units that there are, if `unit` is none of that dimension. `what` is measured in it.
double units_in(const std::string& unit, const std::string& si, const std::string& what, const Place& place);

}  // namespace gust
