#pragma once

#include "gust/study/summary/measurements.h"

namespace gust {

/// Rows of a table that anybody may write, as what was measured in a study: a line a metric of an episode, with the
/// columns of `gust export` (docs/formats.md). Needed are `policy`, `metric` and `value`; `sweep`, `level`, `level_2`,
/// `seed`, `start` and `episode` where the study has more than one; others must say what the study says.
///
/// A sweep's automatic levels are those at which all policies were measured; other levels of a disturbance refine its
/// margins. Throws Error with the line where a row is not the study's, comes twice or lacks others of its kind.
std::unique_ptr<Measurements> read_row_table(std::string_view text, std::string_view name, Study& study);

}  // namespace gust
