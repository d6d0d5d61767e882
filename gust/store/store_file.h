#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "gust/store/files_posix.h"
#include "gust/store/store_manifest.h"

namespace gust {

/// The 128-bit XXH3 hash of bytes that come piece by piece; see hash_hex.
class StreamHash {
 public:
  StreamHash();
  ~StreamHash();
  StreamHash(StreamHash&&) noexcept;
  StreamHash& operator=(StreamHash&&) noexcept;

  void add(std::string_view bytes);
  /// 32 hexadecimal digits.
  std::string hex() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A new file of a trial, written from front to back through a buffer. What the disk refuses is an Error with the
/// file's name and the reason.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void append(std::string_view bytes);
  /// Writes out the buffer, syncs, closes. Nothing may be appended afterwards.
  void close();

  /// Name, size and hash of what was appended so far.
  StoredFile description() const;

 private:
  std::filesystem::path path_;
  Descriptor descriptor_;
  std::string buffer_;
  std::uint64_t size_ = 0;
  StreamHash hash_;
};

/// Name, size and hash of a file as it lies on the disk.
StoredFile describe_file(const std::filesystem::path& path);

}  // namespace gust
