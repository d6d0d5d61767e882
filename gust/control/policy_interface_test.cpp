#include "gust/control/policy_interface.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "gust/sim/plant.h"

using namespace gust;

namespace {

Made<Plant> plant(const std::string& kind, std::vector<std::pair<std::string, Value>> options = {}) {
  return plants().at(kind).make(Table{std::move(options), {}});
}

Value text(const std::string& words) { return {words, {"s.toml", 1, 1}}; }

Value table(std::vector<std::pair<std::string, Value>> items) {
  return {Table{std::move(items), {"s.toml", 1, 1}}, {"s.toml", 1, 1}};
}

PolicyInterface interface_of(const char* key, Value value, const PlantSpec& spec) {
  return read_interface(Table{{{key, std::move(value)}}, {}}, spec);
}

/// Gives its observations back as they are: as many actions as it sees numbers.
class Mirror final : public Policy {
 public:
  explicit Mirror(std::size_t numbers) : numbers_(numbers) {}
  std::size_t observations() const override { return numbers_; }
  std::size_t actions() const override { return numbers_; }
  void act(Rows<const double> observation, std::span<const std::int64_t>, Rows<double> action) override {
    for (std::size_t i = 0; i < numbers_; ++i) std::ranges::copy(observation.row(i), action.row(i).begin());
  }

