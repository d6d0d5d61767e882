#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "gust/study/text/study.h"

namespace gust {

/// Where the files of a paper come from: the program itself, a folder, or the copy that results keep.
struct PaperSource {
  std::string folder;                                                       ///< as errors name it
  std::function<std::optional<std::string>(const std::string& name)> read;  ///< nothing where there is no such file
  FindFiles find;  ///< the files that a study's patterns name, relative to the folder and within it

  /// How errors name a file.
  std::string place(const std::string& name) const;
};

/// studies/paper, compiled into the program.
PaperSource embedded_source();

/// The files of a folder. Files that a study names must lie within it, so that a copy of the folder is the whole paper.
PaperSource folder_source(const std::filesystem::path& folder);

}  // namespace gust
