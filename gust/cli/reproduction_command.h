#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "gust/paper/paper_results.h"

namespace gust {

/// --only, --seeds and --profile, which stay in force as long as `choice` lives.
void add_choice(CLI::App& command, ReproductionChoice& choice);

/// The reproduction that was asked for; what --only names twice counts once.
Reproduction chosen_reproduction(const std::string& paper, ReproductionChoice choice);

/// Where a reproduction leaves its results unless it is told: ./paper.gust, or ./paper-quick.gust for a profile
/// "quick".
std::string standard_folder(const Paper& paper, const ReproductionChoice& choice);

/// What makes the same results again.
std::string command_text(const Reproduction& reproduction);

/// Writes FOLDER/report.html and FOLDER/reproduce.md and returns the page's path.
std::string write_reproduction(const PaperResults& results, const std::filesystem::path& folder);

}  // namespace gust
