#pragma once

#include <string>

#include "gust/paper/reproduction_page.h"

namespace gust {

/// What the paper prints beside ours, with the differences; empty where the figure has no table.
std::string printed_table(const ReproductionPage::Figure& figure);

/// Whether our interval leaves out what the paper prints.
bool stands_apart(const ReproductionPage::TableCell& cell);

/// The median of our single trainings, the least and the greatest; all unknown where there are none.
Page::Estimate training_range(const ReproductionPage::TableCell& cell);

/// Whether what the paper prints lies between our least and greatest single training.
bool among_trainings(const ReproductionPage::TableCell& cell);

}  // namespace gust
