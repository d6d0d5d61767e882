#include "gust/agents/collector.h"

#include <doctest/doctest.h>

#include <cmath>

#include "gust/agents/archive.h"
#include "gust/control/adder_plant_test.h"

using namespace gust;

namespace {

constexpr std::size_t kLanes = 3, kSteps = 20;  // two whole episodes of the adder and half of one

/// Pushes that differ from sample to sample, and with them the observations.
double push(std::size_t sample) { return 0.02 * static_cast<double>(sample % 7); }

Collector collector(const Plant& plant, bool normalise) {
  PpoOptions options;
  options.environments = kLanes;
  options.normalise_observation = options.normalise_reward = normalise;
  return {options, {&plant, {}, {}, 1}, {}, Rng(5)};
}

Rollout collected(Collector& collector) {
  Rollout rollout(kLanes, kSteps, 2, 1);
  collector.collect(rollout, [&](std::size_t first) -> std::span<const float> {
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      rollout.action[first + lane] = static_cast<float>(push(first + lane));
    return {};
  });
  return rollout;
}

/// What a component is scaled by, from all of its numbers at once; the first one, 1e-4 of a sample, is the start's.
struct Scale {
  double mean = 0;
  double deviation = 1;

  explicit Scale(const std::vector<double>& seen) {
    const double count = static_cast<double>(seen.size()) + 1e-4;
    for (const double x : seen) mean += x / count;
    double squares = 1e-4 * (1.0 + mean * mean);
    for (const double x : seen) squares += (x - mean) * (x - mean);
    deviation = std::sqrt(squares / count + 1e-8);
  }
};

}  // namespace

TEST_CASE("a rollout holds what was seen, done and rewarded, step by step, and where time alone ended an episode") {
  const AdderPlant plant;
  Collector raw = collector(plant, false);

  const Rollout rollout = collected(raw);

  for (std::size_t step = 0; step < kSteps; ++step) {
    const bool last = step % 8 == 7;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      CAPTURE(step);
      CAPTURE(lane);
      const std::size_t sample = step * kLanes + lane;
      const double u = 2.0 * static_cast<float>(push(sample)), after = rollout.observation[2 * sample] + u;
      CHECK(rollout.reward[sample] == doctest::Approx(std::exp(-(after * after + u * u / 2))).epsilon(1e-6));
      CHECK((rollout.done[sample] != 0) == last);
      if (last || step + 1 == kSteps) continue;
      CHECK(rollout.observation[2 * (sample + kLanes)] == doctest::Approx(after));
    }
  }
  REQUIRE(rollout.truncated == std::vector<std::size_t>{21, 22, 23, 45, 46, 47});
  for (std::size_t i = 0; i < rollout.truncated.size(); ++i) {
    const std::size_t sample = rollout.truncated[i];
    const double ended = rollout.observation[2 * sample] + 2.0 * push(sample);
    CHECK(rollout.terminal_observation[2 * i] == doctest::Approx(ended));
    CHECK(rollout.observation[2 * (sample + kLanes)] != doctest::Approx(ended));  // a new episode
  }
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const std::size_t sample = (kSteps - 1) * kLanes + lane;
    CHECK(rollout.last_observation[2 * lane] == doctest::Approx(rollout.observation[2 * sample] + 2.0 * push(sample)));
  }
}

TEST_CASE("observations are scaled by the moments of all seen so far, rewards by those of the discounted returns") {
  const AdderPlant plant;
  Collector raw = collector(plant, false), scaled = collector(plant, true);
  const Rollout shown = collected(raw), seen = collected(scaled);

  std::vector<double> observations, returns, discounted(kLanes, 0.0);
  std::size_t truncated = 0;
  for (std::size_t step = 0; step < kSteps; ++step) {
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      observations.push_back(shown.observation[2 * (step * kLanes + lane)]);
    const Scale scale(observations);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t sample = step * kLanes + lane;
      discounted[lane] = 0.99 * discounted[lane] + shown.reward[sample];
      returns.push_back(discounted[lane]);
      CHECK(seen.observation[2 * sample] ==
            doctest::Approx((shown.observation[2 * sample] - scale.mean) / scale.deviation).epsilon(1e-5));
    }
    const double spread = Scale(returns).deviation;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t sample = step * kLanes + lane;
      CHECK(seen.reward[sample] == doctest::Approx(std::min(10.0, shown.reward[sample] / spread)).epsilon(1e-5));
      if (!shown.done[sample]) continue;
      discounted[lane] = 0.0;
      // The observation that a cut episode ended with is scaled as the others of its step were; it counts for nothing.
      const double ended = shown.terminal_observation[2 * truncated];
      CHECK(seen.terminal_observation[2 * truncated++] ==
            doctest::Approx((ended - scale.mean) / scale.deviation).epsilon(1e-5));
    }
  }
  CHECK(truncated == seen.truncated.size());
}

TEST_CASE("a collector that loads another's state goes on as that one does, to the bit") {
  const AdderPlant plant;
  Collector first = collector(plant, true), second = collector(plant, true);
  collected(first);
  Saver saver;
  first.save(saver);
  const std::string state = saver.take();
  Loader loader(state);
  second.load(loader);

  const Rollout one = collected(first), other = collected(second);

  CHECK(std::ranges::equal(one.observation, other.observation));
  CHECK(one.reward == other.reward);
  CHECK(std::ranges::equal(one.last_observation, other.last_observation));
}