 private:
  std::size_t numbers_;
};

/// What a policy of this interface sees of one observation.
std::vector<double> seen(const PolicyInterface& interface, const PlantSpec& spec, std::vector<double> observed) {
  const std::size_t numbers = interface.observe.size();
  const auto policy = translated_policy(std::make_unique<Mirror>(numbers), {.observe = interface.observe}, spec);
  Matrix<double> observation(observed.size(), 1), action(numbers, 1);
  for (std::size_t i = 0; i < observed.size(); ++i) observation.at(i, 0) = observed[i];
  policy->act(observation.view(), std::vector<std::int64_t>(1), action.view());
  std::vector<double> result;
  for (std::size_t i = 0; i < numbers; ++i) result.push_back(action.at(i, 0));
  return result;
}

std::string error_of(const char* key, Value value, const PlantSpec& spec) {
  try {
    interface_of(key, std::move(value), spec);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace

TEST_CASE("a policy sees the components that are named, in their order, sign, unit and scale") {
  const auto cartpole = plant("cartpole");
  const PlantSpec& spec = cartpole->spec();
  const Value list = {
      Value::List{text("theta"),
                  text("-x_dot"),
                  text("x=cm"),
                  table({{"theta", text("deg")}}),
                  table({{"theta_dot", {2.5, {}}}}),
                  text("sin theta"),
                  text("-cos theta"),
                  table({{"-x", table({{"unit", text("mm")}, {"scale", {2.0, {}}}, {"offset", {1.0, {}}}})}}),
                  {std::int64_t{3}, {}}},
      {}};

  const std::vector<double> got = seen(interface_of("observe", list, spec), spec, {0.5, 0.25, 1.0, -2.0});

  REQUIRE(got.size() == 9);
  CHECK(got[0] == 1.0);
  CHECK(got[1] == -0.25);
  CHECK(got[2] == 50.0);
  CHECK(got[3] == doctest::Approx(180 / std::numbers::pi).epsilon(1e-15));
  CHECK(got[4] == -5.0);
  CHECK(got[5] == doctest::Approx(std::sin(1.0)).epsilon(1e-15));
  CHECK(got[6] == doctest::Approx(-std::cos(1.0)).epsilon(1e-15));
  CHECK(got[7] == -999.0);
  CHECK(got[8] == 3.0);
}

TEST_CASE("references ahead are components as well") {
  const auto quadrotor = plant("quadrotor", {{"horizon", {std::int64_t{2}, {}}}});
  const PlantSpec& spec = quadrotor->spec();
  std::vector<double> observation(spec.observations());
  for (std::size_t i = 0; i < observation.size(); ++i) observation[i] = static_cast<double>(i);

  const Value list = {Value::List{text("z"), text("z_ref"), text("theta_dot_ref2")}, {}};

  CHECK(seen(interface_of("observe", list, spec), spec, observation) == std::vector<double>{2, 8, 17});
}

TEST_CASE("what is gust's own order and unit leaves no trace") {
  const auto cartpole = plant("cartpole");
  const PlantSpec& spec = cartpole->spec();
  const Value own = {Value::List{text("x"), text("x_dot"), text("theta=rad"), text("theta_dot")}, {}};

  CHECK(interface_of("observe", own, spec).canonical(spec).empty());
  CHECK(interface_of("units", text("normalised"), spec).canonical(spec).empty());
  CHECK(interface_of("units", text("normalised"), spec).says_unit);
  CHECK(interface_of("observe", {Value::List{text("theta"), text("-x")}, {}}, spec).canonical(spec) ==
        "observe theta 1 0, x -1 0\n");
  CHECK(interface_of("act", table({{"scale", {-1.0, {}}}}), spec).canonical(spec) == "act -1 0\n");
}

TEST_CASE("an action in newtons becomes the preset's, and the same in both ways of saying it") {
  const auto cartpole = plant("cartpole", {{"force_limit", {10.0, {}}}});
  const auto newton = plant("cartpole", {{"normalized_action", {false, {}}}});

  CHECK(interface_of("units", text("N"), cartpole->spec()).act == std::vector<GivenNumber>{{0.1, 0}});
  CHECK(interface_of("act", text("N"), cartpole->spec()).act == std::vector<GivenNumber>{{0.1, 0}});
  const Value turned = table({{"unit", text("mN")}, {"scale", {-2.0, {}}}});
  CHECK(interface_of("act", turned, cartpole->spec()).act.front().scale == doctest::Approx(-2e-4).epsilon(1e-15));
  CHECK(interface_of("units", text("N"), newton->spec()).act.empty());
}

TEST_CASE("a thrust in newtons is what the rotors of a normalised quadrotor give") {
  const auto quadrotor = plant("quadrotor");
  const PlantSpec& spec = quadrotor->spec();
  REQUIRE(spec.normalized_action);

  const PolicyInterface interface = interface_of("units", text("N"), spec);

  for (std::size_t i = 0; i < 2; ++i) {
    const GivenNumber& given = interface.act[i];
    const double preset = given.scale * 0.14 + given.offset;  // what 0.14 N is for the loop
    CHECK(spec.action_offset[i] + spec.action_scale[i] * preset == doctest::Approx(0.14).epsilon(1e-14));
  }
}

TEST_CASE("a NaN that is observed stays in its number and its lane") {
  const auto cartpole = plant("cartpole");
  const PlantSpec& spec = cartpole->spec();
  const Value list = {Value::List{text("theta"), text("x")}, {}};

  const auto got = seen(interface_of("observe", list, spec), spec, {1, 0, std::numeric_limits<double>::quiet_NaN(), 0});

  CHECK(std::isnan(got[0]));
  CHECK(got[1] == 1.0);
}

TEST_CASE("a mistake in an interface is an error that says what would be right") {
  const auto cartpole = plant("cartpole");
  const PlantSpec& spec = cartpole->spec();
  const auto newton = plant("cartpole", {{"normalized_action", {false, {}}}});

  CHECK(error_of("observe", text("thata"), spec) ==
        "s.toml:1:1: 'observe': unknown component 'thata'; did you mean 'theta'?; components are x, x_dot, theta, "
        "theta_dot");
  CHECK(error_of("observe", text("theta=cm"), spec).find("'cm' is no unit of theta [rad]") != std::string::npos);
  CHECK(error_of("observe", text("sin x"), spec).find("sin and cos are of angles; x is in m") != std::string::npos);
  CHECK(error_of("observe", table({{"x", text("m")}, {"theta", text("deg")}}), spec).find("'observe' must be a list") !=
        std::string::npos);
  CHECK(error_of("observe", {Value::List{}, {}}, spec).find("must name 1 to") != std::string::npos);
  CHECK(error_of("observe", {Value::List{{1.0, {}}}, {}}, spec).find("at least one component") != std::string::npos);
  CHECK(error_of("act", table({{"scale", {0.0, {}}}}), spec).find("'scale' must not be 0") != std::string::npos);
  CHECK(error_of("act", table({{"unti", text("N")}}), spec).find("did you mean 'unit'?") != std::string::npos);
  CHECK(error_of("units", text("Nm"), spec).find("'Nm' is no unit of the action force [N]") != std::string::npos);
  CHECK(error_of("units", text("normalised"), newton->spec()).find("give act = { scale = … }") != std::string::npos);
  const Table both{{{"units", text("N")}, {"act", text("N")}}, {}};
  CHECK_THROWS_AS(read_interface(both, spec), Error);
}
