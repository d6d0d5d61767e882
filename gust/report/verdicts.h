#pragma once

#include <string>

#include "gust/report/reproduction_page.h"

namespace gust {

/// Pieces of a reproduction's page as HTML. A verdict has a colour and a mark, so that it can be read without colour.

/// The shapes of the marks; a page needs them once.
std::string mark_shapes();

/// All verdicts of the main reading: a cell a claim that leads to it, and how many there are of each.
std::string verdict_picture(const ReproductionPage& page);

/// Verdicts by reading and claim, what the readings are, and which claims change with them; empty where there is but
/// one reading.
std::string reading_table(const ReproductionPage& page);

/// One claim with all that was found about it, as an item of a list.
std::string claim_html(const ReproductionPage& page, const ReproductionPage::Claim& claim);

/// Whether a claim holds in our numbers under one reading and fails under another.
bool hangs_on_reading(const ReproductionPage::Claim& claim);

}  // namespace gust
