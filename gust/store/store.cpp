#include "gust/store/store.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <nlohmann/json.hpp>
#include <system_error>

#include "gust/core/error.h"
#include "gust/core/text.h"
#include "gust/core/version.h"
#include "gust/store/checkpoint.h"
#include "gust/store/files.h"
#include "gust/store/store_format.h"
#include "gust/store/store_session.h"

namespace gust {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFormatBytes = std::size_t{64} << 10;  // of that file
constexpr std::string_view kDamaged = "damaged";

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

/// The visible entries of a folder by name, sorted.
std::vector<std::string> entries(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator at(folder, error); !error && at != fs::directory_iterator(); at.increment(error)) {
    names.push_back(at->path().filename().string());
  }
  std::erase_if(names, [](const std::string& name) { return name.starts_with('.'); });
  std::ranges::sort(names);
  return names;
}

Error no_store_at(const fs::path& folder) {
  return Error(entries(folder).empty() ? cat(folder.string(), ": no store lies here; gust run makes one")
                                       : cat(folder.string(), ": has no ", kFormatName, "; 'gust store repair ",
                                             shell_word(folder.string()), "' writes one if this is a store"));
}

/// A trial as it lies on the disk, and what is wrong with it, if anything is.
struct CheckedTrial {
  StoredTrial trial;
  std::string damage;
};

/// Reads a manifest and checks every hash. Damage is data here, not a failure: the trial is computed again. Not so
/// where the machine could not read: the trial may be whole.
CheckedTrial check_trial(const fs::path& folder, std::string_view kind, std::string_view id) try {
  const fs::path path = folder / kManifestName;
  const StoredTrial trial = {folder, parse_manifest(read_file(path), path.string())};
  if (trial.manifest.kind != kind || trial.manifest.id != id) throw Error(cat(path.string(), ": is of another trial"));
  for (const StoredFile& said : trial.manifest.files) {
    const fs::path file = folder / said.name;
    std::error_code unknown;
    const std::uintmax_t size = fs::file_size(file, unknown);  // a far too long one is not read
    const StoredFile found = unknown || size == said.size ? describe_file(file) : StoredFile{said.name, size, ""};
    if (found.size != said.size) throw Error(cat(file.string(), ": has ", found.size, " bytes, not ", said.size));
    if (found.hash != said.hash) throw Error(cat(file.string(), ": its hash differs"));
  }
  return {trial, ""};
} catch (const FileError& error) {
  if (error.is_about_file()) return {{}, error.what()};
  throw FileError(cat(error.what(), Store::remedy(folder.parent_path().parent_path())), error.code);
} catch (const Error& error) {
  return {{}, error.what()};
}

}  // namespace

bool StoredTrial::contains(std::string_view file) const {
  return std::ranges::any_of(manifest.files, [&](const StoredFile& stored) { return stored.name == file; });
}

void StoredTrial::check(std::string_view file) const {
  if (!contains(file))
    throw Error(cat(folder.string(), ": has no '", file, "'", Store::remedy(folder.parent_path().parent_path())));
}

std::string StoredTrial::read(std::string_view file) const {
  check(file);
  const auto stored = std::ranges::find(manifest.files, file, &StoredFile::name);
  return read_file(folder / file, static_cast<std::size_t>(stored->size));
}

std::ifstream StoredTrial::open(std::string_view file) const {
  check(file);
  std::ifstream stream(folder / file, std::ios::binary);
  if (!stream) throw file_error(folder / file, "cannot read");
  return stream;
}

Store::Store(fs::path folder, Access access, Notice notice) : folder_(std::move(folder)), notice_(std::move(notice)) {
  if (access == Access::write) initialise();
  if (!is_at(folder_)) throw no_store_at(folder_);
  check_format();
  if (access == Access::read) return;
  session_ = std::make_unique<StoreSession>(folder_ / kAsideName);
  for (const std::string_view file : {kFormatName, kTimingsName}) remove_left_aside(folder_ / file);
  remove_idle_checkpoints(*this);
}

