#include "gust/study/toml.h"

// The library asserts that a table header goes on with a key, and in the next lines reports the error if it does not:
// no assertions, and no assumptions in their place.
#undef NDEBUG
#define TOML_ASSERT(condition) static_cast<void>(0)
#define TOML_EXCEPTIONS 0
#define TOML_MAX_NESTED_VALUES 32
#include <toml++/toml.h>

#include <algorithm>

namespace gust {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 20;
constexpr std::size_t kMostDots = 32;   // in one key; the library builds a table a dot and frees them recursively
constexpr std::size_t kMostDepth = 32;  // of tables and lists

/// Finds keys of too many parts before the library does: it has no limit for them. Follows strings and comments, so
/// that only what may be a key is counted.
class KeyScan {
 public:
  KeyScan(std::string_view bytes, std::string_view name) : bytes_(bytes), name_(name) {}

  void run() {
    while (at_ < bytes_.size()) {
      const char letter = bytes_[at_];
      if (letter == '"' || letter == '\'') {
        skip_string(letter);
      } else if (letter == '#') {
        at_ = std::min(bytes_.find('\n', at_), bytes_.size());
      } else {
        count(letter);
        ++at_;
      }
    }
  }

 private:
  void count(char letter) {
    if (letter == '.') ++dots_;
    if (std::string_view("\n,=[]{}").find(letter) != std::string_view::npos) dots_ = 0;
    if (dots_ <= kMostDots) return;
    const auto line = static_cast<std::uint32_t>(std::count(bytes_.begin(), bytes_.begin() + at_, '\n') + 1);
    throw error_at({std::string(name_), line, 1}, "a key has more than ", kMostDots, " parts");
  }

  void skip_string(char quote) {
    const std::string three(3, quote);
    const bool long_string = bytes_.substr(at_, 3) == three;
    const std::string_view close = long_string ? std::string_view(three) : std::string_view(three).substr(2);
    at_ += close.size();
    while (at_ < bytes_.size() && bytes_.substr(at_, close.size()) != close) {
      if (!long_string && bytes_[at_] == '\n') return;  // never closed: the library says so
      at_ += quote == '"' && bytes_[at_] == '\\' ? 2 : 1;
    }
    at_ += close.size();
    for (int extra = 0; long_string && extra < 2 && at_ < bytes_.size() && bytes_[at_] == quote; ++extra) ++at_;
  }

  std::string_view bytes_;
  std::string_view name_;
  std::size_t at_ = 0;
  std::size_t dots_ = 0;
};

/// Turns the library's nodes into values.
class Converter {
 public:
  explicit Converter(std::string_view name) : name_(name) {}

  Table table(const toml::table& from, const Place& place, std::size_t depth) const {
    check_depth(place, depth);
    struct Item {
      const toml::key* key;
      const toml::node* node;
    };
    std::vector<Item> items;
    for (auto&& [key, node] : from) items.push_back({&key, &node});
    std::stable_sort(items.begin(), items.end(),
                     [](const Item& a, const Item& b) { return a.key->source().begin < b.key->source().begin; });
    Table to;
    to.place = place;
    for (const Item& item : items) {
      const Place fallback = place_of(item.key->source(), place);
      to.items.emplace_back(std::string(item.key->str()), value(*item.node, fallback, depth + 1));
    }
    return to;
  }

 private:
  Value value(const toml::node& node, const Place& fallback, std::size_t depth) const {
    const Place place = place_of(node.source(), fallback);
    switch (node.type()) {
      case toml::node_type::table:
        return {table(*node.as_table(), place, depth), place};
      case toml::node_type::array:
        return {list(*node.as_array(), place, depth), place};
      case toml::node_type::string:
        return {node.as_string()->get(), place};
      case toml::node_type::integer:
        return {node.as_integer()->get(), place};
      case toml::node_type::floating_point:
        return {node.as_floating_point()->get(), place};
      case toml::node_type::boolean:
        return {node.as_boolean()->get(), place};
      default:
        throw error_at(place, "dates and times mean nothing here; put it in quotes if text is meant");
    }
  }

  Value::List list(const toml::array& from, const Place& place, std::size_t depth) const {
    check_depth(place, depth);
    Value::List to;
    to.reserve(from.size());
    for (const toml::node& node : from) to.push_back(value(node, place, depth + 1));
    return to;
  }

  Place place_of(const toml::source_region& region, const Place& fallback) const {
    if (region.begin.line == 0) return fallback;
    return {std::string(name_), region.begin.line, region.begin.column};
  }

  static void check_depth(const Place& place, std::size_t depth) {
    if (depth > kMostDepth) throw error_at(place, "nested more than ", kMostDepth, " deep");
  }

  std::string_view name_;
};

/// The library's message in our form: "Error while parsing x: what" becomes "what".
std::string plain_message(std::string_view description) {
  constexpr std::string_view kPrefix = "Error while parsing ";
  const std::size_t colon = description.find(": ");
  if (description.substr(0, kPrefix.size()) != kPrefix || colon == std::string_view::npos)
    return std::string(description);
  return cat(description.substr(colon + 2), " (in ", description.substr(kPrefix.size(), colon - kPrefix.size()), ")");
}

}  // namespace

Table parse_toml(std::string_view bytes, std::string_view name) {
  const Place whole{std::string(name), 1, 1};
  if (bytes.size() > kMostBytes) {
    throw error_at({std::string(name)}, "has ", bytes.size(), " bytes; at most ", kMostBytes, " are read");
  }
  KeyScan(bytes, name).run();
  const toml::parse_result result = toml::parse(bytes);
  if (!result) {
    const toml::source_position at = result.error().source().begin;
    throw error_at({std::string(name), at.line, at.column}, plain_message(result.error().description()));
  }
  return Converter(name).table(result.table(), whole, 0);
}

}  // namespace gust
