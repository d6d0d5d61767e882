#include "gust/agents/off_policy_training.h"

#include <doctest/doctest.h>

#include <cmath>
#include <set>

#include "gust/agents/twin_critic.h"

using namespace gust;

namespace {

/// A clock: the reward is always one. It is either shown and fails after its tenth step, or always shows zero and ends
/// by time alone after ten.
class Clock final : public Plant {
 public:
  explicit Clock(bool shown) : shown_(shown) {
    spec_.state = {{"t", "1"}};
    spec_.action = {{"u", "N"}};
    spec_.force = {{"f", "N"}};
    spec_.control_rate = spec_.physics_rate = 10;
    spec_.steps = shown ? 1000 : 10;
    spec_.normalized_action = true;
    spec_.action_scale = {1};
    spec_.action_offset = {0};
    spec_.action_low = {-1};
    spec_.action_high = {1};
    spec_.start = {0};
    spec_.start_offset = {0};
    spec_.start_range = {0};
    spec_.fail_low = {-1};
    spec_.fail_high = {0.95};
    spec_.wraps = {false};
    spec_.state_weights = {0};
    spec_.action_goal = {0};
    spec_.error_weights = {1};
  }

  const PlantSpec& spec() const override { return spec_; }
  void advance(const Motion& motion) const noexcept override {
    for (std::size_t lane = 0; lane < motion.state.lanes; ++lane) motion.state.at(0, lane) += shown_ ? 0.1 : 0.0;
  }
  void reference(std::size_t, std::span<double> state) const noexcept override { state[0] = 0; }
  void begin(Rows<double>, std::size_t, bool) const noexcept override {}
  bool near_ground(std::span<const double>) const noexcept override { return false; }
  Linearisation linearise(std::span<const double>, std::span<const double>) const override {
    throw Bug("not linearised");
  }

