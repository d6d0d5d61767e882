#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "gust/paper/paper_results.h"

namespace gust {

/// --only, --seeds and --profile, which stay in force as long as `choice` lives.
void add_choice(CLI::App& command, ReproductionChoice& choice);

/// The reproduction that was asked for; what --only names twice counts once. It keeps a pointer to the paper.
Reproduction chosen_reproduction(const Paper& paper, ReproductionChoice choice);

/// Where a reproduction leaves its results unless it is told: ./paper.gust, or ./paper-quick.gust for a profile
/// "quick" that is not the paper's first.
std::string standard_folder(const Reproduction& reproduction);

/// What makes the same results again, of a paper by name or folder.
std::string command_text(const std::string& paper, const ReproductionChoice& choice);

/// Writes FOLDER/report.html and FOLDER/reproduce.md and returns the page's path.
std::string write_reproduction(const PaperResults& results, const std::filesystem::path& folder);

}  // namespace gust
