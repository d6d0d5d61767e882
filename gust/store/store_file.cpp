#include "gust/store/store_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>

#include "gust/core/error.h"

namespace gust {
namespace {

constexpr std::size_t kPiece = 1 << 16;  // bytes read or written at a time

}  // namespace

struct StreamHash::State {
  State() : xxh(XXH3_createState()) {
    GUST_CHECK(xxh != nullptr);
    XXH3_128bits_reset(xxh);
  }
  ~State() { XXH3_freeState(xxh); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  XXH3_state_t* xxh;
};

StreamHash::StreamHash() : state_(std::make_unique<State>()) {}
StreamHash::~StreamHash() = default;
StreamHash::StreamHash(StreamHash&&) noexcept = default;
StreamHash& StreamHash::operator=(StreamHash&&) noexcept = default;

void StreamHash::add(std::string_view bytes) { XXH3_128bits_update(state_->xxh, bytes.data(), bytes.size()); }

std::string StreamHash::hex() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_->xxh);
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

OutputFile::OutputFile(std::filesystem::path path)
    : path_(std::move(path)), descriptor_(open_file(path_, O_WRONLY | O_CREAT | O_EXCL)) {}

void OutputFile::append(std::string_view bytes) {
  GUST_CHECK(descriptor_);
  hash_.add(bytes);
  size_ += bytes.size();
  buffer_.append(bytes);
  if (buffer_.size() < kPiece) return;
  write_all(descriptor_, buffer_, path_);
  buffer_.clear();
}

void OutputFile::close() {
  if (!descriptor_) return;
  write_all(descriptor_, buffer_, path_);
  sync_file(descriptor_, path_);
  descriptor_.close();
}

StoredFile OutputFile::description() const { return {path_.filename().string(), size_, hash_.hex()}; }

StoredFile describe_file(const std::filesystem::path& path) {
  const Descriptor file = open_to_read(path);
  struct stat info {};
  const bool regular = ::fstat(file.get(), &info) == 0 && S_ISREG(info.st_mode);
  if (!regular) throw Error(cat(path.string(), ": is no regular file"));  // /dev/zero has no end
  StreamHash hash;
  std::uint64_t size = 0;
  std::string piece(kPiece, '\0');
  while (true) {
    const ssize_t count = ::read(file.get(), piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw file_error(path, "cannot read");
    if (count == 0) return {path.filename().string(), size, hash.hex()};
    hash.add(std::string_view(piece.data(), static_cast<std::size_t>(count)));
    size += static_cast<std::uint64_t>(count);
  }
}

}  // namespace gust
