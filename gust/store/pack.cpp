#include "gust/store/pack.h"

#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <fstream>
#include <memory>
#include <optional>

#include "gust/core/error.h"
#include "gust/store/files.h"

namespace gust {
namespace {

namespace fs = std::filesystem;

// A pack is this line and one zstd frame. In the frame: for each trial the length of its manifest (u32), the manifest,
// and the content of its files one after another; at the end a length of 0.
constexpr std::string_view kMagic = "gust pack 1\n";
constexpr std::uint32_t kLongestManifest = std::uint32_t{1} << 26;  // bytes
constexpr std::size_t kPiece = std::size_t{1} << 16;                // bytes at a time
constexpr std::uint64_t kMostExpansion = 1000;                      // what is made to fill a disk expands further
constexpr int kLevel = 9;                                           // of compression
constexpr int kLargestWindow = 27;  // log2 of the bytes that a frame may ask to keep at hand

struct FreeStream {
  void operator()(ZSTD_CStream* stream) const { ZSTD_freeCStream(stream); }
  void operator()(ZSTD_DStream* stream) const { ZSTD_freeDStream(stream); }
};

/// Compresses into a file.
class PackOutput {
 public:
  explicit PackOutput(const fs::path& path) : file_(path), stream_(ZSTD_createCStream()), piece_(kPiece, '\0') {
    GUST_CHECK(stream_ != nullptr);
    ZSTD_CCtx_setParameter(stream_.get(), ZSTD_c_compressionLevel, kLevel);
    ZSTD_CCtx_setParameter(stream_.get(), ZSTD_c_checksumFlag, 1);
    put(kMagic);
  }

  void add(std::string_view bytes, ZSTD_EndDirective end = ZSTD_e_continue) {
    ZSTD_inBuffer in = {bytes.data(), bytes.size(), 0};
    std::size_t left = 0;
    do {
      ZSTD_outBuffer out = {piece_.data(), piece_.size(), 0};
      left = ZSTD_compressStream2(stream_.get(), &out, &in, end);
      GUST_CHECK(ZSTD_isError(left) == 0);
      put({piece_.data(), out.pos});
    } while (in.pos < in.size || (end == ZSTD_e_end && left > 0));
  }

  void add_length(std::uint32_t length) { add({reinterpret_cast<const char*>(&length), sizeof length}); }

  /// Ends the frame, puts the file in its place, and returns its size.
  std::uint64_t finish() {
    add({}, ZSTD_e_end);
    file_.commit();
    return size_;
  }

 private:
  void put(std::string_view bytes) {
    file_.append(bytes);
    size_ += bytes.size();
  }

  AtomicFile file_;
  std::unique_ptr<ZSTD_CStream, FreeStream> stream_;
  std::string piece_;
  std::uint64_t size_ = 0;
};

/// Decompresses from a stream.
class PackInput {
 public:
  PackInput(std::istream& stream, std::string_view name)
      : stream_(stream), name_(name), frame_(ZSTD_createDStream()), packed_(kPiece, '\0'), raw_(kPiece, '\0') {
    GUST_CHECK(frame_ != nullptr);
    ZSTD_DCtx_setParameter(frame_.get(), ZSTD_d_windowLogMax, kLargestWindow);
  }

  Error damaged(std::string_view what) const { return Error(cat(name_, ": damaged pack: ", what)); }

  /// Some of the next bytes, at most this many, at least one; an Error at the end of the pack.
  std::string_view some(std::uint64_t most) {
    while (from_ == to_) refill();
    const std::size_t size = static_cast<std::size_t>(std::min<std::uint64_t>(most, to_ - from_));
    from_ += size;
    return {raw_.data() + from_ - size, size};
  }

  std::string exactly(std::size_t size) {
    std::string bytes;
    while (bytes.size() < size) bytes.append(some(size - bytes.size()));
    return bytes;
  }

  std::uint32_t length() {
    const std::string bytes = exactly(sizeof(std::uint32_t));
    return std::bit_cast<std::uint32_t>(std::array{bytes[0], bytes[1], bytes[2], bytes[3]});
  }

  /// Checks that nothing is left, and the checksum of all that was.
  void finish() {
    while (!ended_ && from_ == to_) refill();
    if (from_ != to_ || in_.pos != in_.size || stream_.peek() != std::istream::traits_type::eof()) {
      throw damaged("something follows its end");
    }
  }

 private:
  void refill() {
    if (ended_) throw damaged("cut short");
    if (in_.pos == in_.size) {
      stream_.read(packed_.data(), static_cast<std::streamsize>(packed_.size()));
      in_ = {packed_.data(), static_cast<std::size_t>(stream_.gcount()), 0};
      if (in_.size == 0) throw damaged("cut short");
      read_ += in_.size;
    }
    ZSTD_outBuffer out = {raw_.data(), raw_.size(), 0};
    const std::size_t left = ZSTD_decompressStream(frame_.get(), &out, &in_);
    if (ZSTD_isError(left) != 0) throw damaged(ZSTD_getErrorName(left));
    ended_ = left == 0;
    from_ = 0;
    to_ = out.pos;
    made_ += out.pos;
    if (made_ > kMostExpansion * read_ + (std::uint64_t{1} << 24)) throw damaged("it expands without measure");
  }

