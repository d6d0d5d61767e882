#include "gust/agents/cvar.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "gust/core/rng.h"

using namespace gust;

TEST_CASE("8.6.1 the coefficient of the conditional value at risk is that of the table, in both forms") {
  struct Row {
    double alpha, correct, literal;
  };
  constexpr Row kTable[] = {{0.01, 2.665214, 0.791529}, {0.05, 2.062713, 0.766328}, {0.1, 1.754983, 0.735332},
                            {0.25, 1.271106, 0.645839}, {0.3, 1.158975, 0.617221},  {0.5, 0.797885, 0.509160},
                            {0.75, 0.423702, 0.389382}, {0.9, 0.194998, 0.326109},  {1.0, 0.0, 0.287600}};
  for (const Row& row : kTable) {
    CAPTURE(row.alpha);
    CHECK(std::abs(cvar_coefficient(row.alpha) - row.correct) < 1e-6);
    CHECK(std::abs(cvar_coefficient(row.alpha, CvarForm::kLiteral) - row.literal) < 1e-6);
  }
}

TEST_CASE("8.6.1 the coefficient falls with the level, to exactly zero at the mean") {
  for (int i = 1; i < 1000; ++i) CHECK(cvar_coefficient(i / 1000.0) > cvar_coefficient((i + 1) / 1000.0));
  CHECK(cvar_coefficient(1.0) == 0.0);
}

TEST_CASE("8.6.1 the mean of the lower tail of ten million normal draws agrees") {
  constexpr std::size_t kDraws = 10'000'000;
  std::vector<float> draws(kDraws);
  for (std::size_t i = 0; i < kDraws; ++i) draws[i] = static_cast<float>(Rng(3).normal(i));

  for (const double alpha : {1.0, 0.5, 0.3, 0.1, 0.05}) {  // each tail is part of the one before
    const auto tail = static_cast<std::ptrdiff_t>(alpha * kDraws);
    std::nth_element(draws.begin(), draws.begin() + tail - 1, draws.end());
    draws.resize(static_cast<std::size_t>(tail));
    double sum = 0.0;
    for (const float draw : draws) sum += draw;
    CAPTURE(alpha);
    CHECK(std::abs(sum / static_cast<double>(tail) + cvar_coefficient(alpha)) < 0.003);
  }
}
