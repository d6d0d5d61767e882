#pragma once

#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gust/store/store_file.h"
#include "gust/store/store_manifest.h"

namespace gust {

/// A finished trial whose files were found to be whole.
struct StoredTrial {
  std::filesystem::path folder;
  Manifest manifest;

  bool contains(std::string_view file) const;
  /// Throws Error unless it has such a file.
  void check(std::string_view file) const;
  /// The whole content of one of its files.
  std::string read(std::string_view file) const;
  /// One of its files, to be read as a stream.
  std::ifstream open(std::string_view file) const;
};

class StoreSession;
class TrialWriter;

/// The trials that are finished: folders STORE/<kind>/<id>, each with its files and a manifest.
///
/// A trial is written aside, synced and renamed, so it is there whole or not at all, after any kill and with any number
/// of processes on one store; whoever comes second compares his copy and discards it. Nothing says "running". All of it
/// may be used from many threads at once. Layout and guarantees: docs/formats.md.
class Store {
 public:
  enum class Access { read, write };
  /// Told what the user should know ("trial x is damaged: ..."), one sentence at a time, from any thread.
  using Notice = std::function<void(const std::string&)>;

  /// Opens a store. For writing it is made if need be, and what dead processes left aside is removed. A store of
  /// another format, a folder that is something else, and one that cannot be written are Errors.
  Store(std::filesystem::path folder, Access access, Notice notice = {});
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  /// Whether a store lies there, of whatever format.
  static bool is_at(const std::filesystem::path& folder);

  /// Whether the trial is finished. Cheap: looks for its manifest and reads nothing.
  bool has(std::string_view kind, std::string_view id) const;

  /// A finished trial, after its manifest and the hashes of all its files were found right. One that is damaged is
  /// reported, moved to STORE/damaged (if open for writing), and then counts as missing.
  std::optional<StoredTrial> load(std::string_view kind, std::string_view id) const;

  /// Begins to write a trial. The store must outlive the writer.
  TrialWriter begin(std::string_view kind, std::string_view id) const;

  /// Gives a sentence to the notice, each once.
  void tell(const std::string& sentence) const;

  /// Every finished trial as (kind, id), sorted.
  std::vector<std::pair<std::string, std::string>> trials() const;

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path folder_of(std::string_view kind, std::string_view id) const;

  /// A path of this process's own on the store's disk, for something that is to be renamed into place.
  std::filesystem::path aside() const;

  /// Looks at a trial again while no other process may move it: returns it if it is whole, moves it away if not.
  std::optional<StoredTrial> repair(std::string_view kind, std::string_view id) const;

  /// Moves a folder to STORE/damaged and gives its place there.
  std::filesystem::path move_away(const std::filesystem::path& from, std::string_view kind, std::string_view id) const;

  /// Tells of a whole trial whose content is wrong, and moves it to STORE/damaged (if open for writing).
  void condemn(const StoredTrial& trial, std::string_view damage) const;

  /// Compares another result of a trial with the one that is there, at `place`. If they disagree, both are told with
  /// their places, and disagreements() counts it.
  void compare(const StoredTrial& first, const Manifest& other, std::string_view place) const;
  std::size_t disagreements() const { return disagreements_; }

  /// "; 'gust store repair STORE' moves it aside and 'gust run' computes it again".
  static std::string remedy(const std::filesystem::path& store);

 private:
  void initialise() const;
  void check_format() const;

  std::filesystem::path folder_;
  Notice notice_;
  mutable std::atomic<std::size_t> disagreements_ = 0;
  mutable std::mutex told_mutex_;
  mutable std::set<std::string> told_;     ///< each sentence is told once
  std::unique_ptr<StoreSession> session_;  ///< none when open for reading
};

/// A trial on its way into the store. What is not committed vanishes with the writer.
class TrialWriter {
 public:
  TrialWriter(const Store& store, std::string_view kind, std::string_view id);
  TrialWriter(TrialWriter&&) noexcept = default;
  TrialWriter& operator=(TrialWriter&&) = delete;
  ~TrialWriter();

  /// A new, empty file of the trial; it stays open until the trial is committed.
  OutputFile& file(std::string_view name);
  /// A file of the trial with this content.
  void write(std::string_view name, std::string_view bytes);

  /// Syncs everything, writes the manifest, renames the trial into place and removes its checkpoint. If another
  /// process was faster, its copy stays; ours goes if it is equal, and else to STORE/damaged with an alarm.
  void commit(std::string_view text);
  /// The same with the manifest that the trial had in another store; an Error if it disagrees with what was written.
  void commit_as(const Manifest& manifest);

 private:
  void discard(const StoredTrial& first, const Manifest& manifest);

  const Store* store_;
  std::string kind_;
  std::string id_;
  std::vector<std::unique_ptr<OutputFile>> files_;
  std::filesystem::path folder_;  ///< aside
};

}  // namespace gust
