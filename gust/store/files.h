#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "gust/store/files_posix.h"

namespace gust {

/// The longest text file of ours: manifests, curves, tables. Kinds with a limit of their own name it.
inline constexpr std::size_t kTextBytes = std::size_t{64} << 20;

/// The content of a file. Throws an Error that names the file and says why it cannot be read. What is longer than
/// `most` is refused before it is read; pipes and sockets, which could keep a reader waiting, are refused too.
std::string read_file(const std::filesystem::path& path, std::size_t most = kTextBytes);

/// What may be written in place of a path: where its links end, whether anything is there or not. A link of /proc, as
/// /dev/stdout is one, is not followed: what it stands for is open already, and need not have a name.
std::filesystem::path link_target(std::filesystem::path path);

/// Whether a path is, or leads to, something that is there and can only be written through: a device, a pipe, or what
/// is open already.
bool is_stream(const std::filesystem::path& path);

/// Throws Error, which begins with `named`, unless the folder is there in which this file is to be written: a user's
/// file in a folder that is not there is a slip of the keyboard.
void check_folder_of(const std::filesystem::path& file, std::string_view named);

/// A file that is replaced whole or not at all: written aside in the same folder, synced, renamed, the folder synced.
///
/// Folders above it are made. A link is followed, also one to nothing; a stream such as /dev/stdout is written
/// directly. Failures are Errors that name the file and the reason. What is not committed leaves the old file as it
/// was.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Adds to the end, through a buffer.
  void append(std::string_view bytes);
  void commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path aside_;  ///< empty when there is nothing to rename
  Descriptor descriptor_;
  std::string buffer_;
};

/// Removes what a killed program left of an AtomicFile, unless another is just writing it.
void remove_left_aside(const std::filesystem::path& file);

/// Replaces a file by these bytes; see AtomicFile.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// The paths that a pattern such as "policies/*.onnx" names, relative to a base folder unless it is absolute, sorted by
/// their bytes, each once. A part of the path that is there by that very name is that file or folder, also where it has
/// brackets. Else `*`, `?` and `[...]` match within the part, and no leading dot; `\\` takes away their meaning. The
/// part
/// `**` is this folder and all below it, but no hidden ones and none behind a link. A pattern without any of these
/// gives the path itself, whether it is there or not; one that nothing matches gives an empty list. An Error if `**` is
/// only a piece of a part, and if too many match.
std::vector<std::filesystem::path> glob_files(const std::filesystem::path& base, std::string_view pattern);

}  // namespace gust