  std::istream& stream_;
  std::string_view name_;
  std::unique_ptr<ZSTD_DStream, FreeStream> frame_;
  std::string packed_;
  std::string raw_;
  ZSTD_inBuffer in_ = {nullptr, 0, 0};
  std::size_t from_ = 0;  ///< of what is decompressed and not yet given out
  std::size_t to_ = 0;
  std::uint64_t read_ = 0;
  std::uint64_t made_ = 0;
  bool ended_ = false;
};

/// Writes the trials of a pack into a store.
class Unpacker : public PackVisitor {
 public:
  Unpacker(const Store& store, std::string pack) : store_(store), pack_(std::move(pack)) {}

  void trial(const Manifest& manifest) override {
    if (const auto first = store_.load(manifest.kind, manifest.id)) {
      count.disagreeing += differing_files(first->manifest, manifest).empty() ? 0 : 1;
      return store_.compare(*first, manifest, cat(pack_, ": ", manifest.kind, "/", manifest.id));
    }
    writer_.emplace(store_, manifest.kind, manifest.id);
  }
  void file(const StoredFile& file) override { file_ = writer_ ? &writer_->file(file.name) : nullptr; }
  void bytes(std::string_view bytes) override {
    if (file_ != nullptr) file_->append(bytes);
  }
  void trial_end(const Manifest& manifest) override {
    (writer_ ? count.trials : count.present) += 1;
    if (writer_) writer_->commit_as(manifest);
    writer_.reset();
  }

  PackCount count;

 private:
  const Store& store_;
  std::string pack_;
  std::optional<TrialWriter> writer_;
  OutputFile* file_ = nullptr;
};

void add_trial(PackOutput& output, const StoredTrial& trial) {
  const std::string manifest = manifest_bytes(trial.manifest);
  output.add_length(static_cast<std::uint32_t>(manifest.size()));
  output.add(manifest);
  std::string piece(kPiece, '\0');
  for (const StoredFile& file : trial.manifest.files) {
    std::ifstream stream = trial.open(file.name);
    std::uint64_t size = 0;
    while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())), stream.gcount() > 0) {
      output.add({piece.data(), static_cast<std::size_t>(stream.gcount())});
      size += static_cast<std::uint64_t>(stream.gcount());
    }
    if (size != file.size) throw Error(cat((trial.folder / file.name).string(), ": changed while it was packed"));
  }
}

void read_pack_file(const fs::path& file, PackVisitor& visitor) {
  open_to_read(file);  // an Error where a stream would wait
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw file_error(file, "cannot read");
  read_pack(stream, file.string(), visitor);
}

}  // namespace

/// Whether a pack may be written there: over nothing else than a pack.
bool may_replace(const fs::path& file) {
  std::error_code unknown;
  const fs::file_status status = fs::status(file, unknown);
  if (!fs::is_regular_file(status)) return !fs::exists(status);
  std::ifstream stream(file, std::ios::binary);
  std::string magic(kMagic.size(), '\0');
  stream.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  return magic == kMagic;
}

PackCount pack_store(const Store& store, const fs::path& file, std::string_view only_kind, const DamageOf& damage_of) {
  if (!may_replace(file)) throw Error(cat(file.string(), ": exists and is no pack; choose another name"));
  PackCount count;
  PackOutput output(file);
  for (const auto& [kind, id] : store.trials()) {
    if (!only_kind.empty() && kind != only_kind) continue;
    std::optional<StoredTrial> trial = store.load(kind, id);
    const std::string damage = trial && damage_of ? damage_of(*trial) : "";
    if (!damage.empty()) store.condemn(*trial, damage);
    if (!damage.empty()) trial.reset();
    if (trial) add_trial(output, *trial);
    ++(trial ? count.trials : count.damaged);
  }
  output.add_length(0);
  count.bytes = output.finish();
  return count;
}

void check_pack(const fs::path& file) {
  PackVisitor heedless;
  read_pack_file(file, heedless);
}

PackCount unpack_store(const fs::path& file, const Store& store) {
  Unpacker unpacker(store, file.string());
  read_pack_file(file, unpacker);
  std::error_code unknown;
  unpacker.count.bytes = fs::file_size(file, unknown);
  return unpacker.count;
}

void read_pack(std::istream& stream, std::string_view name, PackVisitor& visitor) {
  std::string magic(kMagic.size(), '\0');
  stream.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  if (magic != kMagic) throw Error(cat(name, ": no pack of a gust store of format 1"));
  PackInput input(stream, name);
  while (const std::uint32_t length = input.length()) {
    if (length > kLongestManifest) throw input.damaged("a manifest is too long");
    const Manifest manifest = parse_manifest(input.exactly(length), name);
    visitor.trial(manifest);
    for (const StoredFile& file : manifest.files) {
      visitor.file(file);
      StreamHash hash;
      for (std::uint64_t left = file.size; left > 0;) {
        const std::string_view bytes = input.some(left);
        hash.add(bytes);
        visitor.bytes(bytes);
        left -= bytes.size();
      }
      if (hash.hex() != file.hash) throw input.damaged(cat(manifest.id, "/", file.name, ": its hash differs"));
    }
    visitor.trial_end(manifest);
  }
  input.finish();
}

}  // namespace gust
