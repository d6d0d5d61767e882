#include <xxhash.h>
#include <zstd.h>

#include <cstdint>
#include <exception>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>

#include "gust/core/error.h"
#include "gust/core/hash.h"
#include "gust/store/pack.h"
#include "gust/store/rows.h"

namespace {

/// A length, a count or a hash as it stands in a file.
template <class T>
std::string raw(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

std::string compressed(std::string_view bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 1));
  return out;
}

/// Takes the first line off the front of the input.
std::string_view take_line(std::string_view& input) {
  const std::string_view line = input.substr(0, input.find('\n'));
  input.remove_prefix(std::min(input.size(), line.size() + 1));
  return line;
}

/// A manifest with its hash put right, which random bytes would never have.
std::string sealed_manifest(std::string_view text) {
  const auto flat = [](int depth, nlohmann::json::parse_event_t, nlohmann::json&) { return depth <= 4; };
  auto json = nlohmann::json::parse(text, flat, /*allow_exceptions=*/false);
  if (!json.is_object()) return std::string(text);
  const auto dump = [&] { return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace); };
  json.erase("hash");
  json["hash"] = gust::hash_hex(dump());
  return dump();
}

/// A rows file of one block with its hashes put right; the first line is the header, the rest the block.
std::string sealed_rows(std::string_view input, bool compress) {
  const std::string_view header = take_line(input);
  const std::uint32_t cells = input.empty() ? 0 : static_cast<unsigned char>(input.front());
  const std::string block = compress ? compressed(input.substr(std::min<std::size_t>(1, input.size())))
                                     : std::string(input.substr(std::min<std::size_t>(1, input.size())));
  return "gust rows 1\n" + raw(static_cast<std::uint32_t>(header.size())) + std::string(header) +
         raw(XXH3_64bits(header.data(), header.size())) + raw(cells) + raw(static_cast<std::uint32_t>(block.size())) +
         raw(XXH3_64bits(block.data(), block.size())) + block;
}

/// A pack of one trial: the first line is its manifest, the rest the content of its files.
std::string sealed_pack(std::string_view input) {
  const std::string manifest = sealed_manifest(take_line(input));
  return "gust pack 1\n" + compressed(raw(static_cast<std::uint32_t>(manifest.size())) + manifest + std::string(input) +
                                      raw(std::uint32_t{0}));
}

void read_rows(const std::string& bytes) {
  constexpr std::size_t kEnough = 1 << 20;  // numbers; what comes after them is read in the same way
  std::istringstream stream(bytes);
  gust::RowsReader reader(stream, "fuzz");
  std::size_t numbers = 0;
  while (numbers < kEnough) {
    const std::span<const double> cell = reader.next();
    if (cell.empty()) return;
    if (cell.size() != reader.header().cell_size()) std::terminate();
    numbers += cell.size();
  }
}

/// Checks that a pack keeps what it promises.
struct Watcher : gust::PackVisitor {
  void trial(const gust::Manifest& manifest) override {
    if (!gust::valid_store_kind(manifest.kind) || !gust::valid_store_name(manifest.id)) std::terminate();
  }
  void file(const gust::StoredFile& file) override {
    if (!gust::valid_store_name(file.name)) std::terminate();
    left = file.size;
  }
  void bytes(std::string_view bytes) override {
    if (bytes.size() > left) std::terminate();
    left -= bytes.size();
  }
  void trial_end(const gust::Manifest&) override {
    if (left != 0) std::terminate();
  }
  std::uint64_t left = 0;
};

void read_one_pack(const std::string& bytes) {
  std::istringstream stream(bytes);
  Watcher watcher;
  gust::read_pack(stream, "fuzz", watcher);
}

}  // namespace

/// Input: a letter that says which reader, then its bytes. Small letters are read as they are; for large ones the
/// hashes are put right first, so that what lies behind them is reached too. Reading gives a result or one Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    switch (data[0]) {
      case 'm':
        gust::parse_manifest(rest, "fuzz");
        break;
      case 'M':
        gust::parse_manifest(sealed_manifest(rest), "fuzz");
        break;
      case 'r':
        read_rows(rest);
        break;
      case 'R':
        read_rows(sealed_rows(rest, /*compress=*/true));
        break;
      case 'B':
        read_rows(sealed_rows(rest, /*compress=*/false));
        break;
      case 'p':
        read_one_pack(rest);
        break;
      case 'P':
        read_one_pack(sealed_pack(rest));
        break;
      default:
        break;
    }
  } catch (const gust::Error&) {
  }
  return 0;
}