 private:
  bool shown_;
  PlantSpec spec_;
};

OffPolicySetup small() {
  OffPolicySetup setup;
  setup.options = {.steps = 100'000, .hidden = 32, .discount = 0.9, .batch = 64, .warm_up = 100};
  setup.options.temperature = 1e-6;
  setup.options.polyak = 0.02;
  setup.identity = canonical_fields(setup.options);
  setup.make_critic = [](const OffPolicyOptions& options, const TransitionShape& shape, Rng rng) {
    return std::make_unique<TwinCritic>(options, shape, rng);
  };
  return setup;
}

/// The lesser value of no action at time t.
double value_at(OffPolicyTraining& training, double t) {
  Tiles<float> input(64, 2);
  for (std::size_t lane = 0; lane < 64; ++lane) input.at(lane, 0) = static_cast<float>(t);
  auto& critic = dynamic_cast<TwinCritic&>(training.learner().critic());
  const double first = critic.values(0, input).at(0, 0);
  return std::min<double>(first, critic.values(1, input).at(0, 0));
}

}  // namespace

TEST_CASE("8.4.5 updates keep their ratio to the steps after the warm-up, whatever the number of environments") {
  const Clock plant(false);
  for (const std::int64_t environments : {4, 3, 1, 7}) {
    for (const double ratio : {1.0, 0.3}) {
      OffPolicySetup setup = small();
      setup.options = {.steps = 10'000, .environments = environments, .hidden = 4, .batch = 2, .update_ratio = ratio};
      OffPolicyTraining training(setup, {&plant, {}, {}, 1});

      while (!training.done()) training.advance();

      const double owed = ratio * static_cast<double>(training.total_steps() - 1000);
      CHECK(std::abs(static_cast<double>(training.learner().updates()) - owed) <= 100.0 + ratio * 7);
      if (environments == 4 && ratio == 1.0) CHECK(training.learner().updates() == 9'000);
    }
  }
}

TEST_CASE("8.4.7 an end by time alone has a value after it, a failure has none") {
  const Clock endless(false);
  OffPolicyTraining truncated(small(), {&endless, {}, {}, 1});
  while (truncated.steps() < 6'000) truncated.advance();
  CHECK(std::abs(value_at(truncated, 0.0) - 10.0) < 0.2);

  const Clock failing(true);
  OffPolicyTraining terminated(small(), {&failing, {}, {}, 1});
  while (terminated.steps() < 12'000) terminated.advance();
  for (int t = 0; t < 10; ++t) {
    const double expected = (1.0 - std::pow(0.9, 10 - t)) / 0.1;
    CHECK(std::abs(value_at(terminated, 0.1 * t) - expected) < 0.02 * expected);
  }
}

TEST_CASE("the memory holds each step with what followed it in its own episode") {
  const Clock failing(true);
  OffPolicyTraining training(small(), {&failing, {}, {}, 1});
  training.advance();

  const TransitionShape& shape = training.replay().shape();
  for (std::int64_t i = 0; i < training.replay().size(); ++i) {
    const auto row = training.replay().row(i);
    CHECK(row[shape.next_at()] == doctest::Approx(row[0] + 0.1f));
    CHECK(row[shape.alive_at()] == (row[0] > 0.85f ? 0.0f : 1.0f));
    CHECK(row[shape.reward_at()] == 1.0f);
    CHECK(std::abs(row[shape.action_at()]) <= 1.0f);
  }
}

TEST_CASE("a risk level is kept through an episode, uniform over episodes, and part of the policy") {
  const Clock plant(false);
  OffPolicySetup setup = small();
  setup.options.update_ratio = 0;
  setup.risk = RiskLevels{.low = 0.2, .high = 0.6, .acts_at = 0.3};
  OffPolicyTraining training(setup, {&plant, {}, {}, 1});
  while (training.steps() < 20'000) training.advance();

  const TransitionShape& shape = training.replay().shape();
  std::vector<double> levels;
  for (std::int64_t i = 0; i < training.replay().size(); ++i) {
    const float level = training.replay().row(i)[shape.extra_at()];
    const std::int64_t episode_start = i - i / 4 % 10 * 4;  // four environments, ten steps an episode
    CHECK(level == training.replay().row(episode_start)[shape.extra_at()]);
    if (i == episode_start) levels.push_back((level - 0.2) / 0.4);
  }
  std::ranges::sort(levels);
  double distance = 0.0;  // Kolmogorov and Smirnov
  for (std::size_t i = 0; i < levels.size(); ++i)
    distance = std::max(distance, std::abs(levels[i] - (static_cast<double>(i) + 0.5) / 2000.0));
  CHECK(levels.size() == 2000);
  CHECK(distance * std::sqrt(2000.0) < 1.95);  // p = 0.001
  CHECK(training.actor().alpha == 0.3f);
  CHECK(training.actor().observations() == 1);
}

TEST_CASE("a training that is saved and loaded at any iteration equals an uninterrupted one to the bit") {
  const Clock plant(true);
  for (const bool risk : {false, true}) {
    OffPolicySetup setup = small();
    setup.options.buffer = 700;  // it wraps
    setup.options.auto_temperature = true;
    if (risk) setup.risk = RiskLevels{};
    for (const int iterations : {0, 1, 9}) {
      OffPolicyTraining whole(setup, {&plant, {}, {}, 7}), first(setup, {&plant, {}, {}, 7});
      OffPolicyTraining second(setup, {&plant, {}, {}, 7});
      for (int i = 0; i < iterations + 3; ++i) whole.advance();
      for (int i = 0; i < iterations; ++i) first.advance();

      second.load(first.save());
      for (int i = 0; i < 3; ++i) second.advance();

      CHECK(second.save() == whole.save());
    }
  }
}

TEST_CASE("bytes of another training of a memory are an error, and so are damaged ones") {
  const Clock plant(true);
  OffPolicyTraining training(small(), {&plant, {}, {}, 1});
  training.advance();
  const std::string bytes = training.save();

  CHECK_THROWS_AS(OffPolicyTraining(small(), {&plant, {}, {}, 2}).load(bytes), Error);
  for (const std::size_t size : {std::size_t{0}, std::size_t{5}, bytes.size() / 2, bytes.size() - 1})
    CHECK_THROWS_AS(training.load(std::string_view(bytes).substr(0, size)), Error);
  CHECK_THROWS_AS(training.load(bytes + "x"), Error);
}
