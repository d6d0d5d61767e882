#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "gust/study/store_manifest.h"

namespace gust {

/// The 128-bit XXH3 hash of bytes that come piece by piece; see hash_hex.
class StreamHash {
 public:
  StreamHash();
  ~StreamHash();
  StreamHash(StreamHash&&) noexcept;

  void add(std::string_view bytes);
  /// 32 hexadecimal digits.
  std::string hex() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A new file that is written from front to back through a buffer. What the disk refuses is an Error with the file's
/// name and the reason.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void append(std::string_view bytes);
  /// Writes out the buffer, syncs, closes. Nothing may be appended afterwards.
  void close();

  /// Name, size and hash of what was appended so far.
  StoredFile description() const;

 private:
  void flush();

  std::filesystem::path path_;
  int descriptor_ = -1;
  std::string buffer_;
  std::uint64_t size_ = 0;
  StreamHash hash_;
};

}  // namespace gust
