#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

#include "gust/core/error.h"
#include "gust/stats/compare.h"

namespace gust {
namespace {

/// How scores of simulated policies vary, as standard deviations.
struct Spread {
  double seeds = 0;     ///< of a policy's trainings
  double luck = 0;      ///< of the episodes, which both policies share
  double own_luck = 0;  ///< of the episodes for one policy
  double rest = 0;
};

struct Policies {
  std::size_t seeds_a = 1, seeds_b = 1, episodes = 10;
};

std::vector<double> scores(double mean, const Spread& spread, std::size_t seeds, std::size_t episodes,
                           const Rng& common, const Rng& own) {
  std::vector<double> values;
  const double by_seeds = seeds > 1 ? spread.seeds : 0.0;  // a policy that is one alone is what it is
  for (std::size_t s = 0; s < seeds; ++s) {
    for (std::size_t e = 0; e < episodes; ++e) {
      values.push_back(mean + by_seeds * own.split("seeds").normal(s) + spread.luck * common.normal(e) +
                       spread.own_luck * own.split("luck").normal(e) +
                       spread.rest * own.split("rest").split(s).normal(e));
    }
  }
  return values;
}

/// The difference at a level where a is `apart` better than b on average.
PairedDifference simulated(double apart, const Spread& spread, const Policies& policies, const Rng& rng) {
  const std::array levels = {0.0};
  const auto a = scores(0.5 + apart, spread, policies.seeds_a, policies.episodes, rng.split("luck"), rng.split("a"));
  const auto b = scores(0.5, spread, policies.seeds_b, policies.episodes, rng.split("luck"), rng.split("b"));
  const std::array cell_a = {cell_of(a, policies.seeds_a)}, cell_b = {cell_of(b, policies.seeds_b)};
  return compare({levels, cell_a}, {levels, cell_b}, rng.split("draws")).scores.front();
}

constexpr std::size_t kStudies = 300;

double coverage(const Spread& spread, const Policies& policies) {
  std::size_t covered = 0;
  for (std::size_t study = 0; study < kStudies; ++study) {
    const Interval found = simulated(0.25, spread, policies, Rng(study)).interval;
    covered += found.low <= 0.25 && 0.25 <= found.high ? 1 : 0;
  }
  return static_cast<double>(covered) / kStudies;
}

double share_decided(double apart, const Spread& spread, const Policies& policies) {
  std::size_t decided = 0;
  for (std::size_t study = 0; study < kStudies; ++study)
    decided += standing(simulated(apart, spread, policies, Rng(study)).interval) == Standing::ahead ? 1 : 0;
  return static_cast<double>(decided) / kStudies;
}

/// A curve with one seed and as many episodes as there are heads: each falls in a straight line to 0 at its head.
struct Falling {
  std::vector<double> levels;
  std::vector<std::vector<double>> values;
  std::vector<Cell> cells;

