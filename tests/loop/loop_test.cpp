// A loop that is no plant: what it measures, and what is said where something needs more than it tells.
#include <doctest/doctest.h>

#include <cmath>

#include "gust/eval/evaluate.h"
#include "gust/eval/metric.h"
#include "gust/setup/setup.h"

using namespace gust;

namespace {

Value text(const std::string& word) { return {word, {"test"}}; }

Setup thermostat(std::vector<std::pair<std::string, Value>> options = {}) {
  Table table{{{"kind", text("thermostat")}}, {"test"}};
  for (auto& [key, value] : options) table.set(key, value);
  return make_setup(table);
}

Injection injection(const Setup& setup, const std::string& site, const std::string& waveform) {
  return read_injection(Table{{{"site", text(site)}, {"waveform", text(waveform)}}, {"test"}}, setup.plant->spec());
}

std::string error_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

/// Noise of the sensor at two levels and of the heater at one, from both starts.
struct Scene {
  Setup setup = thermostat();
  std::vector<Injection> injections = {injection(setup, "observation", "white"), injection(setup, "action", "white")};
  Evaluation evaluation{.source = setup.plant.object.get(), .injections = injections};

  Scene() {
    const std::vector<double> parameters = nominal_parameters(setup.plant->spec());
    evaluation.cells = {{{0.5, 100.0}, parameters}, {{2.0, 100.0}, parameters}};
    evaluation.starts = setup.plant->starts();
    evaluation.episodes = 9;
    evaluation.root = Rng(3);
  }
};

/// Heats more the colder the sensor is.
class Proportional final : public Policy {
 public:
  std::size_t observations() const override { return 1; }
  std::size_t actions() const override { return 1; }
  void act(Rows<const double> observation, std::span<const std::int64_t>, Rows<double> action) override {
    for (std::size_t lane = 0; lane < action.lanes; ++lane) action.at(0, lane) = 0.2 * (20.0 - observation.at(0, lane));
  }
};

}  // namespace

TEST_CASE("a room without control cools as the closed form of its recurrence says") {
  const Setup setup = thermostat();
  const std::unique_ptr<Loop> loop = setup.plant->make({}, 1);
  loop->begin(0, {.state = {18.0}, .parameters = {5000, 25, 20}, .levels = {}, .signals = nullptr});
  const Matrix<double> half(1, 1, 0.0);  // 500 W, which hold 20 degrees

  for (int k = 0; k < 100; ++k) loop->step(half.view());

  const double room = 20.0 - 2.0 * std::pow(1 - 25.0 / 5000, 100);
  CHECK(loop->record().reward[0] == doctest::Approx(std::exp(-std::pow((room - 20) / 2, 2))).epsilon(1e-12));
  CHECK(loop->record().state.rows == 0);
  CHECK(loop->record().force.rows == 0);
  CHECK(loop->observation().at(0, 0) < room);  // the sensor lags
  CHECK(loop->steps_done()[0] == 100);
}

TEST_CASE("the evaluation of a loop gives equal bits for any number of lanes, and its trace is that of the episode") {
  const Scene scene;
  Proportional policy;
  std::vector<double> returns[3];
  const std::size_t lanes[] = {1, 5, 64};

  for (int i = 0; i < 3; ++i) {
    evaluate(
        scene.evaluation, policy,
        [&](const EpisodeIndex&, const Episode& episode) { returns[i].push_back(episode.ended.return_sum); }, lanes[i]);
  }

  CHECK(returns[0].size() == 2 * 2 * 9);
  CHECK(returns[0] == returns[1]);
  CHECK(returns[0] == returns[2]);
  const Trace trace = trace_episode(scene.evaluation, policy, {1, 1, 8});
  double sum = 0;
  for (const double reward : trace.reward) sum += reward;
  CHECK(trace.failed_at == -1);
  CHECK(sum == doctest::Approx(returns[0].back()).epsilon(1e-14));
  CHECK(trace.state.rows() == 0);
  CHECK(trace.observation.rows() == 1);
  CHECK(trace.observation.lanes() == 301);
}

