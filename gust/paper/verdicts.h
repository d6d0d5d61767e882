#pragma once

#include <string>

#include "gust/paper/reproduction_page.h"

namespace gust {

/// What the number beside a verdict is.
inline constexpr std::string_view kMeasuredMeaning =
    "The number beside a verdict says by how much the part of the claim that decides is true: positive where it is, "
    "negative where it is not, in that part's unit, with its 95 % interval. It is infinite where a part is true "
    "because "
    "intervals overlap, or a score does not fall as far as is asked up to the end of the grid.";

/// Pieces of a reproduction's page as HTML. A verdict has a colour and a mark, so that it can be read without colour.

/// The shapes of the marks; a page needs them once.
std::string mark_shapes();

/// "7 of 8, 2 not comparable"; empty where nothing could be asked.
std::string parts_text(const ReproductionPage::Verdict& verdict);

/// Whether the claim would come out either way if every policy had been trained once: true in 10 to 90 % of draws.
bool hangs_on_draw(double one_training);

/// Claims that do not hold, by the first of these reasons that the data give for it. Every such claim has one.
struct ClaimsOfReason {
  std::string why;  ///< a sentence
  std::vector<const ReproductionPage::Claim*> claims;
};
std::vector<ClaimsOfReason> claims_by_reason(const ReproductionPage& page);

/// The same as a list; empty if there are none.
std::string claims_by_reason_html(const ReproductionPage& page);

/// All verdicts of the main reading: a cell a claim that leads to it, and how many there are of each.
std::string verdict_picture(const ReproductionPage& page);

/// What became of the claims that a reading bears on.
struct Specification {
  std::size_t reading = 0;
  std::size_t claims = 0;
  std::size_t parts = 0, true_parts = 0;
  std::size_t shown = 0, refuted = 0;  ///< refuted: in part, too

  double share() const { return static_cast<double>(true_parts) / static_cast<double>(parts); }
};

/// Of each reading that was asked anything, those with the greatest share of true parts first: a specification curve
/// (Simonsohn, Simmons and Nelson 2020).
std::vector<Specification> specifications(const ReproductionPage& page);

/// The same as a table with bars; empty if there are none.
std::string specification_curve(const ReproductionPage& page);

/// Verdicts by reading and claim, what the readings are, and which claims change with them; empty where there is but
/// one reading.
std::string reading_table(const ReproductionPage& page);

/// One claim with all that was found about it, as an item of a list.
std::string claim_html(const ReproductionPage& page, const ReproductionPage::Claim& claim);

/// Whether a claim holds in our numbers under one reading and fails under another.
bool hangs_on_reading(const ReproductionPage::Claim& claim);

}  // namespace gust
