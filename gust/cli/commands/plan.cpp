#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "gust/cli/command.h"
#include "gust/cli/study_command.h"
#include "gust/study/warnings.h"

namespace gust {
namespace {

struct Options {
  std::string study, out;
  std::vector<std::string> settings;
  bool json = false;
};

void print_plan(const Plan& plan, const Store* store, bool json) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  double seconds = 0;
  std::size_t missing = 0;
  for (const Trial& trial : plan.trials) {
    const bool done = store != nullptr && store->has(kind_name(trial.kind), trial.id);
    seconds += done ? 0 : trial.seconds;
    missing += done ? 0 : 1;
    if (json) {
      list.push_back({{"id", trial.id},
                      {"kind", kind_name(trial.kind)},
                      {"what", trial.what},
                      {"done", done},
                      {"seconds", trial.seconds}});
    } else {
      fmt::print("{:<7}  {:>7.1f} s  {:<62}  {}\n", done ? "done" : "missing", trial.seconds, trial.id, trial.what);
    }
  }
  if (json) fmt::print("{}\n", list.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  tell(cat(plan.trials.size(), " trials, ", missing, " missing, about ", fmt::format("{:.1f}", seconds),
           " s on one core", plan.complete ? "" : "; more follow once the automatic levels are found"));
}

}  // namespace

void command_plan(CLI::App& app, int&) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("plan", "Lists the trials of a study and runs nothing");
  command->add_option("STUDY", options->study, "the study, a TOML file")->required();
  command->add_option("--out", options->out, "result folder (default: ./NAME.gust)");
  command->add_option("--set", options->settings, "replace a value of the study: key=value")->type_name("KEY=VALUE");
  command->add_flag("--json", options->json, "as a JSON array");
  command->footer("Example:\n  gust plan studies/demo.toml");
  command->callback([options] {
    Study study = StudyFolder::read(options->study, options->settings);
    for (const std::string& warning : study_warnings(study)) tell(cat("warning: ", warning));
    const StudyFolder folder(options->out.empty() ? standard_folder(study) : options->out);
    if (!Store::is_at(folder.store())) return print_plan(expand(study, {}), nullptr, options->json);
    const Store store(folder.store(), Store::Access::read, tell);
    print_plan(plan_with_store(study, store), &store, options->json);
  });
}

}  // namespace gust
