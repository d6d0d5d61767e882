#include "gust/agents/temperature.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace gust;

TEST_CASE("a fixed temperature stays, to the bit") {
  const OffPolicyOptions options{.temperature = 0.2};
  Temperature temperature(options, 1);
  const double before = temperature.log_value();

  temperature.update(std::vector<float>{-5.0f, 3.0f});

  CHECK(temperature.log_value() == before);
  CHECK(temperature.value() == 0.2);
}

TEST_CASE("an automatic temperature rises while the entropy is below its target, by Adam at its logarithm") {
  const OffPolicyOptions options{.temperature = 0.2, .auto_temperature = true, .target_entropy = -0.5};
  Temperature low(options, 2), high(options, 2);  // the target is -1

  low.update(std::vector<float>{1.25f, 1.25f});   // entropy -1.25
  high.update(std::vector<float>{0.75f, 0.75f});  // entropy -0.75

  CHECK(low.log_value() == doctest::Approx(std::log(0.2) + 1e-3).epsilon(1e-9));
  CHECK(high.log_value() == doctest::Approx(std::log(0.2) - 1e-3).epsilon(1e-9));
  CHECK(low.value() == doctest::Approx(std::exp(low.log_value())).epsilon(1e-14));
}
