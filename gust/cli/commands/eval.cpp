#include "gust/cli/eval.h"

#include <algorithm>
#include <cstdio>

#include "gust/cli/command.h"
#include "gust/study/text/policy_files.h"

namespace gust {
namespace {

constexpr const char* kAbout =
    "Runs a policy in closed loop and prints what every episode measured.\n\n"
    "POLICY is a file that ends in .onnx, or a kind of policy (gust list policies) whose keys --set gives: lqr, or "
    "gain with --set 'k=[[-8.8,-9,-55,-14]]'. A disturbance needs --site, --waveform (or --effect) and --level; --set "
    "then also takes its options, channels (names), mask (such as 10), start and end (control steps). "
    "--set takes readings (effort, saturate, command_clip, tap_point) and options of the plant as well: the policy "
    "lqr is designed for them. --param changes the plant and not the policy, which stays what it was.\n\n"
    "--observe, --act and --units are for files that gust did not make: what the policy sees in its order, with sign, "
    "unit or scale (TOML, or names with commas between; gust describe plant KIND has the names), and what its actions "
    "are. They are the keys of a study's onnx policy (docs/study.md).\n\n"
    "With --study, POLICY is a policy of the study by its name, and the rest is the study's too: --sweep and --level "
    "name a cell, and its metrics are the numbers that the study has there, of every seed of the policy.";

constexpr const char* kExamples =
    "Examples:\n"
    "  gust eval lqr --plant cartpole --preset scg-2022 --start random --episodes 25\n"
    "  gust eval ppo.onnx --plant cartpole --site dynamics --waveform impulse --level 2 --set mask=10 --set duration=3 "
    "--json\n"
    "  gust eval lqr --plant cartpole --start 0.1,0,0.05,0 --param pole_length=x2 --terminate no --json\n"
    "  gust eval gain --plant cartpole --set 'k=[[-8.8,-9,-0.96,-0.25]]' --set 'units={theta=\"deg\", "
    "theta_dot=\"deg/s\"}'\n"
    "  gust eval isaac.onnx --plant cartpole --observe=theta,theta_dot=deg/s,-x,x_dot --units N\n"
    "  gust eval ppo --study demo.gust --sweep 'action step' --level 3 --start random\n\n"
    "JSON: an array, one object an episode: length, failed, return_sum_commanded, return_sum_disturbed, every metric "
    "of an episode by its name, initial_state and final_state in the plant's order, and the seed (or file) of a "
    "study's policy. "
    "Length, sums, rmse_paper, rmse_scg, rmse_sum, squared_state_sum and final_state are over the row's steps: up to "
    "failure, or with "
    "--terminate no the whole horizon; the other metrics keep their definition (gust list metrics). With --study "
    "all metrics are the study's.\n\n"
    "Exit code 1: the policy gave NaN or an infinite action.";

void add_options(CLI::App& command, EvalRequest& request) {
  command.add_option("POLICY", request.policy, "FILE.onnx, or a kind (gust list policies)")->required();
  command.add_option("--output", request.output, "the output of FILE.onnx that is the action, where it has several")
      ->type_name("NAME");
  command.add_option("--study", request.study, "the folder that gust run left")->type_name("DIR");
  command.add_option("--sweep", request.sweep, "a sweep of the study (default: undisturbed)")->type_name("NAME");
  command.add_option("--plant", request.plant, "kind of the plant (gust list plants)")->type_name("KIND");
  command.add_option("--preset", request.preset, "options and readings to start from (gust list presets)")
      ->capture_default_str()
      ->type_name("NAME");
  command.add_option("--start", request.start, "nominal (default), random, or a state: x,x_dot,...; or the study's")
      ->type_name("START");
  command.add_option("--site", request.site, "where the disturbance enters: observation, action or dynamics")
      ->type_name("SITE");
  command.add_option("--waveform", request.waveform, "its shape (gust list waveforms)")->type_name("KIND");
  command.add_option("--effect", request.effect, "in place of a waveform (gust list effects)")->type_name("KIND");
  command.add_option("--level", request.level, "what the shape is multiplied by; of a sweep a value on its axis")
      ->type_name("NUMBER");
  command
      .add_option("--set", request.settings,
                  "an option of the waveform, the disturbance, the readings, the plant or the policy")
      ->type_name("KEY=VALUE");
  command.add_option("--param", request.parameters, "a parameter of the plant: 0.6, or x1.5 to scale it")
      ->type_name("NAME=VALUE");
  command
      .add_option("--observe", request.observe,
                  "what a file's policy sees, in its order: --observe=theta,-theta_dot,x=cm")
      ->type_name("LIST");
  command.add_option("--act", request.act, "what its actions are: '{ unit = \"N\", scale = -1 }'")->type_name("TABLE");
  command.add_option("--units", request.units, "the unit of its actions: normalised, or the plant's, such as N")
      ->type_name("UNIT");
  command.add_option("--terminate", request.terminate, "yes or no: whether failure ends the episode")
      ->capture_default_str()
      ->type_name("WORD");
  command.add_option("--episodes", request.episodes, "how many (default: the study's; 25 from random starts, else 1)")
      ->check(whole_number())
      ->type_name("N");
  command.add_option("--seed", request.seed, "of all that is random")
      ->check(whole_number(non_negative))
      ->capture_default_str()
      ->type_name("N");
}

/// With a study all but the cell is the study's, and may not be said again.
void check_options(const CLI::App& command, const EvalRequest& request) {
  if (request.study.empty()) {
    if (request.plant.empty()) throw Error("--plant is required, or --study (gust eval --help)");
    if (!request.sweep.empty()) throw Error("--sweep: needs the --study that it belongs to");
    return;
  }
  for (const char* name : {"--plant", "--preset", "--output", "--site", "--waveform", "--effect", "--set", "--param",
                           "--observe", "--act", "--units", "--terminate", "--seed"}) {
    if (command.get_option(name)->count() > 0) throw Error(cat(name, ": comes from the study; leave it out"));
  }
}

EvalResult result_of(const EvalRequest& request) {
  if (!request.study.empty()) return run_cell(request);
  if (!request.has_file()) return run_eval(request, {});
  const std::string bytes = read_policy_file(request.policy);
  return run_eval(request, bytes, read_onnx_data(request.policy, bytes));
}

/// What the user should know of the policy, after the numbers. A policy that gave NaN has failed.
int tell_notes(const EvalResult& result, const std::string& policy) {
  for (const std::string& note : result.notes) tell(cat("warning: ", note));
  const auto row = std::ranges::find_if(result.rows, [](const EvalRow& row) { return !row.not_finite.empty(); });
  if (row == result.rows.end()) return kDone;
  tell(cat(policy, ": episode ", row->episode, ": ", row->not_finite));
  return kTrialFailed;
}

}  // namespace

void command_eval(CLI::App& app, int& exit_code) {
  struct Options {
    EvalRequest request;
    bool json = false;
  };
  auto options = std::make_shared<Options>();  // shared: the callback outlives this function
  CLI::App* command = app.add_subcommand("eval", "Runs a policy in closed loop and prints what it measured");
  command->description(kAbout);
  command->footer(kExamples);
  add_options(*command, options->request);
  command->add_flag("--json", options->json, "print one JSON array, one object an episode");
  command->callback([options, command, &exit_code] {
    check_options(*command, options->request);
    const EvalResult result = result_of(options->request);
    print_lines(options->json ? eval_json(result) : eval_table(result));
    std::fflush(stdout);
    exit_code = tell_notes(result, options->request.policy);
  });
}

}  // namespace gust