  Falling(std::vector<double> at, const std::vector<double>& ends) : levels(std::move(at)) {
    for (const double level : levels) {
      std::vector<double>& row = values.emplace_back();
      for (const double end : ends) row.push_back(1.0 - level / end);
    }
    for (const auto& row : values) cells.push_back(cell_of(row, 1));
  }
  Curve curve() const { return {levels, cells}; }
};

TEST_CASE("a paired difference covers the truth 95 % of the time, with few units and many, alone and with seeds") {
  const double three = 3 * std::sqrt(0.95 * 0.05 / kStudies);  // standard errors of the simulation
  const std::pair<Spread, Policies> cases[] = {
      {{.luck = 1.0, .own_luck = 0.2}, {1, 1, 5}},
      {{.luck = 1.0, .own_luck = 0.2}, {1, 1, 25}},
      {{.seeds = 0.3, .luck = 1.0, .own_luck = 0.05}, {5, 5, 25}},
      {{.seeds = 0.3, .luck = 1.0, .own_luck = 0.3, .rest = 0.3}, {10, 10, 10}},
      {{.seeds = 0.3, .luck = 1.0, .own_luck = 0.3}, {5, 1, 10}},
      {{.seeds = 0.1, .luck = 1.0, .own_luck = 0.6}, {30, 10, 10}},
  };
  for (const auto& [spread, policies] : cases) {
    CAPTURE(policies.seeds_a);
    CAPTURE(policies.episodes);
    const double covered = coverage(spread, policies);
    MESSAGE(policies.seeds_a, " ", policies.seeds_b, " ", policies.episodes, ": ", covered);
    CHECK(covered >= 0.95 - three);
  }
}

TEST_CASE("pairing decides where the intervals of the two policies overlap by far") {
  const Spread spread{.luck = 1.0, .own_luck = 0.05};

  CHECK(share_decided(0.1, spread, {1, 1, 10}) > 0.95);  // either alone is known to 0.7
}

TEST_CASE("a constant difference has no width, however different the episodes are") {
  const std::array levels = {0.0};
  const std::vector<double> b = {0.0, 8.0, 2.0, 32.0, -4.0, 64.0};
  std::vector<double> a;
  for (const double value : b) a.push_back(value + 0.5);
  const std::array cell_a = {cell_of(a, 1)}, cell_b = {cell_of(b, 1)};

  const PairedDifference found = compare({levels, cell_a}, {levels, cell_b}, Rng(4)).scores.front();

  CHECK(found.interval.estimate == 0.5);
  CHECK(found.interval.low == 0.5);
  CHECK(found.interval.high == 0.5);
  CHECK(found.unit == Unit::episodes);
  CHECK(standing(found.interval) == Standing::ahead);
}

TEST_CASE("with as many episodes or seeds as it says about half of all studies are decided, with twice as many most") {
  const auto check = [](const Spread& spread, Policies policies, auto set) {
    double needed = 0;
    for (std::size_t study = 0; study < kStudies; ++study) {
      const PairedDifference found = simulated(0.1, spread, policies, Rng(study));
      const double factor = found.interval.estimate / 0.1;  // the distance as it is, not as this study sees it
      if (found.needed > 1.0 && std::isfinite(found.needed))
        needed += found.needed * factor * factor / kStudies;
      else
        needed += static_cast<double>(found.interval.n) / kStudies;
    }
    set(policies, static_cast<std::size_t>(needed));
    const double half = share_decided(0.1, spread, policies);
    set(policies, static_cast<std::size_t>(2 * needed));
    const double most = share_decided(0.1, spread, policies);
    MESSAGE(needed, ": ", half, ", ", most);
    CHECK(half > 0.3);
    CHECK(half < 0.85);
    CHECK(most > 0.75);
  };
  check({.luck = 1.0, .own_luck = 0.3}, {1, 1, 10}, [](Policies& p, std::size_t n) { p.episodes = n; });
  check({.seeds = 0.2, .luck = 1.0, .own_luck = 0.01}, {10, 1, 10}, [](Policies& p, std::size_t n) { p.seeds_a = n; });
}

TEST_CASE("the ratio of margins is known where levels end or begin, as far as it can be") {
  const Falling strong({0, 1, 2, 4, 8}, {40, 42, 38, 40}), weak({0, 0.5, 1, 2, 4, 6}, {10, 10.5, 9.5, 10});
  const Falling beyond({0, 1}, {40, 42, 38, 40}), late({2, 4, 6}, {10, 10.5, 9.5, 10});
  const std::vector<double> whole(4, 1.0);
  const auto ratio = [&](const Falling& a, const Falling& b, const MarginRule& rule) {
    return margin_ratio({a.curve(), cell_of(whole, 1)}, {b.curve(), cell_of(whole, 1)}, rule, Rng(1));
  };

  const Comparison found = compare(strong.curve(), weak.curve(), Rng(1));
  const Interval exact = ratio(strong, weak, {});
  const Interval open = ratio(beyond, weak, {.fraction = 0.95}), closed = ratio(weak, beyond, {.fraction = 0.95});
  const Interval both = ratio(beyond, beyond, {}), before = ratio(late, weak, {});

  CHECK(found.levels == std::vector<double>{0, 1, 2, 4});
  CHECK(found.over.interval.estimate == doctest::Approx(4.0 / 2 * (1 / 9.98 - 1 / 39.95)).epsilon(0.01));
  CHECK(std::isnan(found.ratio.estimate));
  CHECK(exact.estimate == doctest::Approx(4.0).epsilon(0.002));  // 4 against 1, harmonic means of the ends
  CHECK(exact.low > 3.5);
  CHECK(exact.high < 4.5);
  CHECK(exact.unit == Unit::episodes);
  CHECK(exact.n == 4);
  CHECK(open.estimate == doctest::Approx(2.0).epsilon(0.01));  // at least 1 against 0.5
  CHECK(std::isinf(open.most));
  CHECK(open.low > 1.5);
  CHECK(std::isinf(open.high));
  CHECK(closed.low == 0.0);
  CHECK(closed.high < 0.6);
  CHECK(closed.most == doctest::Approx(0.5).epsilon(0.01));
  CHECK(both.low == 0.0);
  CHECK(std::isinf(both.high));
  CHECK(before.estimate == 0.0);  // the first level, 2, has lost a fifth
  CHECK(before.most == doctest::Approx(2.0).epsilon(0.01));
}

TEST_CASE("a ratio of margins falls from the undisturbed scores, not from the first ones of the curve") {
  const Falling worn({0, 1, 2, 4, 8}, {40, 42, 38, 40});
  const std::vector<double> whole(4, 1.0), more(4, 1.05);
  const MarginCells from_one{worn.curve(), cell_of(whole, 1)}, from_more{worn.curve(), cell_of(more, 1)};

  const Interval found = margin_ratio(from_more, from_one, {}, Rng(1));

  CHECK(found.estimate == doctest::Approx((1 - 0.9 * 1.05) / (1 - 0.9)).epsilon(1e-9));  // of one straight line
  CHECK(std::isnan(margin_ratio({worn.curve(), cell_of(std::vector(4, 2.0), 1)},
                                {worn.curve(), cell_of(std::vector(4, 2.0), 1)}, {}, Rng(1))
                       .estimate));  // 0 / 0
}

/// How often the interval of a ratio that is 1 holds 1, of policies whose seeds fall one by one or all alike.
double ratio_coverage(std::size_t seeds, bool steps) {
  std::vector<double> levels = {0};
  for (double level = 0.02; level < 4; level *= 1.02) levels.push_back(level);
  std::size_t covered = 0;
  const auto make = [&](const Rng& rng, std::vector<std::vector<double>>& values) {
    for (const double level : levels) {
      std::vector<double>& row = values.emplace_back();
      for (std::size_t s = 0; s < seeds; ++s) {
        const double falls = std::exp(0.4 * rng.normal(s));
        row.push_back(steps ? (level < falls ? 1.0 : 0.0) : std::max(0.0, 1.0 - 0.2 * level / falls));
      }
    }
    std::vector<Cell> cells;
    for (const auto& row : values) cells.push_back(cell_of(row, seeds));
    return cells;
  };
  for (std::size_t study = 0; study < kStudies; ++study) {
    std::vector<std::vector<double>> values_a, values_b;
    const std::vector<Cell> a = make(Rng(study).split("a"), values_a), b = make(Rng(study).split("b"), values_b);
    const Interval found = margin_ratio({{levels, a}, a.front()}, {{levels, b}, b.front()}, {}, Rng(study).split("c"));
    covered += found.low <= 1 && 1 <= found.high ? 1 : 0;
  }
  return static_cast<double>(covered) / kStudies;
}

TEST_CASE("the interval of a ratio of margins covers the truth, also of seeds that fall one by one") {
  for (const std::size_t seeds : {5, 10, 30}) {
    for (const bool steps : {false, true}) {
      const double share = ratio_coverage(seeds, steps);
      MESSAGE(seeds, " seeds, ", steps ? "steps: " : "lines: ", share);
      CHECK(share > 0.93);
    }
  }
}

TEST_CASE(
    "the probability of improvement is over pairs of seeds or over common episodes, with Wilson's width at least") {
  const std::array levels = {0.0};
  const std::vector<double> a = {1, 11, 21, 31, 41, 51, 61, 71}, b = {0, 10, 20, 30, 40, 50, 60, 70};
  const std::array a_alone = {cell_of(a, 1)}, b_alone = {cell_of(b, 1)}, a_seeds = {cell_of(a, 4)},
                   b_seeds = {cell_of(b, 2)};

  const Interval alone = compare({levels, a_alone}, {levels, b_alone}, Rng(1)).improvement;
  const Interval same = compare({levels, a_alone}, {levels, a_alone}, Rng(1)).improvement;

  CHECK(alone.estimate == 1.0);  // in each episode, though values overlap
  CHECK(alone.low == doctest::Approx(8 / (8 + 1.959964 * 1.959964)).epsilon(1e-6));
  CHECK(alone.unit == Unit::episodes);
  CHECK(same.estimate == 0.5);
  CHECK_THROWS_AS(compare({levels, a_seeds}, {levels, b_seeds}, Rng(1)), Bug);  // other episodes

  const std::vector<double> five = {0, 1, 2, 3, 4}, two = {1.5, 3};
  const std::array x = {cell_of(five, 5)}, y = {cell_of(two, 2)};
  const Interval seeds = compare({levels, x}, {levels, y}, Rng(1)).improvement;
  CHECK(seeds.estimate == probability_of_improvement(five, two));
  CHECK(seeds.unit == Unit::seeds);
  CHECK(seeds.n == 2);
}

TEST_CASE("one value each gives no interval, and what is not finite counts as 0") {
  const std::array levels = {0.0};
  const std::vector<double> one = {std::nan("")}, other = {0.5};
  const std::array a = {cell_of(one, 1)}, b = {cell_of(other, 1)};

  const Comparison found = compare({levels, a}, {levels, b}, Rng(1));

  CHECK(found.scores[0].interval.estimate == -0.5);
  CHECK(std::isnan(found.scores[0].interval.low));
  CHECK(found.scores[0].unit == Unit::none);
  CHECK(standing(found.scores[0].interval) == Standing::undecided);
}

}  // namespace
}  // namespace gust
