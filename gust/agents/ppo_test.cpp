#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "gust/agents/agent.h"

using namespace gust;

namespace {

using Options = std::vector<std::pair<std::string, Value>>;

Value number(double value) { return {value, {"test"}}; }
Value integer(std::int64_t value) { return {value, {"test"}}; }
Value text(const char* value) { return {std::string(value), {"test"}}; }

Made<Plant> cartpole(Options options = {}) {
  options.push_back({"kind", text("cartpole")});
  return plants().make({options, {"test"}});
}

Made<Agent> ppo(Options options) {
  options.push_back({"kind", text("ppo")});
  return agents().make({options, {"test"}});
}

bool equal_actors(const Training& a, const Training& b) {
  return std::ranges::equal(a.actor().mlp.parameters(), b.actor().mlp.parameters());
}

void advance(Training& training, int iterations) {
  for (int i = 0; i < iterations; ++i) training.advance();
}

/// Profile "modern" in small: everything that the default leaves off.
const Options kModern = {{"init", text("orthogonal")},
                         {"use_gae", {true, {}}},
                         {"value_target", text("td_lambda")},
                         {"advantage_scale", text("minibatch")},
                         {"adam_epsilon", number(1e-5)},
                         {"max_grad_norm", number(0.5)},
                         {"rate_decay", text("linear")},
                         {"normalise_observation", {true, {}}},
                         {"normalise_reward", {true, {}}},
                         {"rollout", integer(64)},
                         {"entropy", number(0)},
                         {"value_clip", number(0.2)},
                         {"steps", integer(30'000)}};

}  // namespace

TEST_CASE("8.3.8 a training that is saved and loaded at any iteration equals an uninterrupted one to the bit") {
  const auto plant = cartpole();
  const TrainingTask task{plant.object.get(), {}, {}, 7};
  for (const Options& options : {Options{{"steps", integer(30'000)}}, kModern}) {
    const auto agent = ppo(options);
    for (const int iterations : {0, 1, 13, 60}) {
      const auto whole = agent->start(task);
      const auto first = agent->start(task);
      advance(*whole, iterations + 10);
      advance(*first, iterations);

      const auto second = agent->start(task);
      second->load(first->save());
      advance(*second, 10);

      CHECK(second->save() == whole->save());
      CHECK(equal_actors(*second, *whole));
      CHECK(second->curve().size() == whole->curve().size());
    }
  }
}

TEST_CASE("bytes of another training are an error, and so are damaged ones") {
  const auto plant = cartpole();
  const auto agent = ppo({{"steps", integer(4000)}});
  const auto training = agent->start({plant.object.get(), {}, {}, 1});
  advance(*training, 1);
  const std::string bytes = training->save();

  CHECK_THROWS_AS(agent->start({plant.object.get(), {}, {}, 2})->load(bytes), Error);
  CHECK_THROWS_AS(ppo({{"steps", integer(8000)}})->start({plant.object.get(), {}, {}, 1})->load(bytes), Error);
  for (const std::size_t size : {std::size_t{0}, std::size_t{5}, bytes.size() / 2, bytes.size() - 1})
    CHECK_THROWS_AS(training->load(std::string_view(bytes).substr(0, size)), Error);
  CHECK_THROWS_AS(training->load(bytes + "x"), Error);
}

TEST_CASE("a training counts steps in whole rollouts and has a curve point every 20000 of them") {
  const auto plant = cartpole();
  const auto training =
      ppo({{"steps", integer(50'100)}, {"epochs", integer(1)}})->start({plant.object.get(), {}, {}, 1});

  while (!training->done()) training->advance();

  CHECK(training->steps() == 50'400);
  CHECK(training->total_steps() == 50'400);
  std::vector<std::int64_t> steps;
  for (const CurvePoint& point : training->curve()) steps.push_back(point.steps);
  CHECK(steps == std::vector<std::int64_t>{0, 20'000, 40'000, 50'400});
  CHECK(training->failure().empty());
}

TEST_CASE("equal seeds train equal policies, other seeds others") {
  const auto plant = cartpole();
  const auto agent = ppo({{"steps", integer(2000)}});
  std::vector<std::unique_ptr<Training>> trainings;
  for (const std::int64_t seed : {1, 1, 2}) {
    trainings.push_back(agent->start({plant.object.get(), {}, {}, seed}));
    while (!trainings.back()->done()) trainings.back()->advance();
  }

  CHECK(equal_actors(*trainings[0], *trainings[1]));
  CHECK_FALSE(equal_actors(*trainings[0], *trainings[2]));
}

TEST_CASE("a shorter training is the beginning of a longer one, to the bit, unless rates depend on its end") {
  const auto plant = cartpole();
  const TrainingTask task{plant.object.get(), {}, {}, 5};
  const auto after = [&](Options options, std::int64_t steps, std::int64_t total) {
    options.push_back({"steps", integer(total)});
    auto training = ppo(options)->start(task);
    while (training->steps() < steps) training->advance();
    return training;
  };

  CHECK(equal_actors(*after({}, 8000, 8000), *after({}, 8000, 32'000)));
  const Options decaying = {{"rate_decay", text("linear")}};
  CHECK_FALSE(equal_actors(*after(decaying, 8000, 8000), *after(decaying, 8000, 32'000)));
}

TEST_CASE("the learning curve disturbs no other stream") {
  const auto plant = cartpole();
  const auto agent = ppo({{"steps", integer(20'000)}});
  const auto other = ppo({{"steps", integer(40'000)}});  // no point at 20000 is its last
  const auto a = agent->start({plant.object.get(), {}, {}, 3});
  const auto b = other->start({plant.object.get(), {}, {}, 3});

  while (!a->done()) a->advance();
  advance(*b, 50);

  CHECK(a->curve().back().return_mean == b->curve().back().return_mean);
  CHECK(equal_actors(*a, *b));
}

TEST_CASE("a training whose numbers are not finite ends with a reason") {
  const auto plant = cartpole();
  const auto training =
      ppo({{"steps", integer(40'000)}, {"critic_rate", number(1e30)}})->start({plant.object.get(), {}, {}, 1});

  while (!training->done()) training->advance();

  CHECK(training->steps() < 40'000);
  CHECK(training->failure().find("finite") != std::string::npos);
}

TEST_CASE("the policy of a training with scaled observations takes them as they are") {
  const auto plant = cartpole();
  auto options = kModern;
  options.push_back({"hidden", integer(32)});
  const auto training = ppo(options)->start({plant.object.get(), {}, {}, 5});

  while (!training->done()) training->advance();

  CHECK(training->actor().observations() == 4);
  CHECK(training->curve().back().anr_h > training->curve().front().anr_h + 0.05);  // it learns
}

TEST_CASE("disturbances in training change what is learned") {
  const auto plant = cartpole();
  const Table noise{{{"site", text("observation")}, {"waveform", text("white")}, {"level", number(0.1)}}, {"test"}};
  std::vector<Injection> injections;
  injections.push_back(read_injection(noise, plant->spec()));
  const auto agent = ppo({{"steps", integer(800)}});
  const auto clean = agent->start({plant.object.get(), {}, {}, 1});
  const auto noisy = agent->start({plant.object.get(), {}, injections, 1});

  advance(*clean, 2);
  advance(*noisy, 2);

  CHECK_FALSE(equal_actors(*clean, *noisy));
}

TEST_CASE("8.8.1 training with a range of one value is training with that parameter, to the bit") {
  const auto nominal = cartpole();
  const auto longer = cartpole({{"pole_length", number(0.7)}});
  const Value one{Table{{{"low", number(0.7)}, {"high", number(0.7)}}, {"test"}}, {"test"}};
  const Randomisation randomisation = read_randomisation({{{"pole_length", one}}, {"test"}}, nominal->spec());
  const auto agent = ppo({{"steps", integer(4000)}});
  const auto drawn = agent->start({nominal.object.get(), {}, {}, 1, randomisation.draws});
  const auto fixed = agent->start({longer.object.get(), {}, {}, 1});
  const auto other = agent->start({nominal.object.get(), {}, {}, 1});

  for (Training* training : {drawn.get(), fixed.get(), other.get()}) advance(*training, 10);

  CHECK(equal_actors(*drawn, *fixed));
  CHECK_FALSE(equal_actors(*drawn, *other));
}

TEST_CASE("impossible options are errors that say what would be right") {
  CHECK_THROWS_WITH_AS(ppo({{"minibatch", integer(500)}}),
                       "test: 'minibatch' must be at most environments * rollout = 400, got 500", Error);
  CHECK_THROWS_AS(ppo({{"discount", number(1.5)}}), Error);
  CHECK_THROWS_AS(ppo({{"activation", text("sigmoid")}}), Error);
  CHECK_THROWS_AS(ppo({{"epoch", integer(5)}}), Error);
}
