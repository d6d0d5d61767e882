#include "gust/stats/sampled_share.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "gust/stats/bootstrap.h"
#include "gust/stats/share.h"

namespace gust {
namespace {

constexpr std::size_t kResamples = 400;

/// Episodes by cells: 1 for a success. Resampled with whole episodes, as claims do it.
struct Outcomes {
  std::vector<std::vector<double>> cells;

  std::vector<Sampled> shares(std::uint64_t seed) const {
    const std::size_t n = cells.front().size();
    const Rng rng(seed);
    std::vector<Sampled> shares(cells.size(), Sampled{std::vector<double>(1 + kResamples)});
    std::vector<std::size_t> drawn(n);
    for (std::size_t k = 0; k <= kResamples; ++k) {
      for (std::size_t e = 0; e < n; ++e) drawn[e] = k == 0 ? e : rng.split(k).below(n, e);
      for (std::size_t c = 0; c < cells.size(); ++c) {
        double sum = 0;
        for (const std::size_t e : drawn) sum += cells[c][e];
        shares[c].values[k] = sum / static_cast<double>(n);
      }
    }
    for (std::size_t c = 0; c < cells.size(); ++c) {
      shares[c].unit = Unit::episodes;
      shares[c].n = n;
      shares[c] = sampled_share(shares[c], n, rng.split("together"), rng.split("alone").split(c));
    }
    return shares;
  }
};

/// The share of 400 simulated studies whose interval holds the truth.
template <class Draw, class Value>
double coverage(double truth, Draw draw, Value value) {
  constexpr std::size_t kStudies = 400;
  std::size_t covered = 0;
  for (std::uint64_t study = 0; study < kStudies; ++study) {
    const Interval found = interval_of(value(draw(Rng(study).split("draw")).shares(study)));
    covered += found.low <= truth && truth <= found.high ? 1 : 0;
  }
  return static_cast<double>(covered) / kStudies;
}

Sampled difference(const std::vector<Sampled>& shares) { return combine(shares[0], shares[1], std::minus<>()); }
Sampled average(const std::vector<Sampled>& shares) {
  return combine_rising(shares, [](std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  });
}

/// Cells of which the first succeeds with probability p; the others differ from it in a share of the episodes.
Outcomes alike_cells(const Rng& rng, std::size_t n, std::size_t cells, double p, double differ) {
  Outcomes outcomes{std::vector(cells, std::vector<double>(n))};
  for (std::size_t e = 0; e < n; ++e) {
    for (std::size_t c = 0; c < cells; ++c) {
      const bool own = c > 0 && rng.split("own").split(c).uniform(e) < differ;
      const double uniform = own ? rng.split("fresh").split(c).uniform(e) : rng.uniform(e);
      outcomes.cells[c][e] = uniform < p ? 1.0 : 0.0;
    }
  }
  return outcomes;
}

TEST_CASE("the interval of a sampled share is Wilson's, for any share and number of trials") {
  for (const std::size_t n : {2u, 10u, 25u, 200u}) {
    for (const std::size_t successes : {std::size_t{0}, std::size_t{1}, n / 2, n}) {
      Outcomes outcomes{{std::vector<double>(n)}};
      std::fill_n(outcomes.cells[0].begin(), successes, 1.0);

      const Interval found = interval_of(outcomes.shares(7)[0]);

      const Interval expected = wilson(successes, n);
      CHECK(found.estimate == expected.estimate);
      CHECK(found.low == doctest::Approx(expected.low).epsilon(1e-3));  // between two of 400 quantiles
      CHECK(found.high == doctest::Approx(expected.high).epsilon(1e-3));
    }
  }
}

TEST_CASE("over seeds the interval holds the bootstrap's too") {
  Sampled share{std::vector<double>(1 + kResamples)};
  for (std::size_t k = 1; k <= kResamples; ++k) share.values[k] = k % 2 == 0 ? 0.2 : 0.8;
  share.values[0] = 0.5;
  share.unit = Unit::seeds;

  const Interval found = interval_of(sampled_share(share, 1000, Rng(1), Rng(2)));

  CHECK(found.low == 0.2);
  CHECK(found.high == 0.8);
}

TEST_CASE("what is computed from shares covers the truth near the boundary, where resamples have no width") {
  for (const double p : {0.8, 0.95, 0.99}) {
    for (const std::size_t n : {10u, 50u}) {
      CAPTURE(p);
      CAPTURE(n);
      const auto alone = [&](const Rng& rng) { return alike_cells(rng, n, 2, p, 1.0); };
      const auto paired = [&](const Rng& rng) { return alike_cells(rng, n, 2, p, 0.1); };
      const auto same = [&](const Rng& rng) { return alike_cells(rng, n, 8, p, 0.0); };
      const auto mixed = [&](const Rng& rng) { return alike_cells(rng, n, 8, p, 0.5); };
      const double single = coverage(p, alone, [](const auto& shares) { return shares[0]; });
      const double apart = coverage(0.0, alone, difference), near = coverage(0.0, paired, difference);
      const double one = coverage(p, same, average), half = coverage(p, mixed, average);
      for (const double found : {apart, near}) CHECK(found >= 0.9);
      // Wilson's interval itself covers 0.904 of p = 0.99 with n = 10, whose 9 successes leave it out; 400 studies.
      for (const double found : {single, one, half}) CHECK(found >= 0.87);
    }
  }
}

}  // namespace
}  // namespace gust
