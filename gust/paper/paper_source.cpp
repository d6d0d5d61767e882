#include "gust/paper/paper_source.h"

#include "gust/core/value.h"
#include "gust/paper/paper_files.h"
#include "gust/store/files.h"
#include "gust/study/trials/folder.h"

namespace gust {
namespace {

namespace fs = std::filesystem;

}  // namespace

std::string PaperSource::place(const std::string& name) const { return (fs::path(folder) / name).string(); }

PaperSource embedded_source() {
  return {.folder = "studies/paper",
          .read = [](const std::string& name) { return std::string(paper_file(name)); },
          .find = [](const std::string&, const Place&) { return std::vector<StudyFile>(); }};
}

PaperSource folder_source(const fs::path& folder) {
  const auto read = [folder](const std::string& name) -> std::optional<std::string> {
    std::error_code unknown;
    if (!fs::exists(folder / name, unknown)) return std::nullopt;
    return read_file(folder / name);
  };
  const auto find = [within = files_beside(folder)](const std::string& pattern, const Place& place) {
    std::vector<StudyFile> files = within(pattern, place);
    for (const StudyFile& file : files) {
      const fs::path path = fs::path(file.path).lexically_normal();
      if (path.is_absolute() || *path.begin() == "..")
        throw error_at(place, "'", file.path, "' lies outside the paper's folder; copy it there");
    }
    return files;
  };
  return {.folder = folder.string(), .read = read, .find = find};
}

}  // namespace gust
