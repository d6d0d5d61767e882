#include "gust/store/rows.h"

#include <xxhash.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "gust/core/error.h"
#include "gust/store/files_posix.h"

namespace gust {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kMagic = "gust rows 1\n";
constexpr std::size_t kMostNames = 1000;
constexpr std::size_t kLongestName = 200;
constexpr std::uint32_t kLongestHeader = 1 << 20;           // bytes of JSON
constexpr std::size_t kLargestCell = std::size_t{1} << 26;  // bytes
constexpr std::size_t kUsualBlock = std::size_t{1} << 18;   // bytes before compression, unless one cell has more
constexpr int kLevel = 3;                                   // of compression

/// What stands before each block.
struct BlockHead {
  std::uint32_t cells;
  std::uint32_t size;  // bytes, compressed
  std::uint64_t hash;  // 64-bit XXH3 of the compressed bytes
};

std::uint64_t hash_of(std::string_view bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

template <class T>
std::string_view bytes_of(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

std::size_t cells_per_block(const RowsHeader& header) {
  return std::max<std::size_t>(1, kUsualBlock / (header.cell_size() * sizeof(double)));
}

std::string header_bytes(const RowsHeader& header) {
  const Json json = {
      {"metrics", header.metrics}, {"starts", header.starts}, {"episodes", header.episodes}, {"cells", header.cells}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::vector<std::string> parse_names(const Json& json) {
  std::vector<std::string> names;
  if (!json.is_array()) return names;
  for (const Json& name : json) names.push_back(name.is_string() ? name.get<std::string>() : "");
  return names;
}

std::uint64_t parse_count(const Json& json) { return json.is_number_unsigned() ? json.get<std::uint64_t>() : 0; }

/// The numbers of whole cells, metric by metric, and of these all first bytes, all second bytes, and so on: what is
/// alike lies together, and compresses.
std::string shuffled(std::span<const double> block, std::size_t metrics) {
  std::string bytes(block.size_bytes(), '\0');
  const std::size_t rows = block.size() / metrics;
  for (std::size_t metric = 0; metric < metrics; ++metric) {
    char* plane = bytes.data() + metric * rows * sizeof(double);
    for (std::size_t row = 0; row < rows; ++row) {
      const auto value = std::bit_cast<std::array<char, sizeof(double)>>(block[row * metrics + metric]);
      for (std::size_t byte = 0; byte < value.size(); ++byte) plane[byte * rows + row] = value[byte];
    }
  }
  return bytes;
}

void unshuffle(std::string_view bytes, std::size_t metrics, std::span<double> block) {
  const std::size_t rows = block.size() / metrics;
  for (std::size_t metric = 0; metric < metrics; ++metric) {
    const char* plane = bytes.data() + metric * rows * sizeof(double);
    for (std::size_t row = 0; row < rows; ++row) {
      std::array<char, sizeof(double)> value;
      for (std::size_t byte = 0; byte < value.size(); ++byte) value[byte] = plane[byte * rows + row];
      block[row * metrics + metric] = std::bit_cast<double>(value);
    }
  }
}

/// Reads exactly this many bytes.
void read_exactly(std::istream& stream, std::span<char> bytes, std::string_view name) {
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (stream.bad()) throw FileError(cat(name, ": cannot read: the disk or the machine failed"), EIO);
  if (static_cast<std::size_t>(stream.gcount()) != bytes.size()) throw Error(cat(name, ": damaged rows: cut short"));
}

template <class T>
T read_value(std::istream& stream, std::string_view name) {
  std::array<char, sizeof(T)> bytes;
  read_exactly(stream, bytes, name);
  return std::bit_cast<T>(bytes);
}

RowsHeader read_header(std::istream& stream, std::string_view name) {
  std::string magic(kMagic.size(), '\0');
  read_exactly(stream, magic, name);
  if (magic != kMagic) throw Error(cat(name, ": no rows of a gust store of format 1"));
  const auto size = read_value<std::uint32_t>(stream, name);
  if (size > kLongestHeader) throw Error(cat(name, ": damaged rows: the header is too long"));
  std::string text(size, '\0');
  read_exactly(stream, text, name);
  if (read_value<std::uint64_t>(stream, name) != hash_of(text)) {
    throw Error(cat(name, ": damaged rows: the header's hash differs"));
  }
  const auto keep = [](int depth, Json::parse_event_t, Json&) { return depth <= 2; };
  const Json json = Json::parse(text, keep, /*allow_exceptions=*/false);
  if (!json.is_object()) throw Error(cat(name, ": damaged rows: the header is no JSON object"));
  RowsHeader header = {parse_names(json.value("metrics", Json())), parse_names(json.value("starts", Json())),
                       parse_count(json.value("episodes", Json())), parse_count(json.value("cells", Json()))};
  const std::string wrong = complaint(header);
  if (!wrong.empty()) throw Error(cat(name, ": damaged rows: ", wrong));
  return header;
}

/// The head of the next block, after so many cells.
BlockHead read_head(std::istream& stream, const RowsHeader& header, std::uint64_t read, std::string_view name) {
  const auto head = read_value<BlockHead>(stream, name);
  const std::uint64_t cells = std::min<std::uint64_t>(cells_per_block(header), header.cells - read);
  if (head.cells != cells) throw Error(cat(name, ": damaged rows: a block has ", head.cells, " cells, not ", cells));
  return head;
}

}  // namespace

std::optional<std::size_t> RowsHeader::column(std::string_view metric) const {
  const auto at = std::ranges::find(metrics, metric);
  if (at == metrics.end()) return std::nullopt;
  return static_cast<std::size_t>(at - metrics.begin());
}

std::string complaint(const RowsHeader& header) {
  const auto bad_list = [](const std::vector<std::string>& names) {
    const auto too_long = [](const std::string& name) { return name.size() > kLongestName; };
    return names.empty() || names.size() > kMostNames || std::ranges::any_of(names, too_long);
  };
  if (bad_list(header.metrics)) return "1 to 1000 metrics with names of at most 200 bytes are needed";
  if (bad_list(header.starts)) return "1 to 1000 starts with names of at most 200 bytes are needed";
  const std::size_t most = kLargestCell / sizeof(double) / header.starts.size() / header.metrics.size();
  if (header.episodes == 0 || header.episodes > most) {
    return cat("episodes must be 1 to ", most, " with ", header.starts.size(), " starts, got ", header.episodes);
  }
  return header.cells == 0 ? "at least one cell is needed" : "";
}

RowsWriter::RowsWriter(RowsHeader header, ByteSink sink) : header_(std::move(header)), sink_(std::move(sink)) {
  const std::string wrong = complaint(header_);
  if (!wrong.empty()) throw Error(cat("rows of a sweep: ", wrong));
  const std::string text = header_bytes(header_);
  sink_(kMagic);
  sink_(bytes_of(static_cast<std::uint32_t>(text.size())));
  sink_(text);
  sink_(bytes_of(hash_of(text)));
}

void RowsWriter::append_cell(std::span<const double> cell) {
  GUST_CHECK(cell.size() == header_.cell_size() && appended_ < header_.cells);
  block_.insert(block_.end(), cell.begin(), cell.end());
  ++appended_;
  if (block_.size() == cells_per_block(header_) * header_.cell_size()) write_block();
}

void RowsWriter::finish() {
  GUST_CHECK(appended_ == header_.cells);
  if (!block_.empty()) write_block();
}

void RowsWriter::write_block() {
  const std::string raw = shuffled(block_, header_.metrics.size());
  std::string packed(ZSTD_compressBound(raw.size()), '\0');
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), raw.data(), raw.size(), kLevel);
  GUST_CHECK(ZSTD_isError(size) == 0);
  packed.resize(size);
  const BlockHead head = {static_cast<std::uint32_t>(block_.size() / header_.cell_size()),
                          static_cast<std::uint32_t>(size), hash_of(packed)};
  sink_(bytes_of(head));
  sink_(packed);
  block_.clear();
}

RowsReader::RowsReader(std::istream& stream, std::string name)
    : stream_(stream), name_(std::move(name)), header_(read_header(stream_, name_)) {}

std::span<const double> RowsReader::next() {
  if (position_ == block_.size()) {
    if (read_ == header_.cells) return {};
    read_block();
  }
  const std::span<const double> cell = std::span(block_).subspan(position_, header_.cell_size());
  position_ += cell.size();
  return cell;
}

void RowsReader::read_block() {
  const BlockHead head = read_head(stream_, header_, read_, name_);
  const std::size_t numbers = std::size_t{head.cells} * header_.cell_size();
  if (head.size > ZSTD_compressBound(numbers * sizeof(double))) {
    throw Error(cat(name_, ": damaged rows: a block is too long"));
  }
  std::string packed(head.size, '\0');
  read_exactly(stream_, packed, name_);
  if (hash_of(packed) != head.hash) throw Error(cat(name_, ": damaged rows: a block's hash differs"));
  std::string raw(numbers * sizeof(double), '\0');
  const std::size_t size = ZSTD_decompress(raw.data(), raw.size(), packed.data(), packed.size());
  if (size != raw.size()) throw Error(cat(name_, ": damaged rows: a block has another size than its cells"));
  block_.resize(numbers);
  unshuffle(raw, header_.metrics.size(), block_);
  position_ = 0;
  read_ += head.cells;
  if (read_ == header_.cells && stream_.peek() != std::istream::traits_type::eof()) {
    throw Error(cat(name_, ": damaged rows: something follows the last cell"));
  }
}

RowsHeader skim_rows(std::istream& stream, std::string_view name) {
  stream.seekg(0, std::ios::end);
  const std::streamoff end = stream.tellg();
  stream.seekg(0);
  RowsHeader header = read_header(stream, name);
  for (std::uint64_t read = 0; read < header.cells;) {
    const BlockHead head = read_head(stream, header, read, name);
    if (head.size > end - stream.tellg()) throw Error(cat(name, ": damaged rows: cut short"));
    stream.seekg(head.size, std::ios::cur);
    read += head.cells;
  }
  if (stream.tellg() != end) throw Error(cat(name, ": damaged rows: something follows the last cell"));
  return header;
}

}  // namespace gust
