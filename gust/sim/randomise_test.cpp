#include "gust/sim/randomise.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "gust/sim/plant.h"

using namespace gust;

namespace {

const Place kPlace{"test"};

Made<Plant> cartpole() { return plants().make({{{"kind", {std::string("cartpole"), kPlace}}}, kPlace}); }

Value number(double value) { return {value, kPlace}; }
Value text(const char* value) { return {std::string(value), kPlace}; }
Value table(std::vector<std::pair<std::string, Value>> items) { return {Table{std::move(items), kPlace}, kPlace}; }
Value range(double low, double high) { return table({{"low", number(low)}, {"high", number(high)}}); }

Randomisation read(std::vector<std::pair<std::string, Value>> items) {
  return read_randomisation({std::move(items), kPlace}, cartpole()->spec());
}

/// The values of pole_length in so many episodes.
std::vector<double> lengths(const Randomisation& randomisation, std::uint64_t episodes) {
  const auto plant = cartpole();
  std::vector<double> values;
  for (std::uint64_t i = 0; i < episodes; ++i)
    values.push_back(draw_parameters(randomisation.draws, plant->spec(), Rng(5).split(i))[0]);
  return values;
}

/// Kolmogorov and Smirnov's greatest distance between the draws and a distribution function.
template <class F>
double distance(std::vector<double> values, F&& cumulative) {
  std::ranges::sort(values);
  double greatest = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double below = static_cast<double>(i) / static_cast<double>(values.size());
    const double above = static_cast<double>(i + 1) / static_cast<double>(values.size());
    const double wanted = cumulative(values[i]);
    greatest = std::max({greatest, std::abs(wanted - below), std::abs(wanted - above)});
  }
  return greatest;
}

constexpr std::uint64_t kDraws = 20'000;
const double kCritical = 1.95 / std::sqrt(kDraws);  // exceeded by one right generator in a thousand

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

}  // namespace

TEST_CASE("8.8.1 draws lie in their range and are evenly spread over it") {
  const std::vector<double> values = lengths(read({{"pole_length", range(0.1, 1.0)}}), kDraws);

  CHECK(*std::ranges::min_element(values) >= 0.1);
  CHECK(*std::ranges::max_element(values) <= 1.0);
  CHECK(distance(values, [](double x) { return (x - 0.1) / 0.9; }) < kCritical);
}

TEST_CASE("8.8.1 additive draws of 0.1 to 1.0 about a nominal 0.5 lie in 0.6 to 1.5") {
  const std::vector<double> values =
      lengths(read({{"mode", text("additive")}, {"pole_length", range(0.1, 1.0)}}), kDraws);

  CHECK(*std::ranges::min_element(values) >= 0.6);
  CHECK(*std::ranges::max_element(values) <= 1.5);
  CHECK(distance(values, [](double x) { return (x - 0.6) / 0.9; }) < kCritical);
}

TEST_CASE("8.8.1 a range of one value is that value to the bit") {
  for (const double value : lengths(read({{"pole_length", range(0.7, 0.7)}}), 100)) CHECK(value == 0.7);
}

TEST_CASE("8.8.1 the other distributions are what they say") {
  const auto drawn = [](Value distribution) {
    return lengths(read({{"pole_length", std::move(distribution)}}), kDraws);
  };
  const auto log_uniform = drawn(table({{"kind", text("log_uniform")}, {"low", number(0.1)}, {"high", number(10)}}));
  CHECK(distance(log_uniform, [](double x) { return std::log10(x / 0.1) / 2; }) < kCritical);

  for (const double deviation : {0.2, 2.0}) {  // proposals of either kind
    const auto normal = drawn(table({{"kind", text("normal")},
                                     {"mean", number(0.6)},
                                     {"deviation", number(deviation)},
                                     {"low", number(0.5)},
                                     {"high", number(1.5)}}));
    const double low = normal_cdf((0.5 - 0.6) / deviation), high = normal_cdf((1.5 - 0.6) / deviation);
    CHECK(distance(normal, [&](double x) { return (normal_cdf((x - 0.6) / deviation) - low) / (high - low); }) <
          kCritical);
  }

  const Value values{Value::List{number(0.3), number(0.5), number(0.9)}, kPlace};
  const auto choice = drawn(table({{"kind", text("choice")}, {"values", values}}));
  for (const double value : {0.3, 0.5, 0.9}) {
    const double share = static_cast<double>(std::ranges::count(choice, value)) / kDraws;
    CHECK(std::abs(share - 1.0 / 3) < 0.012);  // 3.6 standard errors
  }
}

