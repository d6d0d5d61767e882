#include "gust/nn/squashed_gaussian.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

#include "gust/core/rng.h"

using namespace gust;

namespace {

struct Law {
  double mean;
  double std;
};

struct Drawn {
  std::vector<double> action;
  std::vector<double> log_density;
};

/// One action between -1 and 1 for each noise.
Drawn draw(Law law, const std::vector<double>& noise) {
  const std::array unit = {0.0f, 1.0f};
  const std::vector<double> mean(noise.size(), law.mean), log_std(noise.size(), std::log(law.std));
  Drawn drawn{std::vector<double>(noise.size()), std::vector<double>(noise.size())};
  squashed_sample<double>({mean, log_std, std::span(unit).first(1), std::span(unit).last(1)}, noise,
                          {drawn.action, drawn.log_density});
  return drawn;
}

/// Sums f(density) times the length of action around each of many noises.
template <class F>
double integral(Law law, F&& f) {
  std::vector<double> noise(60'001);
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = 3e-4 * (static_cast<double>(i) - 30'000.0);
  const Drawn drawn = draw(law, noise);
  double sum = 0.0;
  for (std::size_t i = 1; i + 1 < noise.size(); ++i)
    sum += f(drawn.log_density[i]) * 0.5 * (drawn.action[i + 1] - drawn.action[i - 1]);
  return sum;
}

}  // namespace

TEST_CASE("8.4.1 the density of the squashed Gaussian integrates to one over the actions") {
  for (const Law law : {Law{0, 1}, Law{1, 0.3}, Law{2, 2}, Law{0, 0.05}})
    CHECK(std::abs(integral(law, [](double density) { return std::exp(density); }) - 1.0) < 1e-6);
}

TEST_CASE("8.4.2 the entropy of the squashed Gaussian has its known values, by quadrature and by sampling") {
  const std::array<std::pair<Law, double>, 5> known = {{{{0, 1}, 0.669804},
                                                        {{0, 0.5}, 0.499967},
                                                        {{1, 0.3}, -0.691491},
                                                        {{2, 2}, -1.365922},
                                                        {{0, std::exp(-0.5)}, 0.598904}}};
  std::vector<double> noise(1'000'000);
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = Rng(5).normal(i);

  for (const auto& [law, entropy] : known) {
    CHECK(std::abs(integral(law, [](double density) { return -density * std::exp(density); }) - entropy) < 1e-6);
    double mean = 0.0, square = 0.0;
    for (const double density : draw(law, noise).log_density) {
      mean -= density / 1e6;
      square += density * density / 1e6;
    }
    // A million samples of (2, 2), whose -log pi has a deviation of 2.74, are themselves uncertain by 0.0027.
    const double uncertain = std::sqrt((square - mean * mean) / 1e6);
    CHECK(std::abs(mean - entropy) < std::max(0.004, 3 * uncertain));
  }
  double highest = 0.0;
  for (double std = 0.6; std < 1.2; std += 0.01)
    highest = std::max(highest, integral({0, std}, [](double density) { return -density * std::exp(density); }));
  CHECK(std::abs(highest - 0.6836) < 1e-3);
}

TEST_CASE("8.4.3 the log density stays finite and exact where tanh is one") {
  const std::array centre = {0.0f}, half_width = {1.0f};
  for (float u = -50.0f; u <= 50.0f; u += 0.5f) {
    const std::array<float, 1> mean = {u}, log_std = {0.0f}, noise = {0.0f};
    std::array<float, 1> action, density;
    squashed_sample<float>({mean, log_std, centre, half_width}, noise, {action, density});

    const long double size = std::abs(static_cast<long double>(u));  // ln(1 - tanh^2 u), in extended precision
    const long double slope = 2 * (std::log(2.0L) - size - std::log1p(std::exp(-2 * size)));
    const double expected = static_cast<double>(-0.5L * std::log(2 * 3.14159265358979323846L) - slope);
    CHECK(std::isfinite(density[0]));
    CHECK(std::abs(density[0] - expected) < 1e-4 * std::max(1.0, std::abs(expected)));
  }
}

TEST_CASE("8.1.1 finite differences confirm the gradient of the squashed Gaussian, and the clamp has none") {
  constexpr std::size_t kLanes = 3;
  const std::array<float, 2> centre = {1.0f, 0.0f}, half_width = {10.0f, 0.5f};
  std::array<double, 6> mean = {0.3, -1.5, 4.0, 0.0, 0.2, -0.7};
  std::array<double, 6> log_std = {-0.5, 0.3, -2.0, 1.9, 2.5, -21.0};  // the last two are beyond the clamp
  const std::array<double, 6> noise = {0.5, -1.0, 0.2, 0.0, 1.4, -0.3};
  const std::array<double, 6> at_action = {0.7, -0.2, 0.4, 1.0, -0.6, 0.3};
  const std::array<double, kLanes> at_density = {0.9, -1.3, 0.2};
  const auto loss = [&] {
    std::array<double, 6> action;
    std::array<double, kLanes> density;
    squashed_sample<double>({mean, log_std, centre, half_width}, noise, {action, density});
    double sum = 0.0;
    for (std::size_t i = 0; i < 6; ++i) sum += at_action[i] * action[i];
    for (std::size_t i = 0; i < kLanes; ++i) sum += at_density[i] * density[i];
    return sum;
  };
  const auto slope = [&](double& x) {
    const double h = 1e-5, at = x;
    x = at + h;
    const double above = loss();
    x = at - h;
    const double below = loss();
    x = at;
    return (above - below) / (2 * h);
  };
  std::array<double, 6> mean_gradient, log_std_gradient;

  squashed_gradient<double>({mean, log_std, centre, half_width}, noise, {at_action, at_density},
                            {mean_gradient, log_std_gradient});

  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(slope(mean[i]) == doctest::Approx(mean_gradient[i]).epsilon(1e-6));
    CHECK(slope(log_std[i]) == doctest::Approx(log_std_gradient[i]).epsilon(1e-6));
  }
  CHECK(log_std_gradient[4] == 0.0);
  CHECK(log_std_gradient[5] == 0.0);
}

TEST_CASE("a box ten times as wide has densities a tenth as high, and the same of the tanh") {
  const std::array centre = {0.0f}, one = {1.0f}, ten = {10.0f};
  const std::array<double, 1> mean = {0.4}, log_std = {-0.2}, noise = {0.7};
  std::array<double, 1> narrow_action, narrow, wide_action, wide, of_tanh;

  squashed_sample<double>({mean, log_std, centre, one}, noise, {narrow_action, narrow});
  squashed_sample<double>({mean, log_std, centre, ten}, noise, {wide_action, wide});
  squashed_sample<double>({mean, log_std, centre, ten, true}, noise, {wide_action, of_tanh});

  CHECK(wide_action[0] == doctest::Approx(10 * narrow_action[0]).epsilon(1e-15));
  CHECK(wide[0] == doctest::Approx(narrow[0] - std::log(10.0)).epsilon(1e-14));
  CHECK(of_tanh[0] == narrow[0]);
}
