#include "gust/setup/setup.h"

#include <doctest/doctest.h>

#include "gust/setup/presets.h"
#include "gust/setup/toml.h"

namespace gust {
namespace {

Setup setup_of(const std::string& text) {
  const Table table = parse_toml(text, "s.toml");
  const Value* readings = table.find("readings");
  return make_setup(table.find("plant")->as_table("plant"), readings ? &readings->as_table("readings") : nullptr);
}

std::string error_of(const std::string& text) {
  try {
    setup_of(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST_CASE("a setup without a preset is scg-2022, which the cart-pole's own defaults equal") {
  const Setup setup = setup_of("plant = { kind = \"cartpole\" }\n");

  CHECK(setup.preset == "scg-2022");
  CHECK(setup.plant.canonical() == plants().at("cartpole").make(Table{}).canonical());
  CHECK(canonical_fields(setup.readings) == canonical_fields(Readings{}));
}

TEST_CASE("scg-default charges the disturbed action and lets the policy act in newton at 50 Hz") {
  const Setup setup = setup_of("plant = { kind = \"cartpole\", preset = \"scg-default\" }\n");

  const PlantSpec& spec = setup.plant->plant()->spec();
  CHECK(spec.physics_rate == 50.0);
  CHECK(spec.action_unit() == "N");
  CHECK(spec.action_scale == std::vector<double>{1.0});
  CHECK(spec.state_weights == std::vector<double>{1, 1, 1, 1});
  CHECK(spec.start_range == std::vector<double>{0.05, 0.05, 0.05, 0.05});
  CHECK(setup.readings.effort == "disturbed");
}

TEST_CASE("options of a study replace those of the preset and leave the others alone") {
  const Setup setup = setup_of(
      "plant = { kind = \"cartpole\", preset = \"scg-default\", pole_length = 0.25 }\n"
      "readings = { effort = \"applied\" }\n");

  const PlantSpec& spec = setup.plant->plant()->spec();
  CHECK(spec.parameters[0].nominal == 0.25);
  CHECK(spec.parameters[2].nominal == 1.0);
  CHECK(spec.control_rate == 50.0);
  CHECK(setup.readings.effort == "applied");
  CHECK(setup.readings.saturate == "after");
}

TEST_CASE("the tap point among the readings is the plant's, however it was said") {
  const Setup by_readings = setup_of("plant = { kind = \"cartpole\" }\nreadings = { tap_point = \"tip\" }\n");
  const Setup by_plant = setup_of("plant = { kind = \"cartpole\", tap_point = \"tip\" }\n");

  CHECK(by_readings.plant.canonical().find("tap_point = \"tip\"") != std::string::npos);
  CHECK(by_plant.plant.canonical() == by_readings.plant.canonical());
  CHECK(by_plant.readings.tap_point == "tip");
  CHECK(error_of("plant = { kind = \"cartpole\", tap_point = \"tip\" }\nreadings = { tap_point = \"com\" }\n") ==
        "s.toml:1:42: 'tap_point' is 'tip' here and 'com' among the readings; say it once");
}

TEST_CASE("mistakes in a setup are told with their place and the nearest name") {
  CHECK(error_of("plant = { preset = \"scg-2022\" }\n") == "s.toml:1:9: a plant needs a 'kind': cartpole, quadrotor");
  CHECK(error_of("plant = { kind = \"cartpol\" }\n") ==
        "s.toml:1:18: unknown plant 'cartpol'; did you mean 'cartpole'? (gust list plants)");
  CHECK(error_of("plant = { kind = \"cartpole\", preset = \"scg-2202\" }\n") ==
        "s.toml:1:39: unknown preset 'scg-2202'; did you mean 'scg-2022'?; the presets of cartpole are scg-2022, "
        "scg-default");
  CHECK(error_of("plant = { kind = \"cartpole\", pole_lenght = 1 }\n") ==
        "s.toml:1:44: unknown key 'pole_lenght' in the plant cartpole; did you mean 'pole_length'?");
  CHECK(error_of("[plant]\nkind = \"cartpole\"\npole_length = -1\n") ==
        "s.toml:3:15: 'pole_length' must be > 0, got -1");
  CHECK(error_of("[plant]\nkind = \"cartpole\"\npole_length = nan\n") ==
        "s.toml:3:15: 'pole_length' must be a finite number, got nan");
  CHECK(error_of("[plant]\nkind = \"cartpole\"\nphysics_rate = 75\n").substr(0, 12) == "s.toml:1:1: ");
  CHECK(error_of("plant = { kind = \"cartpole\" }\n[readings]\nefort = \"applied\"\n") ==
        "s.toml:3:9: unknown key 'efort' in readings; did you mean 'effort'?");
  CHECK(error_of("plant = { kind = \"cartpole\" }\n[readings]\neffort = \"aplied\"\n") ==
        "s.toml:3:10: 'effort' must be one of commanded, disturbed, applied, got 'aplied'; did you mean 'applied'?");
}

TEST_CASE("every preset of every plant makes a setup and says all of its options") {
  for (const Entry<Plant>& entry : plants().entries()) {
    for (const std::string& name : preset_names(entry.name)) {
      CAPTURE(name);
      const Preset& preset = preset_at(name, entry.name);
      const Table options = preset_part(preset, entry.name, "plant");
      const Table readings = preset_part(preset, entry.name, "readings");

      Table plant;
      plant.set("kind", {entry.name, {}});
      plant.set("preset", {name, {}});
      CHECK_NOTHROW(make_setup(plant));
      for (const FieldInfo& field : entry.fields) CHECK((field.name == "tap_point" || options.contains(field.name)));
      for (const std::string& field : field_names<Readings>()) CHECK(readings.contains(field));
      CHECK_FALSE(preset.summary.empty());
    }
  }
}

}  // namespace
}  // namespace gust
