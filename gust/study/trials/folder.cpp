#include "gust/study/trials/folder.h"

#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>

#include "gust/core/hash.h"
#include "gust/core/text.h"
#include "gust/store/files.h"
#include "gust/study/text/policy_files.h"
#include "gust/study/trials/store_check.h"

namespace gust {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kStudyFile = "study.toml";
constexpr const char* kInputsFile = "inputs.json";
constexpr const char* kInputsFolder = "inputs";
constexpr int kDeepest = 8;                                  // of inputs.json
constexpr std::size_t kStudyBytes = std::size_t{1} << 20;    // what parse_study takes
constexpr std::size_t kInputsBytes = std::size_t{16} << 20;  // thousands of files
constexpr std::size_t kRowsBytes = std::size_t{4} << 30;     // of an imported table
constexpr std::size_t kFoundBytes = std::size_t{1} << 30;    // of all policy files together

struct KeptFile {
  std::string path;                              ///< as the study's pattern found it
  std::string hash;                              ///< and name of the copy
  std::map<std::string, std::string> data = {};  ///< of an ONNX file: its data files by name, and their hashes
};

struct KeptInputs {
  RunInputs run;
  std::vector<std::vector<KeptFile>> patterns;  ///< in the order in which the parser asks
  std::string text_hash = {};                   ///< of the study's text; empty in folders of earlier versions
  std::string readings = {};                    ///< plant and readings as the run understood them
  std::string rows_hash = {};                   ///< of the imported table
};

/// What a study says of the plant and its readings, with all defaults.
std::string readings_text(const Study& study) {
  return cat(study.setup.plant.canonical(), "; ", canonical_fields(study.setup.readings));
}

/// The same object with the hash of its content.
Json hashed(Json json) {
  json.erase("hash");
  const std::string hash = hash_hex(json.dump(-1, ' ', false, Json::error_handler_t::replace));
  json["hash"] = hash;
  return json;
}

Error changed(const fs::path& file) {
  return Error(cat(file.string(),
                   ": is not what the run wrote: it was edited, or a run was cut off; 'gust run STUDY --out ",
                   shell_word(file.parent_path().string()), "' writes it again"));
}

KeptInputs read_inputs(const fs::path& folder) {
  const fs::path path = folder / kInputsFile;
  const std::string bytes = read_file(path, kInputsBytes);
  try {
    // What is nested deeper than ours is dropped, for writing JSON out again recurses; then the hash differs.
    const Json json = Json::parse(bytes, [](int depth, Json::parse_event_t, const Json&) { return depth <= kDeepest; });
    KeptInputs inputs{{json.value("study", kStudyFile), json.at("settings")}, {}};
    if (json.contains("hash") && json != hashed(json)) throw changed(path);
    inputs.text_hash = json.contains("hash") ? json.at("text") : Json("");
    inputs.readings = json.value("readings", "");
    if (json.contains("rows")) {
      inputs.run.rows = json.at("rows").at("path");
      inputs.rows_hash = json.at("rows").at("hash");
    }
    for (const Json& found : json.at("files")) {
      std::vector<KeptFile>& files = inputs.patterns.emplace_back();
      for (const Json& file : found) {
        files.push_back({file.at("path"), file.at("hash")});
        if (file.contains("data")) files.back().data = file.at("data");
      }
    }
    return inputs;
  } catch (const Json::exception&) {
    throw Error(cat(path.string(), ": damaged; run the study again"));
  }
}

/// The copy of what a study used, if it is still what it was.
std::string read_copy(const fs::path& folder, const std::string& hash) {
  const fs::path path = folder / kInputsFolder / hash;
  std::string bytes = read_file(path, kOnnxDataBytes);
  if (hash_hex(bytes) != hash) throw Error(cat(path.string(), ": damaged; run the study again"));
  return bytes;
}

StudyFile read_kept(const fs::path& folder, const KeptFile& kept) {
  StudyFile file{kept.path, read_copy(folder, kept.hash)};
  for (const auto& [name, hash] : kept.data) file.data[name] = read_copy(folder, hash);
  return file;
}

/// Keeps a copy under the name of its hash, which it gives back.
std::string keep_copy(const fs::path& folder, const std::string& bytes) {
  const std::string hash = hash_hex(bytes);
  write_file_atomically(folder / kInputsFolder / hash, bytes);
  return hash;
}

Json keep_file(const fs::path& folder, const StudyFile& file) {
  Json entry = {{"path", file.path}, {"hash", keep_copy(folder, file.bytes)}};
  for (const auto& [name, bytes] : file.data) entry["data"][name] = keep_copy(folder, bytes);
  return entry;
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

FindFiles files_beside(const fs::path& base) {
  return [base](const std::string& pattern, const Place& place) {
    std::vector<StudyFile> files;
    std::size_t left = kFoundBytes;
    try {
      for (const fs::path& path : glob_files(base, pattern)) {
        std::string bytes = read_policy_file(path);
        OnnxData data = read_onnx_data(path, bytes);
        std::size_t size = bytes.size();
        for (const auto& [name, content] : data) size += content.size();
        if (size > left) throw Error(cat("'", pattern, "': its files have more than ", kFoundBytes, " bytes together"));
        left -= size;
        files.push_back(
            {path.lexically_relative(base.empty() ? "." : base).string(), std::move(bytes), std::move(data)});
      }
    } catch (const Error& error) {
      throw error_at(place, error.what());
    }
    return files;
  };
}

Study StudyFolder::read(const fs::path& file, const std::vector<std::string>& settings) {
  return parse_study(read_file(file, kStudyBytes), file.string(), settings, files_beside(file.parent_path()));
}

void StudyFolder::keep(const Study& study, const RunInputs& inputs, std::string_view rows) const {
  if (Store::is_at(path_ / "store"))
    throw Error(cat(path_.string(), ": holds trials that 'gust run' made; choose another --out"));
  check_place();
  write_file_atomically(this->rows(), rows);
  write_study(study, inputs, hash_hex(rows));
}

std::string StudyFolder::read_rows() const {
  std::string bytes = read_file(rows(), kRowsBytes);
  if (hash_hex(bytes) != read_inputs(path_).rows_hash)
    throw Error(cat(rows().string(), ": is not what was imported; 'gust import' takes a table anew"));
  return bytes;
}

void StudyFolder::keep(const Study& study, const RunInputs& inputs) const {
  check_place();
  if (is_there(rows())) throw Error(cat(path_.string(), ": holds rows that 'gust import' took; choose another --out"));
  write_study(study, inputs, "");
}

void StudyFolder::check_place() const {
  std::error_code unknown;
  if (is_there(path_) && !fs::is_directory(path_, unknown))
    throw Error(cat(path_.string(), ": is not a folder; choose another --out"));
  if (!is_ours(path_)) throw Error(cat(path_.string(), ": is not empty and no result of gust; choose another --out"));
  if (holds_reproduction(path_))
    throw Error(cat(path_.string(), ": holds what 'gust reproduce' found; choose another --out"));
  if (const auto store = store_around(path_))
    throw Error(cat(path_.string(), ": lies in the store ", store->string(), "; choose another --out"));
}

void StudyFolder::write_study(const Study& study, const RunInputs& inputs, const std::string& rows_hash) const {
  Json patterns = Json::array();
  for (const std::vector<StudyFile>& files : study.found) {
    Json found = Json::array();
    for (const StudyFile& file : files) found.push_back(keep_file(path_, file));
    patterns.push_back(found);
  }
  Json json = {{"study", inputs.study},
               {"settings", inputs.settings},
               {"files", patterns},
               {"text", hash_hex(study.text)},
               {"readings", readings_text(study)}};
  if (!rows_hash.empty()) json["rows"] = {{"path", inputs.rows}, {"hash", rows_hash}};
  write_file_atomically(path_ / kInputsFile, hashed(json).dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  write_file_atomically(path_ / kStudyFile, study.text);
}

Study StudyFolder::open(const Store::Notice& notice) const {
  const fs::path text = path_ / kStudyFile;
  const bool whole = is_there(text) && is_there(path_ / kInputsFile);
  if (!whole && holds_reproduction(path_))
    throw Error(cat(path_.string(), ": holds what 'gust reproduce' found, and no single study; 'gust report ",
                    shell_word(path_.string()), "' writes its page, its tables are the files READING/STUDY.csv"));
  if (!whole)
    throw Error(
        cat(path_.string(),
            ": holds no study; give the folder that 'gust run' or 'gust reproduce' left, or 'gust plan --prepare'"));
  const KeptInputs inputs = read_inputs(path_);
  std::size_t asked = 0;
  const FindFiles find = [&](const std::string&, const Place&) {
    std::vector<StudyFile> files;
    if (asked == inputs.patterns.size()) return files;
    for (const KeptFile& file : inputs.patterns[asked++]) files.push_back(read_kept(path_, file));
    return files;
  };
  const std::string bytes = read_file(text, kStudyBytes);
  if (!inputs.text_hash.empty() && hash_hex(bytes) != inputs.text_hash) throw changed(text);
  if (inputs.text_hash.empty() && notice)
    notice(
        cat(path_.string(), ": an earlier gust left it without hashes; whether its study was edited cannot be told"));
  Study study = parse_study(bytes, text.string(), inputs.run.settings, find);
  if (!inputs.readings.empty() && inputs.readings != readings_text(study) && notice)
    notice(cat((path_ / kInputsFile).string(), ": the study was run with ", inputs.readings, "; this gust reads it as ",
               readings_text(study)));
  return study;
}

RunInputs StudyFolder::inputs() const { return read_inputs(path_).run; }

}  // namespace gust
