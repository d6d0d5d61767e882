#include "gust/disturb/waveform_fixture_test.h"

using namespace gust;

namespace {

/// The control steps that an impulse at offset 2 disturbs.
std::vector<std::size_t> disturbed_steps(std::int64_t duration) {
  const auto made = waveform("scg_impulse", {{"offset", steps(2)}, {"duration", steps(duration)}});
  const std::vector<double> values = values_of(made, 12);
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (values[k] == 1.0) found.push_back(k);
  }
  return found;
}

}  // namespace

TEST_CASE("safe-control-gym's impulse of even duration hits one step less and starts one late") {
  // Measured in safe-control-gym.
  CHECK(disturbed_steps(1) == std::vector<std::size_t>{2});
  CHECK(disturbed_steps(2) == std::vector<std::size_t>{3});
  CHECK(disturbed_steps(3) == std::vector<std::size_t>{2, 3, 4});
  CHECK(disturbed_steps(4) == std::vector<std::size_t>{3, 4, 5});
}

TEST_CASE("safe-control-gym's impulse decays by whole steps from its peak") {
  const auto made = waveform("scg_impulse", {{"offset", steps(0)}, {"duration", steps(5)}, {"decay", number(0.5)}});

  const std::vector<double> values = values_of(made, 6);

  // Peak at floor(0 + 5/2) = 2.
  for (const auto& [k, value] : {std::pair{0, 0.25}, {1, 0.5}, {2, 1.0}, {3, 0.5}, {4, 0.25}, {5, 0.0}}) {
    CHECK(values[static_cast<std::size_t>(k)] == doctest::Approx(value).epsilon(1e-15));
  }
}
