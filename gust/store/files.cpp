#include "gust/store/files.h"

#include <fcntl.h>
#include <fnmatch.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

namespace gust {
namespace {

constexpr std::size_t kPiece = 1 << 16;  // bytes read or written at a time
constexpr const char* kAllFolders = "**";
constexpr std::size_t kMostMatches = 10'000;    // of a pattern, and of each of its parts
constexpr std::size_t kMostLooked = 1'000'000;  // entries of folders that one pattern looks at

/// Counts what a pattern finds.
struct MatchLimit {
  std::string_view pattern;
  std::size_t looked = 0;

  void look() {
    if (++looked > kMostLooked) throw too_many(kMostLooked, "folder entries to look at");
  }
  void check(std::size_t found) const {
    if (found > kMostMatches) throw too_many(kMostMatches, "matches");
  }
  Error too_many(std::size_t most, const char* what) const {
    return Error(cat("the pattern '", pattern, "' has more than ", most, " ", what, "; name a smaller folder"));
  }
};

bool has_wildcard(std::string_view part) { return part.find_first_of("*?[\\") != std::string_view::npos; }

/// The entries of a folder whose name fits one part of a pattern; none if the folder cannot be listed.
std::vector<std::filesystem::path> entries_like(const std::filesystem::path& folder, const std::string& part,
                                                MatchLimit& limit) {
  std::vector<std::filesystem::path> found;
  std::error_code error;
  std::filesystem::directory_iterator entries(folder.empty() ? "." : folder, error);
  for (; !error && entries != std::filesystem::directory_iterator(); entries.increment(error)) {
    limit.look();
    const std::string name = entries->path().filename().string();
    if (::fnmatch(part.c_str(), name.c_str(), FNM_PERIOD) == 0) found.push_back(folder / name);
    limit.check(found.size());
  }
  return found;
}

/// A folder and all below it, but no hidden ones and none behind a link.
std::vector<std::filesystem::path> folders_from(const std::filesystem::path& folder, MatchLimit& limit) {
  std::vector<std::filesystem::path> found = {folder};
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (std::filesystem::path& below : entries_like(found[i], "*", limit)) {
      std::error_code error;
      if (std::filesystem::symlink_status(below, error).type() == std::filesystem::file_type::directory)
        found.push_back(std::move(below));
    }
    limit.check(found.size());
  }
  return found;
}

/// What one part of a pattern names in a folder.
std::vector<std::filesystem::path> matches(const std::filesystem::path& folder, const std::filesystem::path& part,
                                           MatchLimit& limit) {
  if (part == kAllFolders) return folders_from(folder, limit);
  std::error_code error;
  if (!has_wildcard(part.native()) || std::filesystem::exists(folder / part, error)) return {folder / part};
  if (part.native().find(kAllFolders) != std::string::npos)
    throw Error(cat("'**' stands for folders and must be a part of its own, as in 'runs/**/*.onnx', got '",
                    part.native(), "'"));
  return entries_like(folder, part.native(), limit);
}

/// Where a file is written before it is renamed into place: always there, so that a killed program leaves one at most.
std::filesystem::path aside_of(const std::filesystem::path& file) {
  return file.parent_path() / cat(".", file.filename().string(), ".aside");
}

bool is_of_proc(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::weakly_canonical(path.parent_path(), error).native().starts_with("/proc/");
}

}  // namespace

std::string read_file(const std::filesystem::path& path, std::size_t most) {
  const Descriptor file = open_to_read(path);
  struct stat info {};
  const auto too_long = [&] { return Error(cat(path.string(), ": cannot read: longer than ", most, " bytes")); };
  const bool sized = ::fstat(file.get(), &info) == 0 && S_ISREG(info.st_mode) && info.st_size > 0;
  if (sized && static_cast<std::size_t>(info.st_size) > most) throw too_long();  // before memory is spent on it
  std::string bytes;
  if (sized) bytes.reserve(static_cast<std::size_t>(info.st_size) + kPiece);  // so that it is not copied as it grows
  while (true) {
    const std::size_t size = bytes.size();
    bytes.resize(std::max(size + kPiece, bytes.capacity()));
    const ssize_t count = ::read(file.get(), bytes.data() + size, bytes.size() - size);
    bytes.resize(size + (count > 0 ? static_cast<std::size_t>(count) : 0));
    if (count < 0 && errno != EINTR) throw file_error(path, "cannot read");
    if (count == 0) return bytes;
    if (bytes.size() > most) throw too_long();
  }
}

