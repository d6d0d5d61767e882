#include "gust/control/validate.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "gust/cli/command.h"
#include "gust/cli/help_format.h"
#include "gust/core/text.h"
#include "gust/store/files.h"

namespace gust {
namespace {

namespace fs = std::filesystem;

struct ValidateOptions {
  std::vector<std::string> files;
  Tolerances tolerances;
  bool json = false;
};

struct Checked {
  Recording recording;
  Validation result;
};

/// NAME.json, and the records in NAME.csv beside it.
Recording load_recording(const std::string& file) {
  const fs::path json(file);
  fs::path csv = json;
  csv.replace_extension(".csv");
  if (json.extension() != ".json") {
    throw Error(cat(file, ": a recording is named by its JSON file; is ",
                    fs::path(file).replace_extension(".json").string(), " meant? (gust validate --help)"));
  }
  const std::string description = read_file(json, std::size_t{256} << 10);
  std::error_code unknown;
  if (!fs::exists(csv, unknown))
    throw Error(cat(csv.string(), ": is not there; the records of ", file, " lie beside it"));
  const std::string records = read_file(csv);
  return read_recording({description, file}, {records, csv.string()});
}

std::string error_text(double error) { return error == 0 ? "0" : format("{:.1e}", error); }

constexpr std::size_t kNames = 13;  // columns before the errors of the states

/// One cell a state.
std::string state_line(std::string_view name, const std::vector<WorstError>& errors) {
  std::string line = fmt::format("{:<{}}", name, kNames);
  for (const WorstError& worst : errors) line += fmt::format("  {:<9}", error_text(worst.error));
  return line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
}

std::string head_of(const PlantSpec& spec) {
  std::string names(kNames, ' ');
  for (const Component& state : spec.state) names += fmt::format("  {:<9}", state.name);
  return names.substr(0, names.find_last_not_of(' ') + 1) + "\n";
}

/// What was not judged, and what was taken for granted; empty if nothing was.
std::string limits_of(const Recording& recording, const Validation& result) {
  std::vector<std::string> limits;
  if (result.judged < recording.steps())
    limits.push_back(cat("up to the ground, k = ", result.judged, " of ", recording.steps()));
  const std::string policy = recording.policy.empty() ? "" : cat(", '", recording.policy, "'");
  if (!recording.controller()) limits.push_back(cat("open loop", policy, ": one step only"));
  const std::string missing = not_recorded(recording, result.parts);
  if (!missing.empty()) limits.push_back(cat("not recorded, not judged: ", missing));
  if (const std::string forces = missing_forces(recording); !forces.empty())
    limits.push_back(cat(forces, " recorded: taken as 0"));
  return join(limits, "; ");
}

std::string verdict_of(const Checked& checked) {
  if (!checked.result.passed()) return cat("FAIL: ", checked.result.fault);
  const std::string limits = limits_of(checked.recording, checked.result);
  return limits.empty() ? "pass" : cat("pass (", limits, ")");
}

std::string part_text(bool judged, const WorstError& worst) { return judged ? error_text(worst.error) : "-"; }

/// A line with the verdict, and the errors below it.
std::string text_of(const Checked& checked) {
  const Validation& result = checked.result;
  const std::string name = printable(checked.recording.name);
  std::string text = cat(wrapped(cat(name, "  ", verdict_of(checked)), text_columns() - 2, 2), "\n");
  if (result.judged == 0) return text;
  text += state_line("  one step", result.one_step);
  if (!result.closed_loop.empty()) text += state_line("  closed loop", result.closed_loop);
  const char* const flags = !result.parts.flags() ? "-" : result.flags_differ == 0 ? "equal" : "differ";
  return text + fmt::format("  applied {}, reward {}, sq_err {}, flags {}\n",
                            part_text(result.parts.applied, result.applied),
                            part_text(result.parts.reward, result.reward),
                            part_text(result.parts.squared_error, result.squared_error), flags);
}

void print_table(const std::vector<Checked>& all) {
  std::string head;
  for (const Checked& checked : all) {
    const std::string own = head_of(checked.recording.plant->spec());
    if (own != head) fmt::print("{}", own);
    head = own;
    print_lines(text_of(checked));
  }
}

nlohmann::ordered_json states_json(bool judged, const std::vector<WorstError>& errors, const PlantSpec& spec) {
  if (!judged || errors.empty()) return nullptr;
  nlohmann::ordered_json object;
  for (std::size_t i = 0; i < errors.size(); ++i) object[spec.state[i].name] = errors[i].error;
  return object;
}

nlohmann::ordered_json part_json(bool judged, double error) {
  if (!judged) return nullptr;
  return error;
}

/// One object a recording. What was not judged is null; JSON has no infinity, so that such an error is null too.
void print_json(const std::vector<Checked>& all) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const auto& [recording, result] : all) {
    const PlantSpec& spec = recording.plant->spec();
    const JudgedParts& parts = result.parts;
    const bool any = result.judged > 0;
    list.push_back({{"recording", recording.name},
                    {"plant", recording.plant.kind},
                    {"policy", recording.policy},
                    {"steps", recording.steps()},
                    {"judged", result.judged},
                    {"one_step", states_json(any, result.one_step, spec)},
                    {"closed_loop", states_json(any, result.closed_loop, spec)},
                    {"applied", part_json(any && parts.applied, result.applied.error)},
                    {"reward", part_json(any && parts.reward, result.reward.error)},
                    {"sq_err", part_json(any && parts.squared_error, result.squared_error.error)},
                    {"flags_equal", any && parts.flags() ? nlohmann::ordered_json(result.flags_differ == 0) : nullptr},
                    {"passed", result.passed()},
                    {"note", result.passed() ? limits_of(recording, result) : result.fault}});
  }
  fmt::print("{}\n", list.dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
}

/// All files are read before any is checked: bad input starts nothing.
int validate_files(const ValidateOptions& options) {
  std::vector<Checked> all;
  for (const std::string& file : options.files) all.push_back({load_recording(file), {}});
  bool passed = true;
  for (Checked& checked : all) {
    checked.result = validate(checked.recording, options.tolerances);
    passed = passed && checked.result.passed();
  }
  if (options.json) {
    print_json(all);
  } else {
    print_table(all);
  }
  return passed ? kDone : kCheckFailed;
}

constexpr const char* kAbout =
    "For each recording it prints the largest absolute error of every state [SI units]: one step ahead from each "
    "recorded state, and in closed loop from the first state on, where the recorded controller is a state feedback; "
    "then the errors of applied action, reward and squared error, and whether the flags are equal. The default "
    "tolerances ask for another program's equal equations; for measurements choose them by your sensors, such as "
    "--tolerance-step 0.01 --tolerance-loop 0.1. --tolerance-step also judges applied action, reward and squared "
    "error.\n\n"
    "A robot's log has time, state and force: what it does not have is not judged, and the verdict says so. A "
    "recording of which no step could be judged has not passed.\n\n"
    "Exit code: 0 if all pass, 3 if any does not, 2 if one cannot be read.\n\n";

std::string check_tolerance(const std::string& text) {
  double number = -1;
  const char* const end = text.data() + text.size();
  const auto [read, failure] = std::from_chars(text.data(), end, number);
  const bool right = failure == std::errc{} && read == end && std::isfinite(number) && number >= 0;
  return right ? "" : "must be a number >= 0, got " + text;
}

}  // namespace

void command_validate(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("validate", "Checks the model of a plant against recordings of a simulator or a real robot");
  command->footer(cat("Example:\n  gust validate logs/*.json\n\n", kAbout, recording_format()));
  auto options = std::make_shared<ValidateOptions>();  // shared: the callback outlives this function
  command->add_option("RECORDING.json", options->files, "each recording's JSON file; its CSV file lies beside it")
      ->required()
      ->type_name("");
  command->add_option("--tolerance-step", options->tolerances.step, "largest error after one step")
      ->type_name("NUMBER")
      ->check(check_tolerance, "")
      ->capture_default_str();
  command->add_option("--tolerance-loop", options->tolerances.loop, "largest error in closed loop")
      ->type_name("NUMBER")
      ->check(check_tolerance, "")
      ->capture_default_str();
  command->add_flag("--json", options->json, "print one JSON array, one object a recording");
  command->callback([options, &exit_code] { exit_code = validate_files(*options); });
}

}  // namespace gust
