#include "gust/core/text.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "gust/core/error.h"

using namespace gust;

namespace {

const std::vector<std::string> kWaves = {"white", "uniform", "step", "sawtooth", "triangle", "sine"};

}  // namespace

TEST_CASE("the nearest name is the one with the fewest edits, if they are few enough to be meant") {
  CHECK(nearest("sawtoth", kWaves) == "sawtooth");
  CHECK(nearest("stepp", kWaves) == "step");
  CHECK(nearest("tirangle", kWaves) == "triangle");
  CHECK(nearest("sin", kWaves) == "sine");
  CHECK(nearest("gaussian", kWaves) == "");
  CHECK(nearest("x", std::vector<std::string>{"K", "T", "X"}) == "X");  // equal but for the case: the nearest
  CHECK(nearest("", kWaves) == "");
  CHECK(nearest("step", {}) == "");
}

TEST_CASE("a hint is a question, or nothing") {
  CHECK(did_you_mean("whit", kWaves) == "; did you mean 'white'?");
  CHECK(did_you_mean("zebra", kWaves) == "");
}

TEST_CASE("a name of a megabyte has no neighbour, and is not compared") {
  CHECK(nearest(std::string(1 << 20, 's'), kWaves) == "");
}

TEST_CASE("a NaN is printed without a sign") {
  const double minus_nan = std::copysign(std::numeric_limits<double>::quiet_NaN(), -1.0);
  const float narrow = static_cast<float>(minus_nan);

  CHECK(cat(minus_nan, " ", narrow, " ", -1.5) == "nan nan -1.5");
  CHECK(format("{:>6.3g}|{}|{:.2f}", minus_nan, narrow, -0.5) == "   nan|nan|-0.50");
}

TEST_CASE("join puts the separator between parts, and split undoes it") {
  CHECK(join({}, ", ") == "");
  CHECK(join(std::vector<std::string>{"a"}, ", ") == "a");
  CHECK(join(kWaves, "|") == "white|uniform|step|sawtooth|triangle|sine");
  CHECK(split_text("white|uniform|step|sawtooth|triangle|sine", '|') == kWaves);
  CHECK(split_text("", '|').empty());
  CHECK(split_text("|a", '|') == std::vector<std::string>{"", "a"});
}

TEST_CASE("text of numbers reads back to the same number in the fewest digits") {
  CHECK(cat(0.1) == "0.1");
  CHECK(cat(1.0 / 3) == "0.3333333333333333");
  CHECK(cat("a", 1, ' ', 2.5, " ", -0.0) == "a1 2.5 -0");
}

TEST_CASE("a slug keeps letters and digits") {
  CHECK(slug("PPO-DR high, 1.5 M") == "ppo-dr-high-1-5-m");
  CHECK(slug("  saturate before: ") == "saturate-before");
  CHECK(slug("action step", 8) == "action-s");
  CHECK(slug("…").empty());
}

TEST_CASE("a text becomes one word of a shell, quoted only where it must be") {
  CHECK(shell_word("studies/demo.toml") == "studies/demo.toml");
  CHECK(shell_word("action step") == "'action step'");
  CHECK(shell_word("") == "''");
  CHECK(shell_word("it's $HOME") == "'it'\\''s $HOME'");
}

TEST_CASE("text is wrapped at spaces, and only where it is too long") {
  CHECK(wrapped("one two three", 7) == "one two\nthree");
  CHECK(wrapped("one two three", 13) == "one two three");
  CHECK(wrapped("one two three", 12, 2) == "one two\n  three");
  CHECK(wrapped("a\n\nb c", 3) == "a\n\nb c");
}

TEST_CASE("a word that is longer than the line stays whole, and examples stay as they are") {
  CHECK(wrapped("incomprehensible it is", 6) == "incomprehensible\nit is");
  CHECK(wrapped("  gust eval lqr --plant cartpole", 10) == "  gust eval lqr --plant cartpole");
  CHECK(wrapped("", 10) == "");
}

TEST_CASE("wrapping counts letters, not bytes, and not the indent") {
  CHECK(text_width("θ ≥ 5") == 5);
  CHECK(wrapped("θ ≥ 5", 5) == "θ ≥ 5");
  CHECK(wrapped("aaa bbb cc dd", 7, 4) == "aaa bbb\n    cc dd");
}
