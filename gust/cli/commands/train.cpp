#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

#include "gust/cli/command.h"
#include "gust/cli/environment.h"
#include "gust/cli/progress.h"
#include "gust/cli/progress_text.h"
#include "gust/cli/signals.h"
#include "gust/cli/study_command.h"
#include "gust/cli/training_run.h"

namespace gust {
namespace {

constexpr const char* kAbout =
    "Trains a policy and writes it as an ONNX file.\n\n"
    "The path of the file is what is printed; progress goes to stderr. Stopped with Ctrl-C or killed, the same command "
    "goes on where it was and gives the same file. --set takes options of the agent (gust describe agent AGENT), then "
    "readings and options of the plant; profile=modern chooses another set of the agent's options than the preset's, "
    "randomise=mid a range of parameters that the preset names, and curve=training measures the learning curve on "
    "them, "
    "too.";

int train(const TrainRequest& request) {
  SignalWatch signals;
  TrainingRun run(request);
  warn_of_plain_products();
  for (const std::string& warning : run.warnings()) tell(cat("warning: ", warning));
  if (isatty(STDERR_FILENO) == 0 && run.predicted_seconds() > kWorthTelling)
    tell(cat(run.total_steps(), " steps, about ", clock_text(run.predicted_seconds())));
  TrainingRun::End end{};
  const Job job{.what = request.agent, .seconds = 1};
  Progress progress({&job, 1});
  try {
    show_progress(progress, [&] {
      progress.start(0);
      end = run.go(signals.token(), [&](double fraction) { progress.advance(0, fraction); });
      progress.finish(0);
    });
  } catch (const Error& error) {
    tell(cat(error.what(), "; the training is kept in ", request.out,
             ".checkpoint, and the same command goes on there"));
    return kTrialFailed;
  }
  if (end == TrainingRun::End::stopped) {
    tell(cat("stopped at ", run.steps(), " of ", run.total_steps(), " steps; the same command goes on from here"));
    return signals.exit_code();
  }
  if (end == TrainingRun::End::failed) {
    tell(cat("the training failed after ", run.steps(), " steps: ", run.failure()));
    return kTrialFailed;
  }
  tell(format("{} steps; return / horizon {:.4f} in the last evaluation", run.steps(), run.last_score()));
  return print_result(cat(request.out, "\n"), cat("the policy is in ", request.out)) ? kDone : kTrialFailed;
}

}  // namespace

void command_train(CLI::App& app, int& exit_code) {
  auto request = std::make_shared<TrainRequest>();  // shared: the callback outlives this function
  CLI::App* command = app.add_subcommand("train", kAbout);
  command->add_option("AGENT", request->agent, "what trains (gust list agents)")->required();
  command->add_option("--plant", request->plant, "kind of the plant (gust list plants)")->required()->type_name("KIND");
  command->add_option("--preset", request->preset, "options and readings to start from (gust list presets)")
      ->capture_default_str()
      ->type_name("NAME");
  command->add_option("--steps", request->steps, "environment steps (default: the agent's)")
      ->check(whole_number())
      ->type_name("N");
  command->add_option("--seed", request->seed, "of every random stream of the training")
      ->check(whole_number(non_negative))
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--set", request->settings, "an option of the agent, the readings or the plant")
      ->type_name("KEY=VALUE");
  command->add_option("--out", request->out, "where the policy goes")->required()->type_name("FILE.onnx");
  command->add_flag("--force", request->force, "replace a file that is no policy of gust");
  command->footer(
      "Example:\n  gust train ppo --plant cartpole --preset scg-2022 --steps 100000 --seed 1 --out ppo.onnx");
  command->callback([request, &exit_code] { exit_code = train(*request); });
}

}  // namespace gust
