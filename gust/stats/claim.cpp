#include "gust/stats/claim.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "gust/core/error.h"
#include "gust/core/text.h"

namespace gust {
namespace {

struct Sign {
  std::string_view text;
  Relation relation;
};

/// The longer one first where one begins with the other.
constexpr std::array<Sign, 4> kSigns = {{
    {">=", Relation::at_least},
    {">", Relation::above},
    {"<=", Relation::at_most},
    {"<", Relation::below},
}};

/// A claim's text and how far it has been read.
struct Reader {
  std::string_view text;
  const Place& place;
  std::size_t at = 0;

  std::string_view rest() const { return text.substr(at); }

  void skip_blanks() {
    while (at < text.size() && (text[at] == ' ' || text[at] == '\t')) ++at;
  }

  template <class... Parts>
  Error error(std::size_t where, const Parts&... parts) const {
    return error_at(place, "claim '", text, "', column ", where + 1, ": ", parts...);
  }
};

std::string read_metric(Reader& reader, std::span<const std::string> metrics) {
  const std::size_t begin = reader.at;
  const std::size_t length = std::min(reader.rest().find_first_of(" \t<>="), reader.rest().size());
  const std::string name(reader.rest().substr(0, length));
  if (name.empty()) throw reader.error(begin, "expected a metric, such as 'survival >= 0.95'");
  for (const std::string& metric : metrics) {
    if (metric != name) continue;
    reader.at += length;
    return name;
  }
  throw reader.error(begin, "unknown metric '", name, "'", did_you_mean(name, metrics));
}

Relation read_relation(Reader& reader) {
  for (const Sign& sign : kSigns) {
    if (!reader.rest().starts_with(sign.text)) continue;
    reader.at += sign.text.size();
    return sign.relation;
  }
  throw reader.error(reader.at, "expected >=, >, <= or <");
}

double read_bound(Reader& reader) {
  double bound = 0.0;
  const std::string_view rest = reader.rest();
  const auto [end, problem] = std::from_chars(rest.data(), rest.data() + rest.size(), bound);
  if (problem != std::errc() || !std::isfinite(bound)) throw reader.error(reader.at, "expected a finite number");
  reader.at += static_cast<std::size_t>(end - rest.data());
  return bound;
}

}  // namespace

std::string_view sign_of(Relation relation) {
  for (const Sign& sign : kSigns) {
    if (sign.relation == relation) return sign.text;
  }
  throw Bug("a relation without a sign");
}

std::string claim_text(const Claim& claim) { return cat(claim.metric, " ", sign_of(claim.relation), " ", claim.bound); }

Claim parse_claim(std::string_view text, std::span<const std::string> metrics, const Place& place) {
  Reader reader{text, place};
  Claim claim;
  reader.skip_blanks();
  claim.metric = read_metric(reader, metrics);
  reader.skip_blanks();
  claim.relation = read_relation(reader);
  reader.skip_blanks();
  claim.bound = read_bound(reader);
  reader.skip_blanks();
  if (!reader.rest().empty()) throw reader.error(reader.at, "expected nothing after the number");
  return claim;
}

}  // namespace gust
