#include "gust/disturb/injection.h"

#include <doctest/doctest.h>

#include "gust/disturb/waveform_fixture_test.h"
#include "gust/sim/plant.h"

using namespace gust;

namespace {

/// The spec of a plant with four states, one action and two forces, 10 control steps at 50 Hz.
const PlantSpec& spec() {
  static const Made<Plant> plant =
      plants().at("cartpole").make(Table{{{"steps", Value{std::int64_t{10}, {}}}}, {"test"}});
  return plant->spec();
}

using Items = std::vector<std::pair<std::string, Value>>;

Value table(Items items) { return {Table{std::move(items), {"study.toml", 5, 1}}, {"study.toml", 5, 1}}; }

Injection injection(Items items) {
  for (auto& item : items) item.second.place = {"study.toml", 5, 3};
  return read_injection(Table{std::move(items), {"study.toml", 5, 1}}, spec());
}

std::string error_of(Items items) {
  try {
    injection(std::move(items));
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

/// A disturbance of a site by a waveform with its defaults.
Injection at(const char* site, const char* kind) { return injection({{"site", word(site)}, {"waveform", word(kind)}}); }

std::vector<double> channel(const Signals& signals, std::size_t injection, std::size_t channel) {
  const double* values = signals.channel(injection, channel);
  return {values, values + spec().steps + 1};
}

std::vector<Injection> list(Injection a) {
  std::vector<Injection> all;
  all.push_back(std::move(a));
  return all;
}
std::vector<Injection> list(Injection a, Injection b) {
  std::vector<Injection> all = list(std::move(a));
  all.push_back(std::move(b));
  return all;
}

}  // namespace

TEST_CASE("a site disturbs the state as observed, the action, or the external force") {
  CHECK(channels_of(Site::kObservation, spec()).size() == 4);
  CHECK(channels_of(Site::kAction, spec()).size() == 1);
  CHECK(channels_of(Site::kDynamics, spec()).size() == 2);
  for (const Site site : kSites) CHECK(site_from(site_name(site), {}) == site);
}

TEST_CASE("without channels all are disturbed alike; names, lists, factors and masks choose") {
  const auto factors = [](const char* key, Value value) {
    return injection({{"site", word("dynamics")}, {"waveform", word("step")}, {key, std::move(value)}}).factors;
  };

  CHECK(at("dynamics", "step").factors == std::vector<double>{1, 1});
  CHECK(factors("channels", word("all")) == std::vector<double>{1, 1});
  CHECK(factors("channels", word("fz")) == std::vector<double>{0, 1});
  CHECK(factors("channels", {Value::List{word("fz"), word("fx")}, {}}) == std::vector<double>{1, 1});
  CHECK(factors("channels", table({{"fx", number(1)}, {"fz", number(-0.5)}})) == std::vector<double>{1, -0.5});
  CHECK(factors("mask", word("10")) == std::vector<double>{1, 0});
  CHECK(factors("mask", steps(10)) == std::vector<double>{1, 0});
  CHECK(factors("mask", {Value::List{steps(0), steps(1)}, {}}) == std::vector<double>{0, 1});
}

TEST_CASE("what a disturbance cannot be is one clear error") {
  const auto also = [](Items more) {
    Items items = {{"site", word("observation")}, {"waveform", word("sine")}};
    items.insert(items.end(), more.begin(), more.end());
    return error_of(std::move(items));
  };

  CHECK(error_of({{"site", word("acton")}, {"waveform", word("sine")}}) ==
        "study.toml:5:3: unknown site 'acton'; did you mean 'action'?; sites are observation, action, dynamics");
  CHECK(error_of({{"site", word("action")}, {"waveform", word("sawtoth")}}) ==
        "study.toml:5:3: unknown waveform 'sawtoth'; did you mean 'sawtooth'? (gust list waveforms)");
  CHECK(error_of({{"waveform", word("sine")}}) ==
        "study.toml:5:1: a disturbance needs a 'site': observation, action or dynamics");
  CHECK(error_of({{"site", word("action")}}) ==
        "study.toml:5:1: a disturbance needs a 'waveform' (gust list waveforms) or an 'effect' (gust list effects)");
  CHECK(also({{"chanels", word("x")}}) ==
        "study.toml:5:3: unknown key 'chanels' in a disturbance; did you mean 'channels'?");
  CHECK(
      also({{"channels", word("theta_do")}}) ==
      "study.toml:5:3: unknown channel 'theta_do'; did you mean 'theta_dot'?; the site has x, x_dot, theta, theta_dot");
  CHECK(also({{"mask", word("10")}}) == "study.toml:5:3: 'mask' must have 4 entries, one a channel, got 2");
  CHECK(also({{"mask", word("1020")}}) == "study.toml:5:3: 'mask' must be made of 0 and 1, got '1020'");
  CHECK(also({{"start", steps(11)}}) == "study.toml:5:3: 'start' must lie within the episode, 0 to 9, got 11");
  CHECK(also({{"end", steps(11)}}) == "study.toml:5:3: 'end' must lie within the episode, 0 to 10, got 11");
  CHECK(also({{"start", steps(-1)}}) == "study.toml:5:3: 'start' must lie within the episode, 0 to 9, got -1");
  CHECK(also({{"start", steps(4)}, {"end", steps(4)}}) == "study.toml:5:3: 'end' must be after 'start', got 4 and 4");
  CHECK(also({{"start", steps(10)}}) == "study.toml:5:3: 'start' must lie within the episode, 0 to 9, got 10");
  CHECK(error_of({{"site", word("action")}, {"waveform", table({{"kind", word("step")}, {"offset", steps(10)}})}}) ==
        "study.toml:5:3: the waveform's 'offset' must lie within the episode of 10 control steps, got 10");
}

TEST_CASE("the canonical text tells all but the level") {
  Injection a =
      injection({{"site", word("dynamics")}, {"waveform", word("step")}, {"mask", word("10")}, {"level", number(3)}});

  CHECK(a.canonical() == "dynamics step(offset = 2) channels [1, 0] during [0, end)");
  CHECK(a.level == 3);
  a.start = 3;
  a.end = 7;
  CHECK(a.canonical() == "dynamics step(offset = 2) channels [1, 0] during [3, 7)");
}

TEST_CASE("at the action and dynamics sites index k holds the value of control step k, per channel") {
  const std::vector<Injection> all = list(injection({{"site", word("dynamics")},
                                                     {"waveform", word("impulse")},
                                                     {"channels", table({{"fx", number(2)}, {"fz", number(-1)}})}}));

  const Signals signals(all, spec(), Rng(1));

  CHECK(channel(signals, 0, 0) == std::vector<double>{0, 0, 2, 2, 0, 0, 0, 0, 0, 0, 0});
  CHECK(channel(signals, 0, 1) == std::vector<double>{0, 0, -1, -1, 0, 0, 0, 0, 0, 0, 0});
}

TEST_CASE("the observations of reset and of the first step both see step 0: d(max(k - 1, 0))") {
  const std::vector<Injection> all = list(at("observation", "step"), at("observation", "sawtooth"));

  const Signals signals(all, spec(), Rng(1));

  // Offset 2 first shows in the observation that the third step returns.
  CHECK(channel(signals, 0, 0) == std::vector<double>{0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1});
  const std::vector<double> wave = values_of(waveform("sawtooth"), 10);
  const std::vector<double> seen = channel(signals, 1, 2);
  CHECK(seen[0] == wave[0]);
  for (std::size_t k = 1; k <= 10; ++k) CHECK(seen[k] == wave[k - 1]);
}

TEST_CASE("random waveforms at the observation site are indexed by the number of the observation") {
  const std::vector<Injection> all = list(at("observation", "white"));
  const Rng episode(9);

  const Signals signals(all, spec(), episode);

  for (std::size_t c = 0; c < 4; ++c) {
    const Rng stream = episode.split("observation").split(0).split(c);
    for (std::size_t k = 0; k <= 10; ++k) CHECK(channel(signals, 0, c)[k] == stream.normal(k));
  }
}

TEST_CASE("a window silences the waveform outside and does not move it") {
  Injection bounded = at("action", "sawtooth");
  bounded.start = 2;
  bounded.end = 5;
  const std::vector<Injection> all = list(std::move(bounded), at("action", "sawtooth"));

  const Signals signals(all, spec(), Rng(1));

  const std::vector<double> free = channel(signals, 1, 0);
  for (std::size_t k = 0; k <= 10; ++k) CHECK(channel(signals, 0, 0)[k] == (k >= 2 && k < 5 ? free[k] : 0.0));
}

TEST_CASE("a window at the observation site is counted in control steps, like the shape") {
  Injection bounded = at("observation", "constant");
  bounded.start = 0;
  bounded.end = 2;
  Injection late = at("observation", "constant");
  late.start = 1;
  const std::vector<Injection> all = list(std::move(bounded), std::move(late));

  const Signals signals(all, spec(), Rng(1));

  CHECK(channel(signals, 0, 0) == std::vector<double>{1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0});
  CHECK(channel(signals, 1, 0) == std::vector<double>{0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1});
}

TEST_CASE("adding a disturbance moves no other's noise") {
  const std::vector<Injection> alone = list(at("dynamics", "white"));
  std::vector<Injection> among = list(at("observation", "white"), at("action", "uniform"));
  among.push_back(at("dynamics", "white"));
  among.push_back(at("dynamics", "white"));
  const Rng episode(21);

  const Signals one(alone, spec(), episode);
  const Signals many(among, spec(), episode);

  for (std::size_t c = 0; c < 2; ++c) {
    CHECK(channel(many, 2, c) == channel(one, 0, c));
    CHECK(channel(many, 3, c) != channel(one, 0, c));
  }
  CHECK(channel(one, 0, 0) != channel(one, 0, 1));  // every channel has its own stream
}

TEST_CASE("leaving a channel out does not move the noise of the others") {
  Injection masked = injection({{"site", word("dynamics")}, {"waveform", word("white")}, {"mask", word("01")}});
  const Rng episode(22);

  const Signals all(list(at("dynamics", "white")), spec(), episode);
  const Signals one(list(std::move(masked)), spec(), episode);

  CHECK(channel(one, 0, 1) == channel(all, 0, 1));
  CHECK(channel(one, 0, 0) == std::vector<double>(11, 0.0));
}

TEST_CASE("signals are at level 1, so that noise scales linearly along the levels") {
  Injection weak = at("action", "white");
  Injection strong = at("action", "white");
  weak.level = 0.1;
  strong.level = 10;

  const Signals a(list(std::move(weak)), spec(), Rng(5));
  const Signals b(list(std::move(strong)), spec(), Rng(5));

  CHECK(channel(a, 0, 0) == channel(b, 0, 0));
}

TEST_CASE("a wave at or above half the control rate is an error that says what sampling makes of it") {
  const auto error = [](const char* kind, double frequency) {
    return error_of(
        {{"site", word("action")}, {"waveform", table({{"kind", word(kind)}, {"frequency", number(frequency)}})}});
  };
  const std::string right = "; its frequency must be below 25 Hz, half the control rate";

  CHECK(error("sine", 24.9).empty());
  CHECK(error("sine", 50).ends_with("a sine of 50 Hz is sampled at 50 Hz: it vanishes" + right));
  CHECK(error("triangle", 49).ends_with("a triangle of 49 Hz is sampled at 50 Hz: it acts as one of 1 Hz" + right));
  CHECK(error("sawtooth", 125)
            .ends_with("a sawtooth of 125 Hz is sampled at 50 Hz: two samples a period leave nothing of its shape" +
                       right));
}

TEST_CASE("every waveform with a frequency is held to the control rate, and no other") {
  for (const Entry<Waveform>& entry : waveforms().entries()) {
    CAPTURE(entry.name);
    const bool periodic =
        std::ranges::any_of(entry.fields, [](const FieldInfo& field) { return field.name == "frequency"; });

    CHECK((waveform(entry.name)->frequency() > 0) == periodic);
    if (!periodic) continue;
    const auto with = [&](double frequency) {
      return error_of({{"site", word("observation")},
                       {"waveform", table({{"kind", word(entry.name)}, {"frequency", number(frequency)}})}});
    };
    CHECK(with(24).empty());
    CHECK(with(25).find("half the control rate") != std::string::npos);
  }
}

/// A ramp of a site at a level, with one factor a channel.
SignalSequence ramps(const std::vector<Injection>& all, double level) {
  return {all, spec(), std::vector<double>(all.size(), level), Rng(31)};
}

TEST_CASE("a wave that goes on has one value a control step of each episode, and one an observation at that site") {
  for (const auto& [site, calls] : {std::pair{"dynamics", 10}, {"action", 10}, {"observation", 11}}) {
    CAPTURE(site);
    const std::vector<Injection> all = list(at(site, "scg_ramp"));
    SignalSequence sequence = ramps(all, 1e6);
    double end = 0;
    for (std::int64_t episode = 0; episode < 5; ++episode) {
      const Rng stream = Rng(31).split(static_cast<std::uint64_t>(episode)).split(site).split(0).split(0);
      const std::vector<double> values = channel(*sequence.at(episode), 0, 0);
      for (int k = 0; k < calls; ++k) {
        end += 0.01 * std::abs(stream.normal(static_cast<std::uint64_t>(k)));
        CHECK(values[static_cast<std::size_t>(k)] == doctest::Approx(end).epsilon(1e-14));
      }
    }
  }
}

TEST_CASE("the waves of an episode depend on its number, not on which were asked for before") {
  const std::vector<Injection> all = list(at("dynamics", "scg_ramp"), at("observation", "white"));
  SignalSequence in_order = ramps(all, 0.2);
  std::vector<std::vector<double>> values;
  for (std::int64_t episode = 0; episode < 6; ++episode) values.push_back(channel(*in_order.at(episode), 0, 1));

  for (const std::int64_t episode : {5, 2, 2, 3, 0}) {
    SignalSequence alone = ramps(all, 0.2);
    CHECK(channel(*alone.at(episode), 0, 1) == values[static_cast<std::size_t>(episode)]);
    CHECK(channel(*in_order.at(episode), 0, 1) == values[static_cast<std::size_t>(episode)]);
  }
  CHECK(values[0] != values[1]);
}

TEST_CASE("a ramp turns at the level of its own injection, and factors give its channels their signs") {
  const std::vector<Injection> all = list(injection({{"site", word("dynamics")},
                                                     {"waveform", word("scg_ramp")},
                                                     {"mask", {std::vector<Value>{number(-1), number(1)}, {"test"}}}}),
                                          at("dynamics", "scg_ramp"));
  const std::vector<double> levels = {0.0, 1e6};

  const Signals signals(all, spec(), Rng(4), {levels});

  CHECK(channel(signals, 0, 0) == std::vector<double>(11, -0.01));
  CHECK(channel(signals, 0, 1) == std::vector<double>(11, 0.01));
  CHECK(channel(signals, 1, 0)[9] > 0.02);
  CHECK(all[0].factor(7.0) == 1.0);
  CHECK(at("action", "white").factor(7.0) == 7.0);
  CHECK_FALSE(all_scale(all));
}