Store::~Store() = default;

bool Store::is_at(const fs::path& folder) { return is_there(folder / kFormatName); }

void Store::initialise() const {
  make_folders(folder_);
  if (is_at(folder_)) return;
  const bool is_empty = entries(folder_).empty();
  if (is_at(folder_)) return;  // another process was faster, and whatever we saw was its
  if (!is_empty) throw Error(cat(folder_.string(), ": holds other things than a store; choose another folder"));
  write_store_format(folder_);
}

void Store::check_format() const {
  const fs::path path = folder_ / kFormatName;
  const auto json = nlohmann::json::parse(read_file(path, kFormatBytes), nullptr, /*allow_exceptions=*/false);
  const bool is_format = json.is_object() && json.contains("format") && json["format"].is_number_integer();
  if (!is_format)
    throw Error(
        cat(path.string(), ": damaged; 'gust store repair ", shell_word(folder_.string()), "' writes it again"));
  const auto format = json["format"].get<std::int64_t>();
  if (format == kStoreFormat) return;
  const auto by = json.find("gust");
  const std::string maker = by != json.end() && by->is_string() ? by->get<std::string>() : "of another version";
  throw Error(cat(folder_.string(), ": a store of format ", format, ", made by gust ", maker, "; gust ", kVersion,
                  " reads format ", kStoreFormat, ": use that version, or choose another folder"));
}

void Store::tell(const std::string& sentence) const {
  if (!notice_) return;
  const std::lock_guard lock(told_mutex_);
  if (told_.insert(sentence).second) notice_(sentence);
}

fs::path Store::folder_of(std::string_view kind, std::string_view id) const {
  GUST_CHECK(valid_store_kind(kind) && valid_store_name(id));
  return folder_ / kind / id;
}

fs::path Store::aside() const {
  GUST_CHECK(session_ != nullptr);
  return session_->next();
}

bool Store::has(std::string_view kind, std::string_view id) const {
  return is_there(folder_of(kind, id) / kManifestName);
}

std::optional<StoredTrial> Store::load(std::string_view kind, std::string_view id) const {
  const fs::path folder = folder_of(kind, id);
  if (!is_there(folder)) return std::nullopt;
  CheckedTrial checked = check_trial(folder, kind, id);
  if (checked.damage.empty()) return std::move(checked.trial);
  if (session_ != nullptr) return repair(kind, id);
  tell(cat("damaged: ", checked.damage, remedy(folder_)));
  return std::nullopt;
}

std::optional<StoredTrial> Store::repair(std::string_view kind, std::string_view id) const {
  // One process at a time, so that none moves away what another has just put in the place of the damaged one.
  const Descriptor lock = lock_file(folder_ / kFormatName, /*wait=*/true, folder_);
  const fs::path folder = folder_of(kind, id);
  if (!is_there(folder)) return std::nullopt;
  CheckedTrial checked = check_trial(folder, kind, id);
  if (checked.damage.empty()) return std::move(checked.trial);
  tell(cat("damaged: ", checked.damage, "; it was moved to ", move_away(folder, kind, id).string(),
           " and is computed again"));
  return std::nullopt;
}

fs::path Store::move_away(const fs::path& from, std::string_view kind, std::string_view id) const {
  make_folders(folder_ / kDamaged);
  for (int number = 1;; ++number) {
    const fs::path target = folder_ / kDamaged / cat(kind, "-", id, "-", number);
    if (is_there(target)) continue;
    if (::rename(from.c_str(), target.c_str()) == 0) return target;
    if (errno != EEXIST && errno != ENOTEMPTY) throw file_error(from, "cannot be moved away");
  }
}

