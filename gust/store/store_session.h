#pragma once

#include <atomic>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

#include "gust/store/files_posix.h"

namespace gust {

/// Where the sessions of a store lie.
inline constexpr std::string_view kAsideName = "aside";

/// The sessions there, and whether their processes are gone.
std::vector<std::pair<std::filesystem::path, bool>> sessions_in(const std::filesystem::path& aside);

/// A folder of one process's own within STORE/aside, for what is still being written. Its lock file beside it is held
/// as long as the process lives, so that others can tell what a dead one left behind.
class StoreSession {
 public:
  /// Removes the folders of dead sessions and makes one. An Error if nothing can be written there.
  explicit StoreSession(std::filesystem::path aside);
  ~StoreSession();
  StoreSession(const StoreSession&) = delete;
  StoreSession& operator=(const StoreSession&) = delete;

  /// A path in the folder that was not given out before. Any thread may ask.
  std::filesystem::path next();

 private:
  void claim();

  std::filesystem::path aside_;
  std::filesystem::path folder_;
  Descriptor lock_;
  std::atomic<std::uint64_t> given_ = 0;
};

}  // namespace gust
