#include "gust/store/store_manifest.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>

#include "gust/core/error.h"
#include "gust/core/hash.h"
#include "gust/core/text.h"

namespace gust {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostFiles = 1000;
constexpr int kDeepest = 4;  // object, its list of files, a file, its values
constexpr std::size_t kLongestName = 200;

std::string dumped(const Json& json) { return json.dump(1, ' ', false, Json::error_handler_t::replace); }

/// Reads the keys of an object and says which one is wrong.
struct KeyReader {
  const Json& json;
  std::string_view name;

  Error damaged(std::string_view what) const { return Error(cat(name, ": damaged manifest: ", what)); }

  std::string text(const char* key) const {
    const auto found = json.find(key);
    if (found == json.end() || !found->is_string()) throw damaged(cat("'", key, "' is not a text"));
    return found->get<std::string>();
  }

  std::string store_name(const char* key) const {
    std::string text = this->text(key);
    if (!valid_store_name(text)) throw damaged(cat("'", key, "' is not a plain name"));
    return text;
  }
};

StoredFile parse_file(const Json& json, std::string_view name) {
  const KeyReader keys{json, name};
  if (!json.is_object()) throw keys.damaged("a file is not an object");
  StoredFile file = {.name = keys.store_name("name"), .hash = keys.text("hash")};
  const auto size = json.find("size");
  if (size == json.end() || !size->is_number_unsigned()) throw keys.damaged("'size' is not a count of bytes");
  file.size = size->get<std::uint64_t>();
  const bool digits =
      std::ranges::all_of(file.hash, [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
  if (file.hash.size() != 32 || !digits) throw keys.damaged("'hash' is not 32 hexadecimal digits");
  return file;
}

}  // namespace

std::string manifest_bytes(const Manifest& manifest) {
  Json files = Json::array();
  for (const StoredFile& file : manifest.files) {
    files.push_back({{"name", file.name}, {"size", file.size}, {"hash", file.hash}});
  }
  Json json = {{"format", kStoreFormat}, {"kind", manifest.kind}, {"id", manifest.id},
               {"gust", manifest.gust},  {"text", manifest.text}, {"files", std::move(files)}};
  json["hash"] = hash_hex(dumped(json));
  return dumped(json) + "\n";
}

Manifest parse_manifest(std::string_view bytes, std::string_view name) {
  // Writing JSON out again recurses, so what is nested deeper than a manifest is dropped; then the hash differs.
  const auto keep = [](int depth, Json::parse_event_t, Json&) { return depth <= kDeepest; };
  Json json = Json::parse(bytes, keep, /*allow_exceptions=*/false);
  const KeyReader keys{json, name};
  if (!json.is_object()) throw keys.damaged("not a JSON object");
  const std::string hash = keys.text("hash");
  json.erase("hash");
  if (hash_hex(dumped(json)) != hash) throw keys.damaged("its hash differs");
  if (json.value("format", Json()) != Json(kStoreFormat)) throw keys.damaged("it has another format");

  if (!valid_store_kind(keys.text("kind"))) throw keys.damaged("'kind' is not the name of a kind");
  Manifest manifest = {keys.text("kind"), keys.store_name("id"), keys.text("text"), keys.text("gust"), {}};
  const auto files = json.find("files");
  if (files == json.end() || !files->is_array()) throw keys.damaged("'files' is not a list");
  if (files->size() > kMostFiles) throw keys.damaged("too many files");
  std::set<std::string> names = {std::string(kManifestName)};
  for (const Json& file : *files) {
    manifest.files.push_back(parse_file(file, name));
    if (!names.insert(manifest.files.back().name).second) throw keys.damaged("two files have one name");
  }
  return manifest;
}

std::vector<std::string> differing_files(const Manifest& a, const Manifest& b) {
  const bool one_version = a.gust == b.gust;
  std::set<std::string> names;
  for (const auto& [has, lacks] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    for (const StoredFile& file : has->files) {
      if (!one_version && file.name.ends_with(".onnx")) continue;
      if (std::ranges::find(lacks->files, file) == lacks->files.end()) names.insert(file.name);
    }
  }
  return {names.begin(), names.end()};
}

std::string disagreement_text(const Manifest& a, const Manifest& b, std::string_view place_a,
                              std::string_view place_b) {
  return cat("two results for one trial: ", place_a, " (gust ", a.gust, ") and ", place_b, " (gust ", b.gust,
             ") differ in ", join(differing_files(a, b), ", "),
             "; equal text must give equal bits, so one machine or program computes wrongly: run the trial on a third");
}

bool valid_store_name(std::string_view name) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("._-+=").find(c) != std::string_view::npos;
  };
  return !name.empty() && name.size() <= kLongestName && name.front() != '.' && std::ranges::all_of(name, allowed);
}

bool valid_store_kind(std::string_view name) {
  // These lie in a store beside the folders of the kinds.
  constexpr std::array<std::string_view, 4> kTaken = {"aside", "damaged", "checkpoints", "store.json"};
  return valid_store_name(name) && std::ranges::find(kTaken, name) == kTaken.end();
}

}  // namespace gust
