#pragma once

#include <filesystem>
#include <string_view>
#include <utility>

#include "gust/core/error.h"

namespace gust {

/// Owns an open file; -1 is none.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() { close(); }

  int get() const { return number_; }
  explicit operator bool() const { return number_ >= 0; }
  void close();

 private:
  int number_;
};

/// What a system call refused, with the errno.
struct FileError : Error {
  FileError(const std::string& text, int number) : Error(text), code(number) {}

  /// Whether it says what lies there, and not that the machine could not look: descriptors or memory ran out, a disk
  /// failed.
  bool is_about_file() const;

  int code;
};

/// "path: what: reason", with the reason that the last system call gave in errno.
FileError file_error(const std::filesystem::path& path, std::string_view what);

/// Opens a file; an Error if that fails. The flags are those of open(2).
Descriptor open_file(const std::filesystem::path& path, int flags);

/// Opens a file to read it, without waiting for anybody: what is a pipe, a socket or a folder is an Error.
Descriptor open_to_read(const std::filesystem::path& path);

void write_all(const Descriptor& file, std::string_view bytes, const std::filesystem::path& path);

/// Waits until the content of a file has reached the disk. A file system that does not know how is left to itself, here
/// and for folders: CIFS and FUSE do not for folders, and nothing is wrong with the file.
void sync_file(const Descriptor& file, const std::filesystem::path& path);

/// Waits until the entries of a folder have reached the disk.
void sync_folder(const std::filesystem::path& folder);

/// Makes a folder and those above it.
void make_folders(const std::filesystem::path& folder);

/// Opens a file, made if need be, and holds its lock, against other processes and other openings in this one, until the
/// descriptor closes. The file was in its place when the lock was got, so whoever removes it under the lock leaves no
/// two holders. Waits for the lock, or gives no descriptor if `wait` is false and another holds it. Errors name
/// `named`; that of a file system without locks says what to do.
Descriptor lock_file(const std::filesystem::path& path, bool wait, const std::filesystem::path& named);

}  // namespace gust