TEST_CASE("a parameter's draws do not depend on what else is drawn, and the rest is nominal") {
  const auto plant = cartpole();
  const Randomisation one = read({{"pole_length", range(0.1, 1.0)}});
  const Randomisation two = read({{"pole_length", range(0.1, 1.0)}, {"cart_mass", range(0.5, 2.0)}});

  const auto alone = draw_parameters(one.draws, plant->spec(), Rng(1));
  const auto both = draw_parameters(two.draws, plant->spec(), Rng(1));

  CHECK(alone[0] == both[0]);
  CHECK(alone[1] == 0.1);
  CHECK(alone[2] == 1.0);
  CHECK(both[2] != 1.0);
  CHECK(alone[0] != draw_parameters(one.draws, plant->spec(), Rng(2))[0]);
}

TEST_CASE("equal draws have one text, in whatever order they were written") {
  const PlantSpec spec = cartpole()->spec();
  const Randomisation a = read({{"cart_mass", range(0.5, 2)}, {"pole_length", range(0.1, 1)}});
  const Randomisation b = read({{"pole_length", range(0.1, 1)}, {"cart_mass", range(0.5, 2)}});

  CHECK(a.canonical(spec) == b.canonical(spec));
  CHECK(a.canonical(spec) ==
        "pole_length = 0 + uniform(low = 0.1, high = 1), cart_mass = 0 + uniform(low = 0.5, high = 2)");
  CHECK(Randomisation{}.canonical(spec).empty());
  CHECK(a.label(spec) == "pole_length, cart_mass");
}

TEST_CASE("ranges that cannot be are errors that say what would be right") {
  CHECK_THROWS_WITH_AS(read({{"pole_length", range(1.0, 0.1)}}), "test: 'low' must be at most 'high', got 1 and 0.1",
                       Error);
  CHECK_THROWS_WITH_AS(read({{"pole_length", range(0.0, 0.1)}}),
                       "test: 'pole_length' must stay > 0, got a least value of 0", Error);
  CHECK_THROWS_WITH_AS(read({{"mode", text("additive")}, {"pole_length", range(-0.5, 0.1)}}),
                       "test: 'pole_length' must stay > 0, got a least value of 0 (0.5 and the draw)", Error);
  CHECK_THROWS_WITH_AS(read({{"pole_lenght", range(0.1, 1.0)}}),
                       "test: unknown parameter 'pole_lenght'; did you mean 'pole_length'?; the plant has pole_length, "
                       "pole_mass, cart_mass",
                       Error);
  CHECK_THROWS_WITH_AS(read({{"mode", text("additiv")}, {"pole_length", range(0.1, 1)}}),
                       "test: 'mode' must be one of absolute, additive, got 'additiv'; did you mean 'additive'?",
                       Error);
  CHECK_THROWS_WITH_AS(read({{"pole_length", table({{"low", number(0.1)}})}}),
                       "test: 'pole_length' needs 'high': greatest value", Error);
  CHECK_THROWS_AS(read({{"pole_length", number(0.5)}}), Error);
  CHECK_THROWS_AS(read({{"mode", text("additive")}}), Error);
  CHECK_THROWS_AS(read({{"pole_length", table({{"kind", text("uniforme")}, {"low", number(1)}, {"high", number(2)}})}}),
                  Error);
  CHECK_NOTHROW(read({{"mode", text("additive")}, {"pole_length", range(-0.2, 0.2)}}));
}
