#include "gust/agents/population.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "gust/agents/archive.h"

using namespace gust;

namespace {

const std::vector<std::uint8_t> kAll(4, 1);

/// A rollout with made-up observations, rewards and ends.
Rollout made_up() {
  Rollout rollout(4, 100, 3, 2);
  for (std::size_t i = 0; i < rollout.observation.size(); ++i)
    rollout.observation[i] = static_cast<float>(Rng(1).normal(i));
  for (std::size_t i = 0; i < 400; ++i) {
    rollout.reward[i] = Rng(2).uniform(i);
    rollout.done[i] = i % 57 == 56;
  }
  return rollout;
}

Population population(Population::Options shared, PpoOptions options = {}) {
  return Population(options, shared, Rollout(4, 100, 3, 2), Rng(4));
}

void play(Population& population, const Rollout& rollout) {
  for (std::size_t step = 0; step < 100; ++step) population.act(rollout, 4 * step, step);
}

std::string state_of(const PpoLearner& learner) {
  Saver saver;
  PpoLearner::archive(saver, learner);
  return saver.take();
}

}  // namespace

TEST_CASE("8.5.6 of two adversaries one is unused in an eighth of the draws for four environments") {
  Population two = population({.size = 2});
  constexpr int kDraws = 100'000;
  int unused = 0;
  std::array<int, 4> firsts{};

  for (int i = 0; i < kDraws; ++i) {
    two.draw(kAll);
    const auto owners = two.owners();
    unused += std::ranges::all_of(owners, [&](std::size_t owner) { return owner == owners[0]; });
    for (std::size_t e = 0; e < 4; ++e) firsts[e] += owners[e] == 0;
  }

  CHECK(std::abs(unused / double{kDraws} - 0.125) < 0.004);
  for (const int count : firsts) {
    const double off = count - 0.5 * kDraws;
    CHECK(off * off / (0.25 * kDraws) < 10.83);  // chi squared of one degree at p = 1e-3
  }
}

TEST_CASE("8.5.6 an adversary learns from its own samples alone: others may be anything") {
  const Rollout clean = made_up();
  PpoOptions options;
  PpoLearner learner(options, 3, 2, Rng(5)), poisoned(options, 3, 2, Rng(5));
  std::vector<std::uint32_t> own;
  for (std::uint32_t s = 0; s < 400; ++s) {
    if (s % 4 == 1 || s % 4 == 2) own.push_back(s);
  }
  const auto learn = [&](PpoLearner& one, Rollout rollout, bool poison) {
    for (std::size_t step = 0; step < 100; ++step) one.sample(rollout, 4 * step, step);
    for (std::size_t s = 0; poison && s < 400; ++s) {
      if (s % 4 == 1 || s % 4 == 2) continue;
      const float nan = std::numeric_limits<float>::quiet_NaN();
      rollout.reward[s] = nan;
      std::ranges::fill(std::span(rollout.observation).subspan(s * 3, 3), nan);
      std::ranges::fill(std::span(rollout.action).subspan(s * 2, 2), nan);
    }
    one.evaluate(rollout);
    one.update(rollout, own, 0.0);
    return rollout;
  };

  const Rollout a = learn(learner, clean, false);
  const Rollout b = learn(poisoned, clean, true);

  CHECK(poisoned.finite());
  CHECK(state_of(learner) == state_of(poisoned));
  for (const std::uint32_t s : own) CHECK(a.advantage[s] == b.advantage[s]);
  CHECK(std::isnan(b.advantage[0]));
}

TEST_CASE("8.5.6 an adversary without samples stays as it is") {
  Population two = population({.size = 2});
  while (std::ranges::count(two.owners(), 1u) != 4) two.draw(kAll);
  const std::string first = state_of(two.learners()[0]), second = state_of(two.learners()[1]);
  const Rollout rollout = made_up();

  play(two, rollout);
  CHECK(two.learn(rollout, 0.0));

  CHECK(state_of(two.learners()[0]) == first);
  CHECK(state_of(two.learners()[1]) != second);
  CHECK(two.learners()[1].critic_steps() == 60);
}

