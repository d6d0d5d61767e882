#include <doctest/doctest.h>

#include <cmath>
#include <memory>

#include "gust/agents/agent.h"
#include "gust/control/closed_loop.h"
#include "gust/control/plant_loops.h"
#include "gust/eval/evaluate.h"
#include "gust/eval/metric.h"

// What every kind of a catalogue has to keep, whoever adds it.

using namespace gust;

namespace {

template <class T>
Made<T> standard(const Catalog<T>& catalog, const std::string& kind) {
  return catalog.make(Table{{{"kind", {kind, {"test"}}}}, {"test"}});
}

template <class T>
void check_entries(const Catalog<T>& catalog) {
  for (const Entry<T>& entry : catalog.entries()) {
    CAPTURE(entry.name);
    CHECK_FALSE(entry.summary.empty());
    CHECK_FALSE(entry.source.empty());
    for (const FieldInfo& field : entry.fields) {
      CAPTURE(field.name);
      CHECK_FALSE(field.help.empty());
    }
    CHECK(standard(catalog, entry.name).canonical() == standard(catalog, entry.name).canonical());
    const Table unknown{{{"kind", {entry.name, {"test"}}}, {"no_such_option", {1.0, {"test"}}}}, {"test"}};
    CHECK_THROWS_AS(catalog.make(unknown), Error);
  }
}

}  // namespace

TEST_CASE("every kind says what it is, where it comes from, and refuses options that it lacks") {
  check_entries(waveforms());
  check_entries(effects());
  check_entries(plants());
  check_entries(metrics());
  check_entries(agents());
  check_entries(distributions());
}

TEST_CASE("every waveform gives equal bits again, finite ones, and a longer episode begins as a shorter one") {
  for (const std::string& name : waveforms().names()) {
    CAPTURE(name);
    const auto waveform = standard(waveforms(), name);
    std::vector<double> once(250), again(250), longer(400);

    waveform->fill(once, 50.0, Rng(3));
    waveform->fill(again, 50.0, Rng(3));
    waveform->fill(longer, 50.0, Rng(3));

    CHECK(once == again);
    CHECK(std::equal(once.begin(), once.end(), longer.begin()));
    bool acts = false;
    for (const double value : once) {
      REQUIRE(std::isfinite(value));
      acts = acts || value != 0.0;
    }
    CHECK(acts);
    waveform->fill(again, 50.0, Rng(4));
    CHECK((once != again) == waveform->random());
  }
}

TEST_CASE("every effect has a name of its own, and at level 0 changes no bit of any signal") {
  for (const std::string& name : effects().names()) {
    CAPTURE(name);
    const std::vector<std::string> others = waveforms().names();
    CHECK(std::ranges::find(others, name) == others.end());
    const auto effect = standard(effects(), name);
    CHECK(effect->limit(50.0) > 0);
    for (const bool seen : {false, true}) {
      const EffectPlace place{50.0, 20, 250, seen};
      const double level = 0, factor = 1, rest = 0.5;
      std::vector<std::vector<double>> memory(1, std::vector<double>(effect->memory(level, place)));
      std::vector<std::uint8_t> fresh = {1};
      const std::vector<std::uint8_t> on = {1};
      CHECK(effect->split(level, place) == 0);
      for (int k = 0; k < 100; ++k) {
        const double value = std::sin(3.7 * k) / 3;
        Matrix<double> signal(1, 1, value);
        effect->apply({place, {}, signal.view(), {&factor, 1}, {&rest, 1}, {&level, 1}, on, fresh, memory, 0, 1});
        CHECK(signal.at(0, 0) == value);
      }
    }
  }
}

TEST_CASE("every plant has a whole spec, keeps its lanes apart, and knows its own derivative") {
  for (const std::string& name : plants().names()) {
    CAPTURE(name);
    const auto plant = standard(plants(), name);
    const PlantSpec& spec = plant->spec();
    const std::size_t states = spec.state.size();
    const std::size_t actions = spec.action.size();
    for (const auto* list : {&spec.start, &spec.start_offset, &spec.start_range, &spec.fail_low, &spec.fail_high,
                             &spec.state_weights, &spec.error_weights}) {
      CHECK(list->size() == states);
    }
    for (const auto* list :
         {&spec.action_low, &spec.action_high, &spec.action_scale, &spec.action_offset, &spec.action_goal}) {
      CHECK(list->size() == actions);
    }

    std::vector<double> goal(states);
    plant->reference(0, goal);
    const Linearisation exact = plant->linearise(goal, spec.action_goal);
    constexpr double kStep = 1e-6;
    for (std::size_t input = 0; input < states + actions; ++input) {
      ClosedLoop loop(*plant, {}, {}, 2);
      Matrix<double> command(actions, 2);
      for (std::size_t lane = 0; lane < 2; ++lane) {
        EpisodeStart start{goal, nominal_parameters(spec), {}, nullptr};
        const double nudge = lane == 0 ? kStep : -kStep;
        if (input < states) start.state[input] += nudge;
        for (std::size_t i = 0; i < actions; ++i) {
          const double physical = spec.action_goal[i] + (input == states + i ? nudge : 0.0);
          command.at(i, lane) = (physical - spec.action_offset[i]) / spec.action_scale[i];
        }
        loop.begin(lane, start);
      }
      loop.step(command.view());
      for (std::size_t i = 0; i < states; ++i) {
        const double difference = (loop.state().at(i, 0) - loop.state().at(i, 1)) / (2 * kStep);
        const auto row = static_cast<Eigen::Index>(i);
        const auto column = static_cast<Eigen::Index>(input < states ? input : input - states);
        const double derivative = input < states ? exact.a(row, column) : exact.b(row, column);
        CHECK(difference == doctest::Approx(derivative).epsilon(1e-6).scale(1e-3));  // central difference in double
      }
    }
  }
}

