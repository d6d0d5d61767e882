#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace gust {

/// The script that lets a shell (bash, zsh or fish) complete commands, options and names; made from the program itself.
/// Another shell is an Error.
std::string completion_script(const CLI::App& program, const std::string& shell);

}  // namespace gust
