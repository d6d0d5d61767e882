#include "gust/control/validate.h"

#include <algorithm>
#include <cmath>

#include "gust/control/recording_files_test.h"

using namespace gust;

namespace {

double worst(const std::vector<WorstError>& errors) {
  double most = 0;
  for (const WorstError& error : errors) most = std::max(most, error.error);
  return most;
}

/// A recording whose JSON text is changed before it is read.
Validation validate_changed(const std::string& name, const std::string& from, const std::string& to) {
  RecordingText text = recording_text(name);
  text.json = replaced(text.json, from, to);
  return validate(text.read(), {});
}

}  // namespace

TEST_CASE("every recording of PyBullet's cart-pole passes at the default tolerances") {
  std::size_t recordings = 0;
  std::size_t closed = 0;
  for (const auto& file : std::filesystem::directory_iterator(recordings_folder())) {
    if (file.path().extension() != ".json" || !file.path().stem().string().starts_with("d_cp_")) continue;
    CAPTURE(file.path().string());

    const Validation result = validate(recording_text(file.path().stem().string()).read(), {});

    CHECK(result.fault == "");
    CHECK(worst(result.one_step) < 1e-14);  // rounding of numbers up to 10: the equations are the same
    CHECK(worst(result.closed_loop) < 1e-14);
    CHECK(result.flags_differ == 0);
    ++recordings;
    closed += result.closed_loop.empty() ? 0 : 1;
  }

  CHECK(recordings == 10);
  CHECK(closed == 6);
}

TEST_CASE("a wrong model of the plant fails: inertia, gravity, rate of integration, mass, rail") {
  struct Wrong {
    const char* recording;
    const char* from;
    const char* to;
  };
  const Wrong wrongs[] = {
      {"d_cp_passive_50_1000", "\"cart_mass\": 1.0", "\"cart_mass\": 1.0, \"pole_thickness\": 0"},
      {"d_cp_lqr_15_750", "\"cart_mass\": 1.0", "\"cart_mass\": 1.0, \"pole_thickness\": 0"},
      {"d_cp_random_50_50", "\"gravity\": 9.8", "\"gravity\": 9.81"},
      {"d_cp_lqr_15_750", "\"pyb_freq\": 750", "\"pyb_freq\": 1500"},
      {"d_cp_lqr_50_50_goaltol", "\"pyb_freq\": 50", "\"pyb_freq\": 100"},
      {"d_cp_lqr_params_tap_50_1000", "\"pole_mass\": 0.15", "\"pole_mass\": 0.1501"},
      {"d_cp_lqr_tapimpulse_50_1000", "\"cart_mass\": 1.0", "\"cart_mass\": 1.0, \"tap_point\": \"tip\""},
      {"d_cp_rail_50_1000", "\"cart_mass\": 1.0", "\"cart_mass\": 1.0, \"rail\": 15.5"},
  };
  for (const Wrong& wrong : wrongs) {
    CAPTURE(wrong.recording);
    CAPTURE(wrong.to);

    const Validation result = validate_changed(wrong.recording, wrong.from, wrong.to);

    CHECK_FALSE(result.passed());
    CHECK(worst(result.one_step) > 1e-7);  // thousands of times the tolerance
  }
}

TEST_CASE("the fault says which state is off, when, and in which mode") {
  const Validation result = validate_changed("d_cp_random_50_50", "\"gravity\": 9.8", "\"gravity\": 9.81");

  CHECK(result.fault.starts_with("theta_dot is off by 0.0"));
  CHECK(result.fault.find(" rad/s at k = ") != std::string::npos);
  CHECK(result.fault.ends_with(" (one step)"));
}

TEST_CASE("a wrong controller fails in closed loop and nowhere else") {
  const Validation result = validate_changed("d_cp_lqr_15_750", "-39.70884580498759", "-39.7088458");

  CHECK(worst(result.one_step) < 1e-14);
  CHECK(result.reward.error < 1e-12);
  CHECK(worst(result.closed_loop) > 1e-10);
  CHECK(result.fault.ends_with(" (closed loop)"));
}

TEST_CASE("a wrong reward weight, error weight, actuator limit or goal tolerance fails by its own name") {
  const auto fault = [](const char* name, const char* from, const char* to) {
    return validate_changed(name, from, to).fault;
  };

  CHECK(fault("d_cp_lqr_noise_50_50", "\"rew_act_weight\": 0.0001", "\"rew_act_weight\": 0.00011")
            .starts_with("reward "));
  CHECK(fault("d_cp_lqr_noise_50_50", "\"rew_state_weight\": 1.0", "\"rew_state_weight\": [1, 1, 1, 2]")
            .starts_with("reward "));
  CHECK(fault("d_cp_lqr_noise_50_50", "\"sq_err_weights\": [\n  1.0", "\"sq_err_weights\": [\n  1.5")
            .starts_with("sq_err "));
  CHECK(fault("d_cp_rail_50_1000", "   -10.0\n  ],\n  [\n   10.0", "   -9.0\n  ],\n  [\n   9.0")
            .starts_with("a_applied "));
  CHECK(fault("d_cp_lqr_50_50_goaltol", "\"goal_tolerance\": 0.05", "\"goal_tolerance\": 0.0")
            .starts_with("flags differ"));
}

