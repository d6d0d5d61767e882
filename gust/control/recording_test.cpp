#include "gust/control/recording.h"

#include <cmath>

#include "gust/control/recording_files_test.h"

using namespace gust;

namespace {

const RecordingText& noisy() {
  static const RecordingText text = recording_text("d_cp_lqr_noise_50_50");
  return text;
}

std::string error_of_json(const std::string& from, const std::string& to) {
  return reading_error({replaced(noisy().json, from, to), noisy().csv});
}

std::string error_of_csv(const std::string& from, const std::string& to) {
  return reading_error({noisy().json, replaced(noisy().csv, from, to)});
}

}  // namespace

TEST_CASE("a recording holds what its files say") {
  const Recording recording = recording_text("d_cp_lqr_15_750").read();

  CHECK(recording.name == "d_cp_lqr_15_750");
  CHECK(recording.policy == "lqr");
  CHECK(recording.gain(0, 2) == -39.70884580498759);
  CHECK(recording.steps() == 150);
  CHECK(recording.plant->spec().physics_rate == 750);
  CHECK(recording.plant->spec().control_rate == 15);
  CHECK(recording.plant->spec().normalized_action);
  CHECK(recording.plant->spec().state_weights == std::vector<double>{1, 1, 1, 1});
  CHECK(recording.error_weights == std::vector<double>{1, 0, 1, 0});
  CHECK(recording.state.at(1, 0) == -1.5);
  CHECK(recording.state.at(2, 1) == -0.09040132590458172);
  CHECK(recording.command.at(0, 1) == -0.5924794735409222);
  CHECK(recording.physical.at(0, 1) == -5.924794735409222);
  CHECK(recording.outcome.at(static_cast<std::size_t>(Recorded::kReward), 2) == 0.00300808873398766);
  CHECK(recording.outcome.at(static_cast<std::size_t>(Recorded::kTimeLimit), 150) == 1);
}

TEST_CASE("line ends of other systems, a byte order mark, other columns and keys change nothing") {
  RecordingText text = noisy();
  std::string csv = "\xef\xbb\xbf";
  for (const char letter : text.csv) csv += letter == '\n' ? ",note, of somebody\r\n" : std::string(1, letter);
  text.csv = csv;
  text.json = replaced(text.json, "{", "{\"operator\": \"somebody\", \"shift\": {\"from\": [8, null_]}, ");
  text.json = replaced(text.json, ", null_", "");

  const Recording recording = text.read();

  CHECK(recording.state.at(3, 250) == noisy().read().state.at(3, 250));
}