void Store::condemn(const StoredTrial& trial, std::string_view damage) const {
  const std::string what = cat("damaged: ", trial.folder.string(), ": ", damage);
  if (session_ == nullptr) return tell(cat(what, remedy(folder_)));
  const Descriptor lock = lock_file(folder_ / kFormatName, /*wait=*/true, folder_);
  const CheckedTrial now = check_trial(trial.folder, trial.manifest.kind, trial.manifest.id);
  if (!now.damage.empty() || now.trial.manifest != trial.manifest) return;  // another process has mended it
  const fs::path place = move_away(trial.folder, trial.manifest.kind, trial.manifest.id);
  tell(cat(what, "; it was moved to ", place.string(), " and is computed again"));
}

void Store::compare(const StoredTrial& first, const Manifest& other, std::string_view place) const {
  if (differing_files(first.manifest, other).empty()) return;
  ++disagreements_;
  tell(disagreement_text(first.manifest, other, first.folder.string(), place));
}

std::string Store::remedy(const fs::path& store) {
  return cat("; 'gust store repair ", shell_word(store.string()), "' moves it aside, 'gust run' computes it again");
}

TrialWriter Store::begin(std::string_view kind, std::string_view id) const { return TrialWriter(*this, kind, id); }

std::vector<std::pair<std::string, std::string>> Store::trials() const {
  std::vector<std::pair<std::string, std::string>> found;
  for (const std::string& kind : entries(folder_)) {
    if (!valid_store_kind(kind)) continue;
    for (const std::string& id : entries(folder_ / kind)) {
      if (valid_store_name(id) && has(kind, id)) found.emplace_back(kind, id);
    }
  }
  return found;
}

TrialWriter::TrialWriter(const Store& store, std::string_view kind, std::string_view id)
    : store_(&store), kind_(kind), id_(id), folder_(store.aside()) {
  GUST_CHECK(valid_store_kind(kind_) && valid_store_name(id_));
  make_folders(folder_);
}

TrialWriter::~TrialWriter() {
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

OutputFile& TrialWriter::file(std::string_view name) {
  GUST_CHECK(valid_store_name(name) && name != kManifestName);
  return *files_.emplace_back(std::make_unique<OutputFile>(folder_ / name));
}

void TrialWriter::write(std::string_view name, std::string_view bytes) { file(name).append(bytes); }

void TrialWriter::commit(std::string_view text) {
  Manifest manifest = {kind_, id_, std::string(text), std::string(kVersion), {}};
  for (const auto& file : files_) manifest.files.push_back(file->description());
  commit_as(manifest);
}

void TrialWriter::discard(const StoredTrial& first, const Manifest& manifest) {
  if (!differing_files(first.manifest, manifest).empty())
    store_->compare(first, manifest, store_->move_away(folder_, kind_, id_).string());
  remove_checkpoint(*store_, id_);
}

void TrialWriter::commit_as(const Manifest& manifest) {
  const auto agrees = [](const std::unique_ptr<OutputFile>& file, const StoredFile& said) {
    return file->description() == said;
  };
  const bool same_trial = manifest.kind == kind_ && manifest.id == id_;
  if (!same_trial || !std::ranges::equal(files_, manifest.files, agrees)) {
    throw Error(cat(kind_, "/", id_, ": the files disagree with their manifest"));
  }
  for (const auto& file : files_) file->close();
  OutputFile written(folder_ / kManifestName);
  written.append(manifest_bytes(manifest));
  written.close();
  sync_folder(folder_);

  const fs::path place = store_->folder_of(kind_, id_);
  make_folders(place.parent_path());
  while (::rename(folder_.c_str(), place.c_str()) != 0) {
    if (errno != EEXIST && errno != ENOTEMPTY) throw file_error(place, "cannot be put into the store");
    // Another process was faster, and our copy goes with this writer; or something broken is in the way.
    const std::optional<StoredTrial> first = store_->load(kind_, id_);
    if (first) return discard(*first, manifest);
  }
  sync_folder(place.parent_path());
  remove_checkpoint(*store_, id_);
}

}  // namespace gust
