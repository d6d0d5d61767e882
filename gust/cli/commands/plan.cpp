#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "gust/cli/command.h"
#include "gust/cli/help_format.h"
#include "gust/cli/progress_text.h"
#include "gust/cli/reproduction_command.h"
#include "gust/cli/study_command.h"
#include "gust/core/text.h"
#include "gust/study/text/warnings.h"

namespace gust {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string study, out;
  std::vector<std::string> settings;
  ReproductionChoice choice;
  bool prepare = false;
  bool json = false;
};

/// "3.2 s", or "1:02:03" from two minutes on.
std::string duration_text(double seconds) {
  return seconds < 120 ? fmt::format("{:.1f} s", seconds) : clock_text(seconds);
}

/// Trials of several plans, each told once.
class PlanTeller {
 public:
  PlanTeller(const Store* store, bool json) : store_(store), json_(json) {}

  void add(const Plan& plan, const std::string& under) {
    complete_ = complete_ && plan.complete;
    for (const Trial& trial : plan.trials) {
      if (!told_.insert(trial.id).second) continue;
      const bool done = store_ != nullptr && store_->has(kind_name(trial.kind), trial.id);
      seconds_ += done ? 0 : trial.seconds;
      longest_ = std::max(longest_, done ? 0 : trial.seconds);
      missing_ += done ? 0 : 1;
      tell_trial(plan, trial, done, under);
    }
  }

  void finish() const {
    if (json_) fmt::print("{}\n", list_.dump(2, ' ', false, Json::error_handler_t::replace));
    const std::size_t threads = thread_count(0);  // as many as a run would take
    const double together = std::max(longest_, seconds_ / static_cast<double>(threads));
    tell(cat(told_.size(), " trials, ", missing_, " missing, about ", duration_text(seconds_), " on one core",
             threads == 1 ? "" : cat(", ", duration_text(together), " on ", threads),
             complete_ ? "" : "; more follow once the automatic levels are found"));
  }

 private:
  void tell_trial(const Plan& plan, const Trial& trial, bool done, const std::string& under) {
    const std::string what = under.empty() ? trial.what : cat(trial.what, " · ", under);
    if (json_) {
      Json needs = Json::array();
      for (const std::size_t input : trial.inputs) needs.push_back(plan.trials[input].id);
      list_.push_back({{"id", trial.id},
                       {"kind", kind_name(trial.kind)},
                       {"what", what},
                       {"done", done},
                       {"seconds", trial.seconds},
                       {"needs", needs}});
    } else {
      const std::string head = fmt::format("{:<7}  {:>7.1f} s  ", done ? "done" : "missing", trial.seconds);
      const std::size_t room = text_columns() - std::min(text_columns() - 1, head.size());
      print_lines(cat(head, wrapped(printable(what), room, head.size()), "\n"));
    }
  }

  const Store* store_;
  bool json_;
  Json list_ = Json::array();
  std::set<std::string> told_;
  std::size_t missing_ = 0;
  double seconds_ = 0;
  double longest_ = 0;  ///< of one trial
  bool complete_ = true;
};

/// The store of a folder, if there is one.
std::unique_ptr<Store> store_at(const StudyFolder& folder) {
  const std::filesystem::path path = folder.store();
  return Store::is_at(path) ? std::make_unique<Store>(path, Store::Access::read, tell) : nullptr;
}

void plan_study(const Options& options) {
  Study study = StudyFolder::read(options.study, options.settings);
  for (const std::string& warning : study_warnings(study)) tell(cat("warning: ", warning));
  const StudyFolder folder(options.out.empty() ? standard_folder(study) : options.out);
  if (options.prepare) folder.keep(study, {options.study, options.settings});
  const std::unique_ptr<Store> store = store_at(folder);
  PlanTeller teller(store.get(), options.json);
  teller.add(store ? plan_with_store(study, *store) : expand(study, {}), "");
  teller.finish();
}

void plan_paper(const Options& options) {
  const Paper paper = open_paper(options.study);
  Reproduction reproduction = chosen_reproduction(paper, options.choice);
  const std::unique_ptr<Store> store =
      store_at(StudyFolder(options.out.empty() ? standard_folder(reproduction) : options.out));
  PlanTeller teller(store.get(), options.json);
  for (ReproductionStudy& part : reproduction.studies) {
    teller.add(store ? plan_with_store(part.study, *store) : expand(part.study, {}),
               cat(paper.figures[part.figure].place, ", ", paper.readings[part.reading].name));
  }
  teller.finish();
}

/// Whether it is the paper of the program, or a folder that can hold one; a study is a file.
bool names_paper(const std::string& name) {
  std::error_code unknown;
  return std::filesystem::is_directory(name, unknown) ||
         (name == "paper" && !std::filesystem::is_regular_file(name, unknown));
}

}  // namespace

void command_plan(CLI::App& app, int&) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("plan", "Lists the trials of a study or of a reproduction and runs nothing");
  command->add_option("STUDY", options->study, "the study, a TOML file; or 'paper', or a paper's folder")->required();
  command->add_option("--out", options->out, "result folder (default: ./NAME.gust)")->type_name("DIR");
  command->add_option("--set", options->settings, "replace a value of the study: key=value")->type_name("KEY=VALUE");
  add_choice(*command, options->choice);
  command->add_flag("--prepare", options->prepare, "of a study: make DIR as 'gust run' does, for 'gust trial'");
  command->add_flag("--json", options->json, "as a JSON array");
  command->footer("Examples:\n  gust plan studies/demo.toml\n  gust plan paper --profile quick");
  command->callback([options] {
    const bool is_paper = names_paper(options->study);
    if (is_paper && options->prepare) throw Error("--prepare is for a study; 'gust trial' runs no trials of a paper");
    if (is_paper && !options->settings.empty()) throw Error("--set is for a study; a paper has --profile and --seeds");
    const ReproductionChoice& choice = options->choice;
    if (!is_paper && (!choice.only.empty() || choice.seeds || !choice.profile.empty()))
      throw Error("--only, --seeds and --profile are for a paper; a study has --set");
    is_paper ? plan_paper(*options) : plan_study(*options);
  });
}

}  // namespace gust