TEST_CASE("what is wrong in the JSON file is told with line and column") {
  CHECK(error_of_json("\"cartpole\"", "\"cartpol\"") ==
        "log.json:3:11: unknown plant 'cartpol'; did you mean 'cartpole'?; known are cartpole, quadrotor, quad2d");
  CHECK(error_of_json("\"cartpole\"", "\"unicycle\"") ==
        "log.json:3:11: unknown plant 'unicycle'; known are cartpole, quadrotor, quad2d");
  CHECK(error_of_json("\"ctrl_freq\"", "\"ctrl_frq\"") ==
        "log.json:1:1: 'ctrl_freq' is missing; is it the one called 'ctrl_frq'? (gust validate --help)");
  CHECK(error_of_json("\"pyb_freq\": 50", "\"pyb_freq\": 75") ==
        "log.json:5:14: 'pyb_freq' must be 1, 2, … 1000000 times 'ctrl_freq', got 75 and 50");
  CHECK(error_of_json("\"ctrl_freq\": 50", "\"ctrl_freq\": 0") == "log.json:4:15: 'ctrl_freq' must be > 0, got 0");
  CHECK(error_of_json("\"ctrl_freq\": 50", "\"ctrl_freq\": \"50\"") ==
        "log.json:4:15: 'ctrl_freq' must be a number, got text");
  CHECK(error_of_json("\"steps\": 250", "\"steps\": 250.5") ==
        "log.json:6:11: 'steps' must be a whole number, got 250.5");
  CHECK(error_of_json("\"steps\": 250", "\"steps\": 1000000000000") ==
        "log.json:6:11: 'steps' must be 1 to 200000, got 1000000000000");
  CHECK(error_of_json("\"pole_mass\": 0.1", "\"pole_mass\": -0.1") ==
        "log.json:10:16: 'pole_mass' must be > 0, got -0.1");
  CHECK(error_of_json("\"pole_mass\": 0.1", "\"pole_mas\": 0.1") ==
        "log.json:8:18: 'plant_params' lacks 'pole_mass' [kg]");
  CHECK(error_of_json("\"pole_mass\": 0.1", "\"pole_mass\": 0.1, \"friction\": 1")
            .starts_with("log.json:10:33: unknown key 'friction' in cartpole"));
  CHECK(error_of_json("\"pole_mass\": 0.1", "\"pole_mass\": 0.1, \"goal\": [0, 0, 0, 0]") ==
        "log.json:10:29: 'goal' is no parameter of the plant");
  CHECK(error_of_json("\"rew_act_weight\": 0.0001", "\"rew_act_weight\": [1, 2]")
            .find("'rew_act_weight' must have 1 numbers, got 2") != std::string::npos);
  CHECK(error_of_json("  -2.7897487517612585,\n", "").find("'lqr_gain' must have 4 numbers, got 3") !=
        std::string::npos);
  CHECK(error_of_json("   -10.0", "   -12.0").find("'action_bounds' must be [[-limit], [limit]]") != std::string::npos);
  CHECK(error_of_json("\"stabilization\"", "\"traj_tracking\"").find("'task' must be \"stabilization\"") !=
        std::string::npos);
  CHECK(error_of_json("\"u_goal\": [\n  0.0", "\"u_goal\": [\n  0.0, 1.0").find("'u_goal' must have 1 numbers") !=
        std::string::npos);
  CHECK(error_of_json("\"type\": \"lqr\"", "\"kind\": \"lqr\"").find("'type' is missing") != std::string::npos);
}

TEST_CASE("what is wrong in the CSV file is told with line and column") {
  CHECK(error_of_csv("theta_dot", "theta_dt") ==
        "log.csv:1:1: the column 'theta_dot' is missing; is it the one called 'theta_dt'? (gust validate --help)");
  CHECK(error_of_csv("sq_err", "reward") == "log.csv:1:1: the column 'reward' is there 2 times");
  CHECK(error_of_csv("\n1,0.02,0.661566412764941,", "\n1,0.02,none,") ==
        "log.csv:3:8: 'a_raw' must be a finite number, got 'none'");
  CHECK(error_of_csv("\n1,0.02,0.661566412764941,", "\n1,0.02,nan,") ==
        "log.csv:3:8: 'a_raw' must be a finite number, got 'nan'");
  CHECK(error_of_csv("\n1,0.02,0.661566412764941,", "\n1,0.02,1e999,") ==
        "log.csv:3:8: 'a_raw' must be a finite number, got '1e999'");
  CHECK(error_of_csv("\n1,0.02,0.661566412764941,", "\n1,0.02,,") ==
        "log.csv:3:8: 'a_raw' must be a finite number, got ''");
  CHECK(error_of_csv("\n1,0.02,", "\n1,") == "log.csv:3:1: 22 cells; the header has 23");
  CHECK(error_of_csv("\n1,0.02,", "\n2,0.02,") == "log.csv:3:1: 'k' must be 1, the number of the record, got 2");
  CHECK(error_of_csv("\n1,0.02,", "\n1,0.04,") == "log.csv:3:3: 't' must be 0.02 (k / ctrl_freq), got 0.04");
  CHECK(error_of_csv("0.0,0.0,0.03,0.0,", "0.0,0.0,0.04,0.0,") ==
        "log.csv:2:23: 'theta' must be 0.03 as in 'init_state', got 0.04");
  CHECK(error_of_csv(",0,0,0\n1,", ",0,0,2\n1,").find("'timelimit' must be 0 or 1, got 2") != std::string::npos);
}

