#include "gust/store/store_session.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <set>
#include <system_error>

namespace gust {
namespace {

namespace fs = std::filesystem;

fs::path lock_of(const fs::path& folder) { return fs::path(folder) += ".lock"; }

/// Removes a session's folder and lock unless its process still lives. Whoever holds the lock may remove it; a folder
/// without a lock gets one first, so that no two processes take the same name.
void remove_if_dead(const fs::path& folder) {
  const fs::path lock = lock_of(folder);
  const Descriptor held = lock_file(lock, /*wait=*/false, lock);
  if (!held) return;
  std::error_code ignored;  // what cannot be removed now is removed another time
  fs::remove_all(folder, ignored);
  ::unlink(lock.c_str());
}

/// Every session's folder, which only its lock may stand for.
std::set<fs::path> session_folders(const fs::path& aside) {
  std::set<fs::path> sessions;
  std::error_code error;
  for (fs::directory_iterator at(aside, error); !error && at != fs::directory_iterator(); at.increment(error)) {
    const fs::path& path = at->path();
    sessions.insert(path.extension() == ".lock" ? path.parent_path() / path.stem() : path);
  }
  return sessions;
}

void remove_dead_sessions(const fs::path& aside) {
  for (const fs::path& session : session_folders(aside)) remove_if_dead(session);
}

}  // namespace

std::vector<std::pair<fs::path, bool>> sessions_in(const fs::path& aside) {
  std::vector<std::pair<fs::path, bool>> found;
  for (const fs::path& session : session_folders(aside)) {
    const Descriptor lock(::open(lock_of(session).c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    const bool held = lock && ::flock(lock.get(), LOCK_EX | LOCK_NB) != 0;
    found.emplace_back(session, !held);
  }
  return found;
}

StoreSession::StoreSession(fs::path aside) : aside_(std::move(aside)) {
  make_folders(aside_);
  remove_dead_sessions(aside_);
  claim();
}

void StoreSession::claim() {
  for (int attempt = 0;; ++attempt) {
    folder_ = aside_ / cat(::getpid(), "-", attempt);
    const fs::path lock = lock_of(folder_);
    lock_ = lock_file(lock, /*wait=*/false, lock);
    if (!lock_) continue;
    if (::mkdir(folder_.c_str(), 0777) == 0) return;
    if (errno != EEXIST) throw file_error(folder_, "cannot make the folder");
    lock_.close();  // left by a process of the same number on another machine, or one that just died
  }
}

StoreSession::~StoreSession() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
  ::unlink(lock_of(folder_).c_str());
}

fs::path StoreSession::next() { return folder_ / std::to_string(given_.fetch_add(1)); }

}  // namespace gust
