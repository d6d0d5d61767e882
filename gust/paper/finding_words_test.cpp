#include "gust/paper/finding_words.h"

#include <doctest/doctest.h>

#include "gust/setup/toml.h"

using namespace gust;

namespace {

PaperFinding words(std::string_view text) { return parse_finding(parse_toml(text, "findings.toml")); }

}  // namespace

TEST_CASE("a sentence has the numbers of its measurement, and the pieces that are so") {
  const PaperFinding finding = words(
      "measure = 'training noise'\nsays = '{tested}, {near}{elsewhere}{reversed}.'\n"
      "pieces = { elsewhere = '; under {reading}', reversed = ': the reverse' }\n");
  Measured measured{.numbers = {{"tested", "1 of 4"}, {"near", "3 of 4"}, {"reading", "main"}}, .facts = {}};

  CHECK(filled(finding, measured) == "1 of 4, 3 of 4.");
  measured.facts = {"elsewhere", "reversed"};
  CHECK(filled(finding, measured) == "1 of 4, 3 of 4; under main: the reverse.");
}

TEST_CASE("a number is not read again as words, and braces come in pairs") {
  CHECK_THROWS_WITH_AS(words("measure = 'trainings'\nsays = '{agents'\n"),
                       "findings.toml:2:8: '{' without '}' in 'says'", Error);
  CHECK(filled(words("measure = 'trainings'\nsays = '{agents}!'\n"),
               {.numbers = {{"agents", "{readings}"}}, .facts = {}}) == "{readings}!");
}

TEST_CASE("words that ask for what is not measured are an error at their place") {
  CHECK_THROWS_WITH_AS(words("measure = 'training noises'\nsays = 'x'\n"),
                       "findings.toml:1:11: unknown measurement 'training noises'; did you mean 'training noise'?",
                       Error);
  CHECK_THROWS_WITH_AS(words("measure = 'trainings'\nsays = '{agent}'\n"),
                       "findings.toml:2:8: unknown number of the measurement 'agent'; did you mean 'agents'?", Error);
  CHECK_THROWS_WITH_AS(words("measure = 'training noise'\nsays = '{near}{reversed}'\n"),
                       doctest::Contains("unknown number of the measurement 'reversed'"), Error);  // no such piece
  CHECK_THROWS_WITH_AS(words("measure = 'training noise'\nsays = 'x'\npieces = { revered = 'y' }\n"),
                       doctest::Contains("unknown fact of the measurement 'revered'; did you mean 'reversed'?"), Error);
}