TEST_CASE("every key that the help calls necessary is missed when it is not there") {
  std::size_t keys = 0;
  const std::string format = recording_format();
  const std::string needed = format.substr(0, format.find("and may hold"));
  for (const std::string& line : split_text(needed, '\n')) {
    if (!line.starts_with("  ")) continue;
    const std::string key = line.substr(2, line.find(' ', 2) - 2);
    const std::string json = replaced(noisy().json, cat("\"", key, "\":"), "\"something_else\":");
    CHECK(reading_error({json, noisy().csv}).find(cat("'", key, "' is missing")) != std::string::npos);
    ++keys;
  }

  CHECK(keys == 14);
}

TEST_CASE("states and an action are needed, and every other column may be missing") {
  const std::string header = noisy().csv.substr(0, noisy().csv.find('\n'));
  std::size_t needed = 0;
  for (const std::string& column : split_text(header, ',')) {
    CAPTURE(column);
    const std::string error = reading_error({noisy().json, without_column(noisy().csv, column)});
    const bool state = column.starts_with("x") || column.starts_with("theta");
    const bool part = column.starts_with("obs") && column != "obs0";  // a part of the observation is none
    if (state || part) CHECK(error.find(cat("the column '", column, "' is missing")) != std::string::npos);
    if (!state && !part) CHECK(error.empty());
    needed += error.empty() ? 0 : 1;
  }

  CHECK(needed == 7);
  const RecordingText still = without(noisy(), {"a_raw", "a_phys", "a_noisy", "a_applied"});
  CHECK(reading_error(still).starts_with("log.csv:1:1: the column 'a_applied' is missing"));
}

TEST_CASE("what is not recorded of the action follows from what is") {
  const Recording whole = recording_text("d_cp_lqr_15_750").read();  // nothing disturbs it
  const auto same = [](const Matrix<double>& a, const Matrix<double>& b) {
    for (std::size_t k = 1; k < a.lanes(); ++k) {
      if (!(std::abs(a.at(0, k) - b.at(0, k)) < 1e-14)) return false;  // a factor of 10 and back
    }
    return a.lanes() == b.lanes();
  };
  const std::vector<std::string> all = {"a_raw", "a_phys", "a_noisy", "a_applied"};
  for (const std::string& only : all) {
    CAPTURE(only);
    RecordingText text = recording_text("d_cp_lqr_15_750");
    for (const std::string& column : all) {
      if (column != only) text.csv = without_column(text.csv, column);
    }

    const Recording recording = text.read();

    CHECK(same(recording.applied, whole.applied));
    CHECK(same(recording.disturbed, only == "a_applied" ? whole.applied : whole.disturbed));
    CHECK(same(recording.physical, only == "a_applied" ? whole.applied : whole.physical));
    CHECK(recording.commanded() == (only == "a_raw" || only == "a_phys"));
  }
}

TEST_CASE("keys about columns that are not there are not needed") {
  RecordingText text = without(noisy(), {"a_raw", "reward", "sq_err", "out_of_bounds", "done", "timelimit"});
  for (const char* key : {"goal_tolerance", "normalized_action", "rew_state_weight", "rew_act_weight",
                          "rew_exponential", "sq_err_weights", "policy", "goal"}) {
    text.json = replaced(text.json, cat("\"", key, "\":"), cat("\"no_", key, "\":"));
  }

  const Recording recording = text.read();

  CHECK(recording.policy.empty());
  CHECK(recording.steps() == 250);
}

TEST_CASE("a robot's clock begins anywhere") {
  RecordingText text = noisy();
  std::string csv;
  for (const std::string& line : split_text(text.csv, '\n')) {
    const std::size_t from = line.find(',') + 1;
    const bool record = !csv.empty() && !line.empty();
    csv += record ? cat(line.substr(0, from), 1000.5 + std::stod(line.substr(from)), line.substr(line.find(',', from)))
                  : line;
    csv += '\n';
  }
  text.csv = csv;

  CHECK(reading_error(text).empty());
  text.csv = replaced(text.csv, "\n1,1000.52,", "\n1,1000.54,");
  CHECK(reading_error(text) == "log.csv:3:3: 't' must be 1000.52 (k / ctrl_freq), got 1000.54");
}

