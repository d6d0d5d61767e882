#include "gust/agents/ppo_learner.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "gust/agents/archive.h"

using namespace gust;

namespace {

constexpr std::size_t kObservations = 4;

/// A learner and a rollout of 400 samples that it drew itself, with made-up rewards.
struct Drawn {
  PpoOptions options;
  PpoLearner learner;
  Rollout rollout;

  explicit Drawn(PpoOptions given = {})
      : options(given), learner(options, kObservations, 1, Rng(8)), rollout(4, 100, kObservations, 1) {
    for (std::size_t i = 0; i < rollout.observation.size(); ++i)
      rollout.observation[i] = static_cast<float>(0.2 * Rng(1).normal(i));
    for (std::size_t step = 0; step < 100; ++step) learner.sample(rollout, 4 * step, step);
    for (std::size_t i = 0; i < 400; ++i) {
      rollout.reward[i] = Rng(2).uniform(i);
      rollout.done[i] = i % 57 == 56;
    }
    learner.assess(rollout);
  }

  std::vector<std::uint32_t> first_samples() const {
    std::vector<std::uint32_t> samples(static_cast<std::size_t>(options.minibatch));
    std::iota(samples.begin(), samples.end(), 0u);
    return samples;
  }
};

std::vector<float> copy(std::span<const float> values) { return {values.begin(), values.end()}; }

/// Everything that learning changed, as bytes.
std::string state_of(const PpoLearner& learner) {
  Saver saver;
  PpoLearner::archive(saver, learner);
  return saver.take();
}

}  // namespace

TEST_CASE("8.3.1 the first minibatch after a rollout sees the ratio 1 and the loss -mean(A)") {
  Drawn drawn;
  const auto samples = drawn.first_samples();
  double mean = 0.0;
  for (const std::uint32_t sample : samples) mean += drawn.rollout.advantage[sample] / 64.0;

  const PpoStep step = drawn.learner.step(drawn.rollout, samples, 0.0);

  CHECK(std::abs(step.policy.kl) < 1e-6);
  CHECK(step.policy.clipped == 0.0);
  CHECK(step.policy.loss == doctest::Approx(-mean).epsilon(1e-6));
  CHECK(step.actor_moved);
}

TEST_CASE("8.3.1 the ratio of every sample is 1 before the first step") {
  Drawn drawn;
  for (std::uint32_t sample = 0; sample < 400; ++sample) {
    PpoOptions one = drawn.options;
    one.minibatch = 1;
    PpoLearner fresh(one, kObservations, 1, Rng(8));
    const PpoStep step = fresh.step(drawn.rollout, std::span(&sample, 1), 0.0);
    CHECK(std::abs(step.policy.kl) < 1e-5);  // of one sample it is the logarithm of the ratio
  }
}

TEST_CASE("8.3.4 a minibatch that has moved too far moves the critic only") {
  for (const bool too_far : {true, false}) {
    Drawn drawn;
    for (float& density : drawn.rollout.log_density) density += too_far ? 0.02f : 0.0149f;
    const auto actor = copy(drawn.learner.actor().parameters());
    const auto log_std = copy(drawn.learner.log_std());
    const auto critic = copy(drawn.learner.critic().parameters());

    const PpoStep step = drawn.learner.step(drawn.rollout, drawn.first_samples(), 0.0);

    CHECK(step.policy.kl == doctest::Approx(too_far ? 0.02 : 0.0149).epsilon(1e-4));
    CHECK(step.actor_moved == !too_far);
    CHECK((copy(drawn.learner.actor().parameters()) == actor) == too_far);
    CHECK((copy(drawn.learner.log_std()) == log_std) == too_far);
    CHECK(copy(drawn.learner.critic().parameters()) != critic);
  }
}