TEST_CASE("a flag turned over in one record is found in that record") {
  RecordingText text = recording_text("d_cp_random_50_50");
  const std::size_t line = text.csv.find("\n77,");
  const std::size_t end = text.csv.find('\n', line + 1);
  char& timelimit = text.csv[end - 1];
  timelimit = timelimit == '0' ? '1' : '0';

  const Validation result = validate(text.read(), {});

  CHECK(result.flags_differ == 1);
  CHECK(result.fault == "flags differ in 1 records, first at k = 77");
}

TEST_CASE("rewards that are written as -J are compared with the same reward") {
  RecordingText text = recording_text("d_cp_lqr_noise_50_50");
  const Validation exponential = validate(text.read(), {});
  text.json = replaced(text.json, "\"rew_exponential\": true", "\"rew_exponential\": false");

  const Validation wrong = validate(text.read(), {});

  CHECK(exponential.passed());
  CHECK(wrong.fault.starts_with("reward "));  // exp of a reward that is an exponential already

  RecordingText logarithm = text;
  std::string csv;
  const std::size_t columns = 23;
  const std::size_t reward_column = 18;
  std::size_t column = 0;
  std::string cell;
  for (const char letter : text.csv) {
    if (letter != ',' && letter != '\n') {
      cell += letter;
      continue;
    }
    const bool is_reward = column == reward_column && !cell.empty() && cell != "reward";
    csv += is_reward ? cat(std::log(std::stod(cell))) : cell;
    csv += letter;
    cell.clear();
    column = (column + 1) % columns;
  }
  logarithm.csv = csv;
  CHECK(validate(logarithm.read(), {}).fault == "");
}

TEST_CASE("tolerances decide, and NaN in a state never passes") {
  RecordingText text = recording_text("d_cp_random_50_50");
  text.json = replaced(text.json, "\"gravity\": 9.8", "\"gravity\": 9.81");
  const Recording recording = text.read();

  CHECK_FALSE(validate(recording, {.step = 1e-5, .loop = 1e-5}).passed());
  CHECK(validate(recording, {.step = 0.1, .loop = 0.1}).passed());

  WorstError error;
  error.take(0.5, 3);
  error.take(-0.25, 4);
  CHECK(error.error == 0.5);
  CHECK(error.record == 3);
  error.take(NAN, 5);
  CHECK(std::isinf(error.error));
  error.take(1.0, 6);
  CHECK(error.record == 5);
}

TEST_CASE("a plant that runs away to infinity fails instead of passing silently") {
  const Validation result = validate_changed("d_cp_passive_50_1000", "\"cart_mass\": 1.0", "\"cart_mass\": 1e-320");

  CHECK_FALSE(validate_changed("d_cp_passive_50_1000", "\"gravity\": 9.8", "\"gravity\": 1e300").passed());
  CHECK_FALSE(result.passed());
}

TEST_CASE("recordings longer than one stretch of lanes are checked to the end") {
  RecordingText text = recording_text("d_cp_passive_50_1000");
  // The plant hangs still upright: 1200 equal records, but for one that says that the cart moved.
  std::string csv = text.csv.substr(0, text.csv.find('\n') + 1);
  for (int k = 0; k <= 1200; ++k) {
    const double x = k == 1100 ? 0.5 : 0.0;
    const double error = x * x;
    const bool last = k == 1200;
    csv += cat(k, ",", k / 50.0, ",0,0,0,0,0,0,0,0,", x, ",0,0,0,", x, ",0,0,0,", std::exp(-error), ",", error, ",0,",
               last ? 1 : 0, ",", last ? 1 : 0, "\n");
  }
  text.csv = csv;
  text.json = replaced(text.json, "\"steps\": 250", "\"steps\": 1200");
  text.json = replaced(text.json, "  0.05,\n", "  0,\n");

  const Validation result = validate(text.read(), {});

  CHECK(result.one_step[0].error == 0.5);
  CHECK(result.one_step[0].record == 1100);
  CHECK(result.one_step[1].error == 0.0);
}

TEST_CASE("a controller is run with what it believes of the plant, not with what the plant is") {
  const std::filesystem::path folder = std::filesystem::path(GUST_TEST_DATA) / "reference" / "belief";
  for (const char* name : {"pd_believes_less_mass", "pd_believes_another_drone", "lqr_believes_less_mass"}) {
    CAPTURE(name);
    const Recording recording = recording_text(name, folder).read();

    const Validation result = validate(recording, {});

    CHECK(result.fault == "");
    CHECK(result.parts.closed_loop);
    CHECK(result.judged == 60);
    CHECK(worst(result.one_step) < 1e-13);
    CHECK(worst(result.closed_loop) < 1e-12);  // rounding that 60 steps add up
  }
}

