#include "gust/study/trials/store_check.h"

#include <unistd.h>

#include <algorithm>
#include <map>

#include "gust/store/files.h"
#include "gust/store/store_format.h"
#include "gust/store/store_session.h"
#include "gust/study/trials/folder.h"
#include "gust/study/trials/trial_check.h"

namespace gust {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> entries(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator at(folder, error); !error && at != fs::directory_iterator(); at.increment(error))
    found.push_back(at->path());
  std::ranges::sort(found);
  return found;
}

bool is_left_aside(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.starts_with('.') && (name.ends_with(".aside") || name.ends_with(".part"));
}

/// Every folder of a store that is meant to be a trial, as (kind, id).
std::vector<std::pair<std::string, std::string>> trial_folders(const fs::path& folder) {
  std::vector<std::pair<std::string, std::string>> found;
  for (const fs::path& kind : entries(folder)) {
    if (!valid_store_kind(kind.filename().string()) || kind.filename() == kTimingsName) continue;
    for (const fs::path& id : entries(kind)) {
      if (valid_store_name(id.filename().string())) found.emplace_back(kind.filename(), id.filename());
    }
  }
  return found;
}

/// What is wrong with the store's own description; empty if nothing is. One of another format is an Error.
std::string format_damage(const fs::path& folder) {
  if (!Store::is_at(folder)) return "is missing";
  try {
    Store(folder, Store::Access::read);
    return "";
  } catch (const FileError& error) {
    if (!error.is_about_file()) throw;
    return error.what();
  } catch (const Error& error) {
    if (std::string_view(error.what()).find("a store of format") != std::string_view::npos) throw;
    return "damaged";
  }
}

/// Whether some trial says by its manifest that this is a store of our format.
bool describes_itself(const fs::path& folder) {
  return std::ranges::any_of(trial_folders(folder), [&](const auto& trial) {
    try {
      const fs::path path = folder / trial.first / trial.second / kManifestName;
      const Manifest manifest = parse_manifest(read_file(path), "");
      return manifest.kind == trial.first && manifest.id == trial.second;
    } catch (const Error&) {
      return false;
    }
  });
}

/// What one trial is like.
class TrialCheck {
 public:
  explicit TrialCheck(const Plan* plan) : plan_(plan) {
    if (plan == nullptr) return;
    for (const Trial& trial : plan->trials) planned_[{std::string(kind_name(trial.kind)), trial.id}] = &trial;
  }

  std::string damage(const StoredTrial& stored) const {
    const auto at = planned_.find({stored.manifest.kind, stored.manifest.id});
    if (at == planned_.end()) return content_damage(stored, CheckDepth::whole);
    return content_damage(*plan_, *at->second, stored, CheckDepth::whole);
  }

 private:
  const Plan* plan_;
  std::map<std::pair<std::string, std::string>, const Trial*> planned_;
};

void find_leftovers(const fs::path& folder, StoreCheck& check) {
  for (const fs::path& path : entries(folder)) {
    if (is_left_aside(path)) check.leftover.push_back({path.string(), "was left by a process that is gone"});
  }
  for (const auto& [session, dead] : sessions_in(folder / kAsideName)) {
    if (dead) check.leftover.push_back({session.string(), "was left by a process that is gone"});
  }
  for (const fs::path& path : entries(folder / "checkpoints")) {
    for (const fs::path& kind : entries(folder)) {
      if (valid_store_kind(kind.filename().string()) && fs::exists(kind / path.filename() / kManifestName))
        check.leftover.push_back({path.string(), "is the checkpoint of a training that is finished"});
    }
  }
}

void check_trials(const Store& store, const Plan* plan, std::string& told, StoreCheck& check) {
  const TrialCheck content(plan);
  for (const auto& [kind, id] : trial_folders(store.folder())) {
    const fs::path place = store.folder_of(kind, id);
    told.clear();
    try {
      const std::optional<StoredTrial> stored = store.load(kind, id);
      const std::string damage = stored ? content.damage(*stored) : told;
      check.whole += damage.empty() ? 1 : 0;
      if (!damage.empty()) check.damaged.push_back({place.string(), damage});
    } catch (const FileError& error) {
      check.damaged.push_back({place.string(), error.what()});
    }
  }
}

/// "damaged: …; it was moved …" without what stands around the reason.
std::string reason_of(const std::string& sentence) {
  const std::string head = "damaged: ";
  const std::size_t begin = sentence.starts_with(head) ? head.size() : 0;
  return sentence.substr(begin, sentence.find("; 'gust store repair") - begin);
}

}  // namespace

StoreCheck check_store(const fs::path& folder, const Plan* plan) {
  StoreCheck check;
  if (const std::string damage = format_damage(folder); !damage.empty()) {
    if (!describes_itself(folder)) throw Error(cat(folder.string(), ": no store lies here; gust run makes one"));
    check.damaged.push_back({(folder / kFormatName).string(), damage});
    find_leftovers(folder, check);
    return check;
  }
  std::string told;
  const Store store(folder, Store::Access::read, [&](const std::string& sentence) { told = reason_of(sentence); });
  check_trials(store, plan, told, check);
  find_leftovers(folder, check);
  return check;
}

StoreCheck repair_store(const fs::path& folder, const Plan* plan, const Store::Notice& notice) {
  StoreCheck found;
  if (const std::string damage = format_damage(folder); !damage.empty()) {
    if (!describes_itself(folder)) throw Error(cat(folder.string(), ": no store lies here; gust run makes one"));
    found.damaged.push_back({(folder / kFormatName).string(), damage});
    std::error_code unknown;
    if (!fs::is_regular_file(fs::symlink_status(folder / kFormatName, unknown)))
      fs::remove(folder / kFormatName, unknown);
    write_store_format(folder);
    if (notice) notice(cat((folder / kFormatName).string(), ": ", damage, "; it was written again"));
  }
  const StoreCheck before = check_store(folder, plan);
  found.whole = before.whole;
  found.leftover = before.leftover;
  std::ranges::copy(before.damaged, std::back_inserter(found.damaged));
  const Store store(folder, Store::Access::write);  // removes what the dead left
  for (const StoreProblem& trial : before.damaged) {
    const fs::path place = trial.path;
    const fs::path target = store.move_away(place, place.parent_path().filename().string(), place.filename().string());
    if (notice) notice(cat(trial.path, ": ", trial.what, "; it was moved to ", target.string()));
  }
  for (const fs::path& path : entries(folder)) {
    const std::string name = path.filename().string();
    if (name.ends_with(".aside")) remove_left_aside(folder / name.substr(1, name.size() - 1 - 6));
  }
  return found;
}

std::optional<fs::path> store_around(const fs::path& path) {
  std::error_code unknown;
  const fs::path real = fs::weakly_canonical(fs::absolute(path, unknown), unknown);
  for (fs::path at = real; at != at.parent_path(); at = at.parent_path()) {
    if (Store::is_at(at)) return at;
  }
  return std::nullopt;
}

fs::path store_in(const fs::path& folder) {
  const bool is_store = Store::is_at(folder) || !trial_folders(folder).empty();
  const fs::path inside = StudyFolder(folder).store();
  std::error_code unknown;
  return is_store && !fs::is_directory(folder / "store", unknown) ? folder : inside;
}

}  // namespace gust
