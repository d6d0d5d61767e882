#pragma once

#include <string>
#include <string_view>

#include "gust/study/summary/summary.h"

namespace gust {

// A summary as tables that people and other programs can read, and from which a page can be made again without the
// store; floats in their shortest form that reads back. The columns are explained in docs/formats.md.

/// One line a policy, sweep, start, cell and metric, with its interval; margins and counts of broken episodes have
/// lines of their own, without a level.
std::string cells_csv(const Study& study, const Summary& summary);

/// One line a point of a training's learning curve.
std::string curves_csv(const Study& study, const Summary& summary);

/// Reads cells_csv into an empty summary. Automatic sweeps of the study get the levels that stand there. Throws Error
/// with the line where a policy, sweep, start or metric is not the study's.
void read_cells(std::string_view text, std::string_view name, Study& study, Summary& summary);

/// Reads curves_csv into a summary.
void read_curves(std::string_view text, std::string_view name, const Study& study, Summary& summary);

}  // namespace gust
