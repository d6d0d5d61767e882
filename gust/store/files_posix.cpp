#include "gust/store/files_posix.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace gust {
namespace {

/// What a file system says of a call that it does not know.
bool is_unknown_call(int error) {
  return error == EINVAL || error == ENOTSUP || error == EOPNOTSUPP || error == ENOSYS;
}

/// Makes a folder and those above it, each synced into its parent.
std::error_code make_and_sync(const std::filesystem::path& folder) {
  std::error_code error;
  if (folder.empty() || std::filesystem::is_directory(folder, error)) return {};
  const std::filesystem::path parent = folder.parent_path();
  if (parent != folder) error = make_and_sync(parent);
  if (error) return error;
  std::filesystem::create_directory(folder, error);  // false if another process was faster, which is no error
  if (error) return error;
  const Descriptor above(::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (above) sync_file(above, parent);  // one that may be written but not read is left to itself
  return {};
}

}  // namespace

void Descriptor::close() {
  if (number_ >= 0) ::close(number_);
  number_ = -1;
}

bool FileError::is_about_file() const {
  return code == ENOENT || code == ENOTDIR || code == EISDIR || code == ELOOP || code == ENXIO || code == ENAMETOOLONG;
}

FileError file_error(const std::filesystem::path& path, std::string_view what) {
  const int code = errno;
  return {cat(path.string(), ": ", what, ": ", std::generic_category().message(code)), code};
}

Descriptor open_file(const std::filesystem::path& path, int flags) {
  // A pipe without a reader would keep a writer waiting, and a signal would not wake it.
  Descriptor file(::open(path.c_str(), flags | O_CLOEXEC | O_NOCTTY | O_NONBLOCK, 0666));
  if (!file && errno == ENXIO && (flags & O_ACCMODE) == O_WRONLY)
    throw Error(cat(path.string(), ": cannot write: nobody reads from this pipe"));
  if (!file) throw file_error(path, (flags & O_ACCMODE) == O_RDONLY ? "cannot read" : "cannot write");
  return file;
}

Descriptor open_to_read(const std::filesystem::path& path) {
  Descriptor file = open_file(path, O_RDONLY);
  struct stat info {};
  if (::fstat(file.get(), &info) != 0) throw file_error(path, "cannot read");
  if (S_ISREG(info.st_mode) || S_ISCHR(info.st_mode)) return file;
  errno = EISDIR;
  if (S_ISDIR(info.st_mode)) throw file_error(path, "cannot read");
  const char* what = S_ISFIFO(info.st_mode) ? "a pipe" : "no regular file";
  throw Error(cat(path.string(), ": cannot read: it is ", what, "; give a regular file"));
}

void write_all(const Descriptor& file, std::string_view bytes, const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0 && errno == EAGAIN) {  // a full pipe: wait for its reader
      pollfd slow{file.get(), POLLOUT, 0};
      ::poll(&slow, 1, -1);
      continue;
    }
    if (written < 0) throw file_error(path, "cannot write");
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void sync_file(const Descriptor& file, const std::filesystem::path& path) {
  if (::fsync(file.get()) != 0 && !is_unknown_call(errno)) throw file_error(path, "cannot write");
}

void sync_folder(const std::filesystem::path& folder) {
  const std::filesystem::path named = folder.empty() ? "." : folder;
  sync_file(open_file(named, O_RDONLY | O_DIRECTORY), named);
}

void make_folders(const std::filesystem::path& folder) {
  std::error_code error = make_and_sync(folder);
  if (error == std::errc::file_exists) error = std::make_error_code(std::errc::not_a_directory);
  if (error) throw Error(cat(folder.string(), ": cannot make the folder: ", error.message()));
}

Descriptor lock_file(const std::filesystem::path& path, bool wait, const std::filesystem::path& named) {
  while (true) {
    Descriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
    if (!file) throw file_error(named, "cannot write");
    while (::flock(file.get(), wait ? LOCK_EX : LOCK_EX | LOCK_NB) != 0) {
      if (errno == EINTR) continue;
      if (errno == EWOULDBLOCK) return Descriptor();
      if (errno != ENOLCK && !is_unknown_call(errno)) throw file_error(named, "cannot lock");
      throw Error(cat(named.string(),
                      ": cannot lock: its file system has no locks (flock: ", std::generic_category().message(errno),
                      "); choose a folder on another one, such as a local disk"));
    }
    // While we waited the file may have been removed, or renamed away and made anew.
    struct stat ours {};
    struct stat there {};
    const bool same = ::fstat(file.get(), &ours) == 0 && ::stat(path.c_str(), &there) == 0 &&
                      ours.st_ino == there.st_ino && ours.st_dev == there.st_dev;
    if (same) return file;
  }
}

}  // namespace gust
