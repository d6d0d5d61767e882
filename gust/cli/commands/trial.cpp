#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "gust/cli/command.h"
#include "gust/cli/environment.h"
#include "gust/cli/progress.h"
#include "gust/cli/signals.h"
#include "gust/cli/study_command.h"
#include "gust/core/text.h"

namespace gust {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string folder;
  std::vector<std::string> ids;
  std::size_t threads = 0;
  bool json = false;
};

/// The trials of these ids in plan order, each once; an Error names an id that the plan does not have.
std::vector<PlannedTrial> find_trials(const Options& options, const Study& study, const Plan& plan) {
  std::vector<std::string> known;
  std::vector<PlannedTrial> found;
  for (std::size_t i = 0; i < plan.trials.size(); ++i) {
    const std::string& id = plan.trials[i].id;
    const bool asked = std::ranges::find(options.ids, id) != options.ids.end();
    if (asked && std::ranges::find(known, id) == known.end()) found.push_back({&study, &plan, i});
    known.push_back(id);
  }
  for (const std::string& id : options.ids) {
    if (std::ranges::find(known, id) != known.end()) continue;
    const char* later = plan.complete ? "" : "; more follow once the automatic levels are found";
    throw Error(cat(options.folder, ": its study has no trial '", id, "'", did_you_mean(id, known),
                    " (gust plan STUDY --json)", later));
  }
  return found;
}

std::string_view state_name(Outcome::State state) {
  static constexpr std::string_view kNames[] = {"done", "failed", "skipped", "stopped"};
  return kNames[static_cast<int>(state)];
}

std::string outcomes_text(const std::vector<PlannedTrial>& trials, const std::vector<Outcome>& outcomes) {
  std::string text;
  for (std::size_t i = 0; i < trials.size(); ++i)
    text += fmt::format("{:<7}  {}\n", state_name(outcomes[i].state), trials[i].trial().what);
  return text;
}

std::string outcomes_json(const std::vector<PlannedTrial>& trials, const std::vector<Outcome>& outcomes) {
  Json list = Json::array();
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const Trial& trial = trials[i].trial();
    list.push_back({{"id", trial.id},
                    {"kind", kind_name(trial.kind)},
                    {"what", trial.what},
                    {"state", state_name(outcomes[i].state)},
                    {"reason", outcomes[i].reason}});
  }
  return list.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// Tells how the trials ended; the exit code.
int tell_outcomes(const Options& options, const std::vector<PlannedTrial>& trials, const std::vector<Outcome>& outcomes,
                  const Store& store) {
  bool good = store.disagreements() == 0;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const bool bad = outcomes[i].state == Outcome::State::failed || outcomes[i].state == Outcome::State::skipped;
    if (bad) tell(complaint(trials[i].trial(), outcomes[i]));
    good = good && !bad;
  }
  const std::string text = options.json ? outcomes_json(trials, outcomes) : outcomes_text(trials, outcomes);
  good = print_result(text, cat("the trials are in ", store.folder().string())) && good;
  return good ? kDone : kTrialFailed;
}

int run_chosen(const Options& options) {
  SignalWatch signals;
  const StudyFolder folder(options.folder);
  Study study = folder.open(tell);
  warn_of_plain_products();
  RunOptions how{thread_count(options.threads), signals.token(), {}};
  const Store store(folder.store(), Store::Access::write, tell);
  const Plan plan = plan_with_store(study, store);
  const std::vector<PlannedTrial> trials = find_trials(options, study, plan);
  bool worked = false;
  how.watch = [&](Progress& progress, const std::function<void()>& work) {
    worked = true;
    show_progress(progress, work);
  };
  try {
    const std::vector<Outcome> outcomes = run_trials(trials, store, how);
    worked = true;
    const int code = tell_outcomes(options, trials, outcomes, store);
    if (std::ranges::find(outcomes, Outcome::State::stopped, &Outcome::state) == outcomes.end()) return code;
    tell("stopped; the same command goes on from here");
    return signals.exit_code();
  } catch (const std::exception& error) {
    if (!worked) throw;
    tell(error.what());
    return kTrialFailed;
  }
}

}  // namespace

void command_trial(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("trial", "Runs single trials of a study by their ids, for a scheduler of yours");
  command->add_option("DIR", options->folder, "a folder that 'gust run' or 'gust plan --prepare' made")->required();
  command->add_option("ID", options->ids, "trials, as 'gust plan --json' names them")->required();
  command->add_option("--threads", options->threads, "trials at a time (default: GUST_THREADS, else all cores)")
      ->check(whole_number(between(1, 1024)))
      ->type_name("N");
  command->add_flag("--json", options->json, "how each ended, as a JSON array");
  command->footer(
      "Example:\n"
      "  gust plan studies/demo.toml --out queue.gust --prepare \\\n"
      "      && gust trial queue.gust nominal-c6d1f7c2a5fbb392b4ec\n"
      "What a trial needs must be in the store or named too. What is there already is not run again.");
  command->callback([options, &exit_code] { exit_code = run_chosen(*options); });
}

}  // namespace gust