std::filesystem::path link_target(std::filesystem::path path) {
  constexpr int kMostLinks = 40;  // as many as Linux follows
  for (int links = 0; links < kMostLinks; ++links) {
    std::error_code no_link;
    const std::filesystem::path target = std::filesystem::read_symlink(path, no_link);
    if (no_link || is_of_proc(path)) return path;
    path = path.parent_path() / target;  // an absolute one replaces what is before it
  }
  errno = ELOOP;
  throw file_error(path, "cannot write");
}

bool is_stream(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) return false;
  return !std::filesystem::is_regular_file(status) || std::filesystem::is_symlink(link_target(path), error);
}

void check_folder_of(const std::filesystem::path& file, std::string_view named) {
  const std::filesystem::path folder = link_target(file).parent_path();
  std::error_code error;
  if (folder.empty() || std::filesystem::is_directory(folder, error)) return;
  const bool there = std::filesystem::exists(folder, error);
  throw Error(cat(named, ": '", file.string(), "': ", folder.string(),
                  there ? " is no folder" : " is not there; make the folder first (mkdir -p)"));
}

AtomicFile::AtomicFile(std::filesystem::path path) : path_(link_target(std::move(path))) {
  if (is_stream(path_)) {
    descriptor_ = open_file(path_, O_WRONLY | O_APPEND);  // behind what others have written there
    return;
  }
  if (path_.has_parent_path()) make_folders(path_.parent_path());
  aside_ = aside_of(path_);
  descriptor_ = lock_file(aside_, /*wait=*/true, path_);
  if (::ftruncate(descriptor_.get(), 0) != 0) throw file_error(path_, "cannot write");
}

AtomicFile::~AtomicFile() {
  if (descriptor_ && !aside_.empty()) ::unlink(aside_.c_str());
}

void AtomicFile::append(std::string_view bytes) {
  buffer_.append(bytes);
  if (buffer_.size() < kPiece) return;
  write_all(descriptor_, buffer_, path_);
  buffer_.clear();
}

void AtomicFile::commit() {
  write_all(descriptor_, buffer_, path_);
  buffer_.clear();
  if (!aside_.empty()) {
    sync_file(descriptor_, path_);
    if (::rename(aside_.c_str(), path_.c_str()) != 0) throw file_error(path_, "cannot write");
    aside_.clear();
    sync_folder(path_.parent_path());
  }
  descriptor_.close();
}

void remove_left_aside(const std::filesystem::path& file) {
  const std::filesystem::path aside = aside_of(link_target(file));
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(std::filesystem::symlink_status(aside, unknown))) return;
  try {
    if (lock_file(aside, /*wait=*/false, aside)) ::unlink(aside.c_str());
  } catch (const Error&) {  // of another user: he removes it
  }
}

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
  AtomicFile file(path);
  file.append(bytes);
  file.commit();
}

std::vector<std::filesystem::path> glob_files(const std::filesystem::path& base, std::string_view pattern) {
  const std::filesystem::path path(pattern);
  if (!has_wildcard(pattern)) return {base / path};  // an absolute path replaces the base
  std::vector<std::filesystem::path> found = {path.is_absolute() ? std::filesystem::path() : base};
  std::vector<std::filesystem::path> parts(path.begin(), path.end());
  if (parts.back() == kAllFolders) parts.emplace_back("*");  // all files below
  MatchLimit limit{pattern};
  for (const std::filesystem::path& part : parts) {
    std::vector<std::filesystem::path> longer;
    for (const std::filesystem::path& folder : found) {
      std::ranges::move(matches(folder, part, limit), std::back_inserter(longer));
      limit.check(longer.size());
    }
    found = std::move(longer);
  }
  std::erase_if(found, [](const std::filesystem::path& file) {
    std::error_code error;
    return !std::filesystem::is_regular_file(file, error);
  });
  const auto bytes = [](const std::filesystem::path& file) -> const std::string& { return file.native(); };
  std::ranges::sort(found, {}, bytes);
  const auto repeats = std::ranges::unique(found, {}, bytes);
  found.erase(repeats.begin(), repeats.end());
  return found;
}

}  // namespace gust