TEST_CASE("8.3.4 after a skipped minibatch the next is tested again") {
  Drawn drawn;
  const auto samples = drawn.first_samples();
  for (const std::uint32_t sample : samples) drawn.rollout.log_density[sample] += 0.02f;
  std::vector<std::uint32_t> others(samples);
  for (std::uint32_t& sample : others) sample += 64;

  CHECK_FALSE(drawn.learner.step(drawn.rollout, samples, 0.0).actor_moved);
  CHECK(drawn.learner.step(drawn.rollout, others, 0.0).actor_moved);
}

TEST_CASE("8.3.6 a constant added to all rewards' advantages before they are standardised changes nothing") {
  std::vector<double> advantage(400), shifted(400);
  for (std::size_t i = 0; i < 400; ++i) {
    advantage[i] = Rng(3).normal(i);
    shifted[i] = advantage[i] + 12.5;
  }
  Drawn a, b;

  standardise(advantage);
  standardise(shifted);
  a.rollout.advantage = advantage;
  b.rollout.advantage = shifted;
  a.learner.update(a.rollout, 0.0);
  b.learner.update(b.rollout, 0.0);

  for (std::size_t i = 0; i < 400; ++i) CHECK(std::abs(advantage[i] - shifted[i]) < 1e-6);
  double largest = 0.0;
  const auto p = a.learner.actor().parameters();
  for (std::size_t i = 0; i < p.size(); ++i)
    largest = std::max<double>(largest, std::abs(p[i] - b.learner.actor().parameters()[i]));
  CHECK(largest < 1e-6);
}

TEST_CASE("8.3.5 four hundred samples make six minibatches an epoch and sixty critic steps") {
  Drawn drawn;

  drawn.learner.update(drawn.rollout, 0.0);

  CHECK(drawn.learner.critic_steps() == 60);
  CHECK(2500 * drawn.learner.critic_steps() == 150'000);
}

TEST_CASE("8.3.5 an epoch visits 384 different samples") {
  std::vector<std::uint32_t> order(400);
  shuffle(order, Rng(1));

  CHECK(std::set<std::uint32_t>(order.begin(), order.begin() + 384).size() == 384);
  CHECK(*std::max_element(order.begin(), order.end()) == 399);
}

TEST_CASE("8.3.7 on a one-step bandit the mean converges to the best action for five seeds of five") {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    PpoOptions options;
    options.entropy = 0.0;
    PpoLearner learner(options, 1, 1, Rng(seed));
    Rollout rollout(4, 100, 1, 1);
    std::ranges::fill(rollout.done, std::uint8_t{1});
    std::ranges::fill(rollout.observation, 1.0f);
    for (std::uint64_t iteration = 0; iteration < 200; ++iteration) {
      for (std::size_t step = 0; step < 100; ++step) learner.sample(rollout, 4 * step, 100 * iteration + step);
      for (std::size_t i = 0; i < 400; ++i) {
        const double miss = rollout.action[i] - 0.3;
        rollout.reward[i] = -miss * miss;
      }
      learner.assess(rollout);
      learner.update(rollout, 0.0);
    }

    learner.sample(rollout, 0, 0);

    CAPTURE(seed);
    CHECK(std::abs(rollout.mean[0] - 0.3) < 0.03);
  }
}

TEST_CASE("a learner without a divergence limit moves its actor at every step") {
  PpoOptions options;
  options.target_kl = 0.0;
  Drawn drawn(options);
  for (float& density : drawn.rollout.log_density) density += 5.0f;

  CHECK(drawn.learner.step(drawn.rollout, drawn.first_samples(), 0.0).actor_moved);
}

TEST_CASE("linearly decaying rates end in standing still") {
  PpoOptions options;
  options.rate_decay = "linear";
  Drawn drawn(options);
  const auto critic = copy(drawn.learner.critic().parameters());

  drawn.learner.step(drawn.rollout, drawn.first_samples(), 1.0);

  CHECK(copy(drawn.learner.critic().parameters()) == critic);
}

TEST_CASE("equal streams learn equal bits") {
  Drawn a, b;

  a.learner.update(a.rollout, 0.0);
  b.learner.update(b.rollout, 0.0);

  CHECK(state_of(a.learner) == state_of(b.learner));
}