TEST_CASE("quotes and blanks around cells change nothing") {
  RecordingText text = noisy();
  std::string csv = "\"note\",";
  for (const char letter : text.csv.substr(0, text.csv.size() - 1)) {
    csv += letter == '\n' ? "\n\"a, \"\"b\"\"\"," : letter == ',' ? " , " : std::string(1, letter);
  }
  text.csv = csv + "\n";

  const Recording recording = text.read();

  CHECK(recording.state.at(3, 250) == noisy().read().state.at(3, 250));
}

TEST_CASE("another separator, encoding or sign of decimals is told as what it is") {
  const auto with = [](char separator, bool comma) {
    std::string csv = noisy().csv;
    for (char& letter : csv) letter = letter == ',' ? separator : letter == '.' && comma ? ',' : letter;
    return reading_error({noisy().json, csv});
  };
  CHECK(with(';', false) == "log.csv:1:2: cells are separated by ; here: commas are needed");
  CHECK(with(';', true) == "log.csv:1:2: cells are separated by ; here: commas are needed, and points in numbers");
  CHECK(with('\t', false) == "log.csv:1:2: cells are separated by tabs here: commas are needed");
  CHECK(with(' ', false) == "log.csv:1:2: cells are separated by blanks here: commas are needed");
  CHECK(error_of_csv("\n1,0.02,", "\n1,0,02,") ==
        "log.csv:3:1: 24 cells; the header has 23; are these decimal commas? numbers need points");
  CHECK(error_of_csv("\n1,0.02,", "\n1,\"0,02\",") ==
        "log.csv:3:3: 't' must be a finite number, got '0,02'; numbers need points");
  CHECK(error_of_csv("k,t", "# k,t") ==
        "log.csv:1:1: begins with a comment, #; the first line must be the names of the columns and nothing else");
  CHECK(error_of_csv("\n1,0.02,", "\n# pause\n1,0.02,").find("; comments are not read") != std::string::npos);
  CHECK(reading_error({noisy().json, noisy().csv.substr(noisy().csv.find('\n') + 1)}) ==
        "log.csv:1:1: the first line holds numbers; it must hold the names of the columns");
}

TEST_CASE("UTF-16 and UTF-32 are told, with and without a mark, in both files") {
  const auto wide = [](const std::string& text, std::string mark, bool big) {
    for (const char letter : text) mark += big ? std::string{'\0', letter} : std::string{letter, '\0'};
    return mark;
  };
  for (const bool big : {false, true}) {
    for (const std::string& mark : {std::string(), std::string(big ? "\xfe\xff" : "\xff\xfe")}) {
      CHECK(reading_error({noisy().json, wide(noisy().csv, mark, big)}) == "log.csv:1:1: is UTF-16; save it as UTF-8");
      CHECK(reading_error({wide(noisy().json, mark, big), noisy().csv}) == "log.json:1:1: is UTF-16; save it as UTF-8");
    }
  }
  const std::string utf32 = {'\xff', '\xfe', '\0', '\0', 'k', '\0', '\0', '\0'};
  CHECK(reading_error({noisy().json, utf32}) == "log.csv:1:1: is UTF-32; save it as UTF-8");
  CHECK(reading_error({"\xef\xbb\xbf" + noisy().json, noisy().csv}).empty());
}

TEST_CASE("files that are cut off anywhere give one error and never a recording") {
  for (std::size_t size = 0; size + 2 < noisy().json.size(); size += 13) {
    REQUIRE(reading_error({noisy().json.substr(0, size), noisy().csv}).starts_with("log.json:"));
  }
  for (std::size_t size = 0; size + 20 < noisy().csv.size(); size += 997) {
    REQUIRE(reading_error({noisy().json, noisy().csv.substr(0, size)}).starts_with("log.csv:"));
  }
}

TEST_CASE("too many records, too many integration steps and a huge count are refused before any work") {
  CHECK(error_of_json("\"steps\": 250", "\"steps\": 249") ==
        "log.csv: 251 records below the header; 'steps' of its JSON file asks for 250, the reset and one a step");
  CHECK(error_of_json("\"pyb_freq\": 50", "\"pyb_freq\": 49999950").find("asks for more than") != std::string::npos);
}
