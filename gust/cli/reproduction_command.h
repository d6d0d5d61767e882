#pragma once

#include <filesystem>
#include <string>

#include "gust/study/paper_results.h"

namespace gust {

/// What makes the same results again.
std::string command_text(const Reproduction& reproduction);

/// Writes FOLDER/report.html and FOLDER/reproduce.md and returns the page's path.
std::string write_reproduction(const PaperResults& results, const std::filesystem::path& folder);

}  // namespace gust