TEST_CASE("a disturbance of the sensor reaches the policy, and not the reward of a policy that does not look") {
  const Scene scene;
  const std::unique_ptr<Policy> blind = zero_policy(1, 1);
  std::vector<double> returns;

  evaluate(scene.evaluation, *blind,
           [&](const EpisodeIndex&, const Episode& episode) { returns.push_back(episode.ended.return_sum); });

  CHECK(std::equal(returns.begin(), returns.begin() + 18, returns.begin() + 18));  // both levels of the sensor's noise
  const Trace trace = trace_episode(scene.evaluation, *blind, {1, 0, 0});
  const auto signals = episode_signals(scene.evaluation, {1, 0, 0});
  CHECK(trace.observation.at(0, 0) == 20.0 + 2.0 * signals->channel(0, 0)[0]);
  CHECK(trace.disturbed.at(0, 7) == 500.0 + 100.0 * signals->channel(1, 0)[7]);
}

TEST_CASE("metrics that need what the loop does not tell are not applicable, and none of them is 0") {
  const Setup setup = thermostat();
  const MetricSet metrics(setup.plant->spec());
  std::vector<std::string> names;
  for (std::size_t i = 0; i < metrics.size(); ++i) names.push_back(metrics.name(i));

  for (const char* told :
       {"anr", "anr_h", "anr_nt", "return_sum", "length", "survival", "time_to_failure", "saturation"})
    CHECK(std::ranges::count(names, told) == 1);
  for (const char* untold : {"rmse_paper", "rmse_scg", "rmse_sum", "squared_state_sum", "max_abs_x", "ground_contact"})
    CHECK(std::ranges::count(names, untold) == 0);
  CHECK(error_of([&] {
          metrics.index("rmse_scg", {"s.toml", 3, 4});
        }) == "s.toml:3:4: the metric 'rmse_scg' is not applicable: the plant tells no goal");
  CHECK(metrics.not_applicable().find("squared_state_sum (no true state)") != std::string::npos);
}

TEST_CASE("the name of a loop's trials is made of its own options, without preset and readings") {
  const Setup setup = thermostat({{"lag", {5.0, {"test"}}}});

  CHECK(setup.canonical() == "plant thermostat(power = 1000, capacity = 5000, loss = 25, lag = 5, steps = 300)\n");
  CHECK(setup.readings_text().empty());
}

TEST_CASE("what needs equations of motion, a site or readings says so in one sentence") {
  const Setup setup = thermostat();

  CHECK(error_of([&] {
          setup.equations("lqr", {"s.toml", 2, 3});
        }) ==
        "s.toml:2:3: lqr needs the equations of motion of a plant, and 'thermostat' has none; choose a policy that "
        "acts on observations alone");
  CHECK(error_of([&] { injection(setup, "dynamics", "step"); }) ==
        "test: the plant has no site 'dynamics'; its sites are observation, action");
  const Table readings{{{"effort", {std::string("applied"), {"s.toml", 4, 5}}}}, {"s.toml", 4, 1}};
  CHECK(error_of([&] {
          make_setup(Table{{{"kind", text("thermostat")}}, {"test"}}, &readings);
        }) == "s.toml:4:5: readings are for plants with equations of motion; 'thermostat' is none");
  CHECK(error_of([&] {
          thermostat({{"lagg", {1.0, {"s.toml", 1, 9}}}});
        }) == "s.toml:1:9: unknown key 'lagg' in thermostat; did you mean 'lag'?");
  CHECK(error_of([&] {
          make_setup(Table{{{"kind", text("thermostatt")}}, {"test"}});
        }) == "test: unknown plant 'thermostatt'; did you mean 'thermostat'? (gust list plants)");
}
