#pragma once

#include <string>
#include <vector>

#include "gust/study/study.h"

namespace gust {

/// The values of a parameter with which the plant can be held at its goal, given how far the readings let a command go.
Limits possible_values(const Setup& setup, std::size_t parameter);

/// What a study may well ask for, but its author should know: one sentence each.
std::vector<std::string> study_warnings(const Study& study);

}  // namespace gust
