#include "gust/study/folder.h"

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "gust/core/hash.h"
#include "gust/study/files.h"

namespace gust {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kStudyFile = "study.toml";
constexpr const char* kInputsFile = "inputs.json";
constexpr const char* kInputsFolder = "inputs";

struct KeptFile {
  std::string path;  ///< as the study's pattern found it
  std::string hash;  ///< and name of the copy
};

struct KeptInputs {
  RunInputs run;
  std::vector<std::vector<KeptFile>> patterns;  ///< in the order in which the parser asks
};

KeptInputs read_inputs(const fs::path& folder) {
  const fs::path path = folder / kInputsFile;
  const std::string bytes = read_file(path);
  try {
    const Json json = Json::parse(bytes);
    KeptInputs inputs{{json.value("study", kStudyFile), json.at("settings")}, {}};
    for (const Json& found : json.at("files")) {
      std::vector<KeptFile>& files = inputs.patterns.emplace_back();
      for (const Json& file : found) files.push_back({file.at("path"), file.at("hash")});
    }
    return inputs;
  } catch (const Json::exception&) {
    throw Error(cat(path.string(), ": damaged; run the study again"));
  }
}

/// The copy of a file that a study used, if it is still what it was.
std::string read_kept(const fs::path& folder, const KeptFile& file) {
  const fs::path path = folder / kInputsFolder / file.hash;
  std::string bytes = read_file(path);
  if (hash_hex(bytes) != file.hash) throw Error(cat(path.string(), ": damaged; run the study again"));
  return bytes;
}

bool is_there(const fs::path& path) {
  std::error_code unknown;
  return fs::exists(path, unknown);
}

bool holds_reproduction(const fs::path& folder) { return is_there(folder / "reproduction.json"); }

/// Whether a folder is a result of ours, empty or not there; another run may just be making it, or have been killed
/// while it did.
bool is_ours(const fs::path& folder) {
  bool foreign = false;
  std::error_code error;
  for (fs::directory_iterator at(folder, error); !error && at != fs::directory_iterator(); at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (name == kStudyFile || name == kInputsFile || name == kInputsFolder || name == "store") return true;
    foreign = foreign || !name.starts_with('.');
  }
  return !foreign;
}

}  // namespace

std::string standard_folder(const Study& study) { return study.name + ".gust"; }

fs::path StudyFolder::store() const {
  const char* cache = std::getenv("GUST_CACHE");
  return cache != nullptr && *cache != '\0' ? fs::path(cache) : path_ / "store";
}

Study StudyFolder::read(const fs::path& file, const std::vector<std::string>& settings) {
  const fs::path base = file.parent_path();
  const FindFiles find = [&](const std::string& pattern, const Place& place) {
    std::vector<StudyPolicy::File> files;
    try {
      for (const fs::path& path : glob_files(base, pattern))
        files.push_back({path.lexically_relative(base.empty() ? "." : base).string(), read_file(path)});
    } catch (const Error& error) {
      throw error_at(place, error.what());
    }
    return files;
  };
  return parse_study(read_file(file), file.string(), settings, find);
}

void StudyFolder::keep(const Study& study, const RunInputs& inputs) const {
  const fs::path text = path_ / kStudyFile;
  std::error_code unknown;
  if (is_there(path_) && !fs::is_directory(path_, unknown))
    throw Error(cat(path_.string(), ": is not a folder; choose another --out"));
  if (!is_ours(path_)) throw Error(cat(path_.string(), ": is not empty and no result of gust; choose another --out"));
  if (holds_reproduction(path_))
    throw Error(cat(path_.string(), ": holds what 'gust reproduce' found; choose another --out"));
  Json patterns = Json::array();
  for (const std::vector<StudyPolicy::File>& files : study.found) {
    Json found = Json::array();
    for (const StudyPolicy::File& file : files) {
      const std::string hash = hash_hex(file.bytes);
      write_file_atomically(path_ / kInputsFolder / hash, file.bytes);
      found.push_back({{"path", file.path}, {"hash", hash}});
    }
    patterns.push_back(found);
  }
  write_file_atomically(path_ / kInputsFile,
                        Json{{"study", inputs.study}, {"settings", inputs.settings}, {"files", patterns}}.dump(
                            2, ' ', false, Json::error_handler_t::replace) +
                            "\n");
  write_file_atomically(text, study.text);
}

Study StudyFolder::open() const {
  const fs::path text = path_ / kStudyFile;
  const bool whole = is_there(text) && is_there(path_ / kInputsFile);
  if (!whole && holds_reproduction(path_))
    throw Error(cat(path_.string(), ": holds what 'gust reproduce' found, and no single study; 'gust report ",
                    shell_word(path_.string()), "' writes its page, its tables are the files READING/STUDY.csv"));
  if (!whole)
    throw Error(cat(path_.string(), ": holds no study; give the folder that 'gust run' or 'gust reproduce' left"));
  const KeptInputs inputs = read_inputs(path_);
  std::size_t asked = 0;
  const FindFiles find = [&](const std::string&, const Place&) {
    std::vector<StudyPolicy::File> files;
    if (asked == inputs.patterns.size()) return files;
    for (const KeptFile& file : inputs.patterns[asked++]) files.push_back({file.path, read_kept(path_, file)});
    return files;
  };
  return parse_study(read_file(text), text.string(), inputs.run.settings, find);
}

RunInputs StudyFolder::inputs() const { return read_inputs(path_).run; }

}  // namespace gust