TEST_CASE("each belief of a controller counts: mass, inertia, arm, gravity and the action at rest") {
  const std::filesystem::path folder = std::filesystem::path(GUST_TEST_DATA) / "reference" / "belief";
  const auto off = [&](const char* name, const char* from, const char* to) {
    RecordingText text = recording_text(name, folder);
    const std::size_t beliefs = text.json.find("\"policy\"");
    text.json = text.json.substr(0, beliefs) + replaced(text.json.substr(beliefs), from, to);
    const Validation result = validate(text.read(), {});
    return worst(result.one_step) < 1e-13 ? worst(result.closed_loop) : 0;
  };

  CHECK(off("pd_believes_another_drone", "\"M\": 0.027", "\"M\": 0.03") > 0.01);
  CHECK(off("pd_believes_another_drone", "\"Iyy\": 1.4e-05", "\"Iyy\": 1.8e-05") > 0.001);
  CHECK(off("pd_believes_another_drone", "\"arm\": 0.028", "\"arm\": 0.031") > 0.001);
  CHECK(off("pd_believes_another_drone", "\"gravity\": 9.8", "\"gravity\": 9.81") > 1e-4);
  CHECK(off("lqr_believes_less_mass", "0.1323", "0.147") > 0.01);
}

TEST_CASE("the reward is charged from u_goal") {
  const std::filesystem::path folder = std::filesystem::path(GUST_TEST_DATA) / "reference" / "belief";
  RecordingText text = recording_text("pd_believes_another_drone", folder);
  text.json = replaced(text.json, "u_goal", "another");

  CHECK(validate(text.read(), {}).fault.starts_with("reward "));
}

TEST_CASE("what a robot does not record is not judged, and said so") {
  const RecordingText whole = recording_text("d_cp_lqr_noise_50_50");
  const RecordingText log = without(
      whole, {"a_raw", "a_noisy", "adv_x", "adv_z", "reward", "sq_err", "out_of_bounds", "done", "timelimit", "k"});
  const Recording recording = log.read();

  const Validation result = validate(recording, {});

  CHECK(result.fault == "");
  CHECK(result.judged == 250);
  CHECK(worst(result.one_step) < 1e-14);
  CHECK(worst(result.closed_loop) < 1e-14);
  CHECK(not_recorded(recording, result.parts) == "applied, reward, sq_err, flags");
  const Recording blind = without(log, {"obs0"}).read();
  CHECK(not_recorded(blind, validate(blind, {}).parts) ==
        "applied, reward, sq_err, flags, closed loop, obs1, obs2, obs3 (no obs0)");
  const Recording full = whole.read();
  CHECK(not_recorded(full, validate(full, {}).parts) == "");
  const Recording fewer = without(whole, {"done", "f_z"}).read();
  CHECK(not_recorded(fewer, validate(fewer, {}).parts) == "done");
  CHECK(missing_forces(full) == "");
  CHECK(missing_forces(fewer) == "no f_z");
  CHECK(missing_forces(without(whole, {"f_x", "f_z"}).read()) == "no force");
}

TEST_CASE("columns whose first one is missing are named, whatever group they are of") {
  const RecordingText whole = recording_text("d_q2_circle_50_1000");
  const auto said = [&](const char* column) {
    const Recording recording = without(whole, {column}).read();
    return not_recorded(recording, validate(recording, {}).parts);
  };

  CHECK(said("a_raw0").ends_with("a_raw1 (no a_raw0)"));
  CHECK(said("a_noisy0").starts_with("applied"));
  CHECK(said("a_noisy0").ends_with("a_noisy1 (no a_noisy0)"));
  CHECK(said("obs0").find("closed loop, reference, obs1, obs2") != std::string::npos);
  CHECK(said("obs0").ends_with("obs11 (no obs0)"));
}

TEST_CASE("each flag is judged where it is recorded") {
  RecordingText text = without(recording_text("d_cp_random_50_50"), {"done", "timelimit"});
  CHECK(validate(text.read(), {}).fault == "");
  const std::size_t line = text.csv.find("\n77,");
  char& out_of_bounds = text.csv[text.csv.find('\n', line + 1) - 1];
  out_of_bounds = out_of_bounds == '0' ? '1' : '0';

  CHECK(validate(text.read(), {}).fault == "flags differ in 1 records, first at k = 77");
}

TEST_CASE("a recording of which no step can be judged has not passed") {
  RecordingText text = recording_text("d_q2_hover_50_1000");
  const std::size_t z = 16;  // its column
  std::string csv;
  for (const std::string& line : split_text(text.csv, '\n')) {
    std::vector<std::string> cells = split_text(line, ',');
    if (!csv.empty() && cells.size() > z) cells[z] = "-0.03";
    csv += join(cells, ",") + "\n";
  }
  text.csv = csv;
  text.json = replaced(text.json, "init_state", "start");

  const Validation result = validate(text.read(), {});

  CHECK(result.judged == 0);
  CHECK_FALSE(result.passed());
  CHECK(result.fault == "0 of 250 steps judged: near the ground from k = 1");
}
