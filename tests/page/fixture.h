#pragma once

#include <string>

#include "gust/paper/reproduction_page.h"
#include "gust/report/page.h"

namespace gust {

/// Invented pages for the tests of the page. Their curves come from formulas, their episodes from a small simulation
/// with a fixed feedback; nothing in them was measured, and each says so in its question.
Page demo_page();

/// The demo page with every text hostile: tags, script ends, quotes, template braces, marks that turn writing around.
Page hostile_page();

/// 100,000 cells (policy × sweep × level × start), each with twelve metrics and their intervals.
Page large_page();

/// The demo page with its first policy alone.
Page single_page();

/// A paper's reproduction with 4 figures, 12 claims and 3 readings, just as invented.
ReproductionPage reproduction_page();

/// 19 figures of 46 policies each, 72 claims, 12 readings.
ReproductionPage large_reproduction();

}  // namespace gust