TEST_CASE("an adversary learns floor(100 n / 64) minibatches an epoch from n environments") {
  const std::array<std::int64_t, 5> minibatches = {0, 1, 3, 4, 6};
  for (std::size_t n = 0; n <= 4; ++n) {
    Population two = population({.size = 2});
    while (std::ranges::count(two.owners(), 0u) != static_cast<std::ptrdiff_t>(n)) two.draw(kAll);
    const Rollout rollout = made_up();

    play(two, rollout);
    two.learn(rollout, 0.0);

    CHECK(two.learners()[0].critic_steps() == 10 * minibatches[n]);
    CHECK(two.learners()[1].critic_steps() == 10 * minibatches[4 - n]);
  }
}

TEST_CASE("a single adversary learns as the opponent's side of the whole rollout") {
  Population one = population({.size = 1});
  Population joint = population({.size = 1, .joint_advantages = true});
  PpoLearner alone(PpoOptions{}, 3, 2, Rng(4).split("adversary").split(std::uint64_t{0}));
  const Rollout rollout = made_up();
  Rollout against(4, 100, 3, 2);

  play(one, rollout);
  play(joint, rollout);
  one.learn(rollout, 0.0);
  joint.learn(rollout, 0.0);
  against.observation = rollout.observation;
  for (std::size_t step = 0; step < 100; ++step) alone.sample(against, 4 * step, step);
  oppose(rollout, against);
  alone.assess(against);
  alone.update(against, 0.0);

  CHECK(state_of(one.learners()[0]) == state_of(alone));
  CHECK(state_of(joint.learners()[0]) == state_of(alone));
}

TEST_CASE("advantages over all adversaries together are other advantages") {
  Population separate = population({.size = 2}), joint = population({.size = 2, .joint_advantages = true});
  const Rollout rollout = made_up();
  REQUIRE(std::ranges::equal(separate.owners(), joint.owners()));

  for (Population* one : {&separate, &joint}) {
    while (std::ranges::count(one->owners(), 0u) != 2) one->draw(kAll);
    play(*one, rollout);
    CHECK(one->learn(rollout, 0.0));
  }

  CHECK(state_of(separate.learners()[0]) != state_of(joint.learners()[0]));
}

TEST_CASE("adversaries reach as far as their bin") {
  const Population three = population({.size = 8, .strength_bins = 3});

  for (std::size_t k = 0; k < 8; ++k) CHECK(three.strength(k) == (static_cast<double>(k % 3) + 1) / 3);
  CHECK(population({.size = 8}).strength(5) == 1.0);
}

TEST_CASE("an environment feels its owner's action, clipped and within its reach") {
  PpoOptions options;
  options.log_std = 2.0;  // most actions are beyond the clip
  Population two = population({.size = 2, .strength_bins = 2}, options);
  while (std::ranges::count(two.owners(), 0u) != 2) two.draw(kAll);
  const Rollout rollout = made_up();

  float greatest[2] = {0, 0};
  for (std::size_t step = 0; step < 100; ++step) {
    const auto action = two.act(rollout, 4 * step, step);
    for (std::size_t i = 0; i < 8; ++i) {
      float& of_owner = greatest[two.owners()[i / 2]];
      of_owner = std::max(of_owner, std::abs(action[i]));
    }
  }

  CHECK(greatest[0] == 0.5f);
  CHECK(greatest[1] == 1.0f);
}

TEST_CASE("numbers that are not finite are told") {
  Population two = population({.size = 2});
  Rollout rollout = made_up();
  play(two, rollout);
  rollout.reward[7] = std::numeric_limits<double>::infinity();

  CHECK_FALSE(two.learn(rollout, 0.0));
}
