#include "gust/paper/finding_words.h"

#include <algorithm>
#include <functional>

#include "gust/core/text.h"
#include "gust/paper/paper_checks.h"
#include "gust/study/text/parse.h"

namespace gust {
namespace {

struct Measurement {
  std::string name;
  std::vector<std::string> numbers;
  std::vector<std::string> facts;
};

const std::vector<Measurement>& measurements() {
  static const std::vector<Measurement> all = {
      {"trainings", {"trainings", "agents", "readings"}, {}},
      {"early failure", {"cells", "return_over_length", "return_over_horizon"}, {}},
      {"training noise",
       {"tested", "near", "other", "reading", "noisy_tested", "noisy_near", "clean_tested", "clean_near"},
       {"elsewhere", "reversed"}},
  };
  return all;
}

/// The text with each {name} replaced by what `value` gives for it.
std::string replaced(const std::string& text, const std::function<std::string(const std::string&)>& value) {
  std::string out;
  std::size_t at = 0;
  for (std::size_t open; (open = text.find('{', at)) != std::string::npos;) {
    const std::size_t close = text.find('}', open);
    if (close == std::string::npos) break;
    out += text.substr(at, open - at);
    out += value(text.substr(open + 1, close - open - 1));
    at = close + 1;
  }
  return out + text.substr(at);
}

/// Checks that words ask for known names alone.
void check_words(const Value& words, std::string_view key, const std::vector<std::string>& known) {
  const std::string& text = words.as_text(key);
  if (std::ranges::count(text, '{') != std::ranges::count(text, '}'))
    throw error_at(words.place, "'{' without '}' in '", key, "'");
  replaced(text, [&](const std::string& name) {
    check_known(known, {name, words.place}, "number of the measurement");
    return std::string();
  });
}

}  // namespace

PaperFinding parse_finding(const Table& table) {
  check_keys(table, {"measure", "says", "pieces"}, "a finding");
  PaperFinding finding{required_text(table, "measure", "a finding"), required_text(table, "says", "a finding"), {}};
  std::vector<std::string> names;
  for (const Measurement& known : measurements()) names.push_back(known.name);
  check_known(names, *table.find("measure"), "measurement");
  const Measurement& measurement = *std::ranges::find(measurements(), finding.measure, &Measurement::name);
  std::vector<std::string> known = measurement.numbers;
  if (const Value* pieces = table.find("pieces")) {
    for (const auto& [fact, words] : pieces->as_table("pieces").items) {
      check_known(measurement.facts, {fact, words.place}, "fact of the measurement");
      check_words(words, fact, measurement.numbers);
      finding.pieces[fact] = words.as_text(fact);
      known.push_back(fact);
    }
  }
  check_words(*table.find("says"), "says", known);
  return finding;
}

std::string filled(const PaperFinding& finding, const Measured& measured) {
  const auto number = [&](const std::string& name) { return measured.numbers.at(name); };
  return replaced(finding.says, [&](const std::string& name) {
    const auto piece = finding.pieces.find(name);
    if (piece == finding.pieces.end()) return number(name);
    return measured.facts.contains(name) ? replaced(piece->second, number) : std::string();
  });
}

}  // namespace gust