TEST_CASE("every distribution draws within its bounds, and equal numbers from equal streams") {
  for (const std::string& name : distributions().names()) {
    CAPTURE(name);
    const auto distribution = standard(distributions(), name);
    REQUIRE(distribution->low() <= distribution->high());
    for (std::uint64_t i = 0; i < 10'000; ++i) {
      const double value = distribution->draw(Rng(1).split(i));
      REQUIRE((value >= distribution->low() && value <= distribution->high()));
      REQUIRE(value == distribution->draw(Rng(1).split(i)));
    }
  }
}

TEST_CASE("every metric is a number for an episode that holds and for one that fails") {
  const auto plant = standard(plants(), "cartpole");
  const PlantLoops loops(plant.object, {});
  Evaluation evaluation;
  evaluation.source = &loops;
  evaluation.cells = {{{}, nominal_parameters(plant->spec())}};
  evaluation.starts = {random_starts()};
  evaluation.episodes = 3;
  const MetricSet set;
  const auto policy = zero_policy(4, 1);

  evaluate(evaluation, *policy, [&](const EpisodeIndex&, const Episode& episode) {
    for (std::size_t i = 0; i < set.size(); ++i) {
      CAPTURE(set.name(i));
      CHECK(std::isfinite(set[i].value(episode)));
    }
  });
}

void check_bits_of_any_number_of_lanes(const std::string& waveform) {
  const auto plant = standard(plants(), "cartpole");
  std::vector<Injection> injections;
  injections.push_back(read_injection(
      Table{{{"site", {std::string("dynamics"), {"test"}}}, {"waveform", {waveform, {"test"}}}}, {"test"}},
      plant->spec()));
  const PlantLoops loops(plant.object, {});
  Evaluation evaluation;
  evaluation.source = &loops;
  evaluation.injections = injections;
  evaluation.cells = {{{0.1}, nominal_parameters(plant->spec())}, {{0.4}, nominal_parameters(plant->spec())}};
  evaluation.starts = loops.starts();
  evaluation.episodes = 9;
  const auto policy = zero_policy(4, 1);

  std::vector<double> returns[3];
  const std::size_t lanes[] = {1, 7, 256};
  for (int i = 0; i < 3; ++i) {
    evaluate(
        evaluation, *policy,
        [&](const EpisodeIndex&, const Episode& episode) { returns[i].push_back(episode.whole.return_sum); }, lanes[i]);
  }

  CHECK(returns[0].size() == 36);
  CHECK(returns[0] == returns[1]);
  CHECK(returns[0] == returns[2]);
  const EpisodeIndex last{1, 1, 8};  // by itself, as a kept episode is run again
  double reward = 0;
  for (const double step : trace_episode(evaluation, *policy, last).reward) reward += step;
  CHECK(reward == doctest::Approx(returns[0].back()).epsilon(1e-14));
}

TEST_CASE("an evaluation gives equal bits for any number of lanes at a time, under every waveform") {
  for (const std::string& name : waveforms().names()) {
    CAPTURE(name);
    check_bits_of_any_number_of_lanes(name);
  }
}

TEST_CASE("every agent resumes from its own state as if it had not stopped") {
  const auto plant = standard(plants(), "cartpole");
  for (const std::string& name : agents().names()) {
    CAPTURE(name);
    const Table options{{{"kind", {name, {"test"}}},
                         {"steps", {std::int64_t{4'000}, {"test"}}},
                         {"hidden", {std::int64_t{32}, {"test"}}}},
                        {"test"}};
    const auto agent = agents().make(options);
    const TrainingTask task{plant.object.get(), {}, {}, 1};

    const auto whole = agent->start(task);
    while (!whole->done()) whole->advance();
    auto first = agent->start(task);
    while (first->steps() < 2'000) first->advance();
    const std::string saved = first->save();
    const auto second = agent->start(task);
    second->load(saved);
    while (!second->done()) second->advance();

    CHECK(whole->failure().empty());
    CHECK(second->save() == whole->save());
    CHECK_THROWS_AS(agent->start(task)->load("nonsense"), Error);
  }
}
