#include "gust/control/recording_json.h"

#include <iterator>
#include <nlohmann/json.hpp>

#include "gust/core/text.h"

namespace gust {
namespace {

constexpr std::size_t kMostBytes = 256 * 1024;
constexpr std::size_t kMostDepth = 8;

/// An iterator over the bytes that tells how far the parser has read: the parser itself does not say.
struct Cursor {
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  const char* at;
  const char** read;

  const char& operator*() const { return *at; }
  Cursor& operator++() {
    *read = ++at;
    return *this;
  }
  Cursor operator++(int) {
    const Cursor before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const Cursor& a, const Cursor& b) { return a.at == b.at; }
  friend bool operator!=(const Cursor& a, const Cursor& b) { return a.at != b.at; }
};

/// Builds the table from what the parser finds, token by token.
class Builder {
 public:
  Builder(std::string_view bytes, const std::string& name)
      : bytes_(bytes), read_(bytes.data()), told_(bytes.data()), where_{name, 1, 1} {}

  Table build() {
    const Cursor begin{bytes_.data(), &read_};
    const Cursor end{bytes_.data() + bytes_.size(), &read_};
    nlohmann::json::sax_parse(begin, end, this);
    if (const Table* table = std::get_if<Table>(&root_.data)) return *table;
    throw error_at(Place{where_.name, 1, 1}, "must be a JSON object, { … }, got ", root_.type());
  }

  bool null() {
    const Place place = token();
    if (!open_.empty() && open_.back().is_list) throw error_at(place, "a list must not hold null");
    return true;
  }
  bool boolean(bool value) { return put({value, token()}); }
  bool number_integer(std::int64_t value) { return put({value, token()}); }
  bool number_unsigned(std::uint64_t value) {
    if (value <= INT64_MAX) return put({static_cast<std::int64_t>(value), token()});
    return put({static_cast<double>(value), token()});
  }
  bool number_float(double value, const std::string&) { return put({value, token()}); }
  bool string(std::string& value) { return put({std::move(value), token()}); }
  bool binary(std::vector<std::uint8_t>&) { return false; }  // JSON text has none
  bool start_object(std::size_t) { return start(false); }
  bool start_array(std::size_t) { return start(true); }
  bool end_object() { return end(); }
  bool end_array() { return end(); }

  bool key(std::string& key) {
    const Place place = token();
    Open& open = open_.back();
    if (open.table.contains(key)) throw error_at(place, "'", key, "' is there twice");
    open.key = std::move(key);
    return true;
  }

  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception& failure) {
    std::string_view text = failure.what();  // "[json.exception…] parse error at line 1, column 3: what it is"
    if (const auto at = text.find("column "); at != text.npos)
      text.remove_prefix(std::min(text.find(": ", at), text.size() - 2) + 2);
    throw error_at(token(), "not valid JSON: ", text);
  }

 private:
  struct Open {
    bool is_list;
    Table table;
    Value::List list;
    std::string key;
  };

  /// Where the token that was just read begins: after the blanks that follow the one before.
  Place token() {
    const char* const end = bytes_.data() + bytes_.size();
    while (told_ < end && std::string_view(" \t\r\n,:").find(*told_) != std::string_view::npos) step();
    const Place place = where_;
    while (told_ < std::min(read_, end)) step();
    return place;
  }

  void step() {
    const bool ends_line = *told_++ == '\n';
    where_.line += ends_line ? 1 : 0;
    where_.column = ends_line ? 1 : where_.column + 1;
  }

  bool start(bool is_list) {
    const Place place = token();
    if (open_.size() == kMostDepth) throw error_at(place, "nested deeper than ", kMostDepth, " levels");
    open_.push_back({is_list, Table{{}, place}, {}, {}});
    return true;
  }

  bool end() {
    token();
    Open done = std::move(open_.back());
    open_.pop_back();
    const Place place = done.table.place;
    return done.is_list ? put({std::move(done.list), place}) : put({std::move(done.table), place});
  }

  bool put(Value value) {
    if (open_.empty()) {
      root_ = std::move(value);
    } else if (open_.back().is_list) {
      open_.back().list.push_back(std::move(value));
    } else {
      open_.back().table.items.emplace_back(std::move(open_.back().key), std::move(value));
    }
    return true;
  }

  std::string_view bytes_;
  const char* read_;  // how far the parser has come
  const char* told_;  // the place up to here is known
  Place where_;
  std::vector<Open> open_;
  Value root_;
};

}  // namespace

Table read_json_table(std::string_view bytes, const std::string& name) {
  if (bytes.size() > kMostBytes) {
    throw Error(cat(name, ": ", bytes.size(), " bytes; a recording's description has at most ", kMostBytes));
  }
  return Builder(utf8_text(bytes, name), name).build();
}

}  // namespace gust
