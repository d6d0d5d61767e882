#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "gust/cli/command.h"
#include "gust/cli/output_file.h"
#include "gust/cli/study_command.h"
#include "gust/store/pack.h"
#include "gust/study/trials/store_check.h"
#include "gust/study/trials/trial_check.h"

namespace gust {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string folder;
  std::string file;
  bool trainings = false;
  bool json = false;
};

/// "2.5 kB", "13.1 MB".
std::string size_text(std::uint64_t bytes) {
  const auto size = static_cast<double>(bytes);
  return size < 1e6 ? fmt::format("{:.1f} kB", size * 1e-3) : fmt::format("{:.1f} MB", size * 1e-6);
}

int pack(const Options& options) {
  check_output(options.file, OutputKind::pack, "FILE");
  const Store store(StudyFolder(options.folder).store(), Store::Access::read, tell);
  const PackCount count = pack_store(store, options.file, options.trainings ? kind_name(Trial::Kind::kTrain) : "",
                                     [](const StoredTrial& trial) { return content_damage(trial, CheckDepth::whole); });
  print_lines(cat(options.file, ": ", count.trials, " trials, ", size_text(count.bytes), "\n"));
  if (count.damaged == 0) return kDone;
  tell(cat(options.file, ": lacks ", count.damaged, count.damaged == 1 ? " damaged trial" : " damaged trials",
           "; run the study again"));
  return kTrialFailed;
}

int unpack(const Options& options) {
  check_pack(options.file);  // before anything is made
  const Store store(StudyFolder(options.folder).store(), Store::Access::write, tell);
  const PackCount count = unpack_store(options.file, store);
  print_lines(cat(options.folder, ": ", count.trials, " trials added, ", count.present, " were there\n"));
  return count.disagreeing == 0 ? kDone : kTrialFailed;
}

/// The plan of the study in a folder, if one lies there whole: then its trials must be what the study asks for too.
std::optional<Plan> plan_in(const std::filesystem::path& folder, const std::filesystem::path& store,
                            std::vector<StoreProblem>& problems) {
  std::error_code unknown;
  if (!std::filesystem::exists(folder / "study.toml", unknown) || !Store::is_at(store)) return std::nullopt;
  std::optional<Study> study;
  try {
    study = StudyFolder(folder).open();
  } catch (const Error& error) {
    problems.push_back({(folder / "study.toml").string(), error.what()});
    return std::nullopt;
  }
  try {
    return plan_with_store(*study, Store(store, Store::Access::read));
  } catch (const Error&) {  // the look at the store says what is wrong with it
    return std::nullopt;
  }
}

Json problems_json(const std::vector<StoreProblem>& problems) {
  Json list = Json::array();
  for (const StoreProblem& problem : problems) list.push_back({{"path", problem.path}, {"what", problem.what}});
  return list;
}

void tell_check(const Options& options, const std::string& store, const StoreCheck& check) {
  if (options.json) {
    const Json json = {{"store", store},
                       {"whole", check.whole},
                       {"damaged", problems_json(check.damaged)},
                       {"leftover", problems_json(check.leftover)}};
    return print_lines(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  }
  for (const StoreProblem& problem : check.damaged) print_lines(cat(problem.path, ": ", problem.what, "\n"));
  for (const StoreProblem& problem : check.leftover) print_lines(cat(problem.path, ": ", problem.what, "\n"));
  print_lines(cat(store, ": ", check.whole, " trials whole, ", check.damaged.size(), " damaged, ",
                  check.leftover.size(), " left by processes that are gone\n"));
}

int check(const Options& options) {
  const std::filesystem::path store = store_in(options.folder);
  std::vector<StoreProblem> problems;
  const std::optional<Plan> plan = plan_in(options.folder, store, problems);
  StoreCheck found = check_store(store, plan ? &*plan : nullptr);
  std::ranges::move(problems, std::back_inserter(found.damaged));
  tell_check(options, store.string(), found);
  return found.is_clean() ? kDone : kTrialFailed;
}

int repair(const Options& options) {
  const std::filesystem::path store = store_in(options.folder);
  std::vector<StoreProblem> problems;
  const std::optional<Plan> plan = plan_in(options.folder, store, problems);
  StoreCheck found = repair_store(store, plan ? &*plan : nullptr, tell);
  for (const StoreProblem& problem : problems) tell(problem.what);
  tell_check(options, store.string(), found);
  if (!found.damaged.empty()) tell("gust run computes again what was moved aside");
  return problems.empty() ? kDone : kTrialFailed;
}

void add_arguments(CLI::App& command, const std::shared_ptr<Options>& options, bool folder_first) {
  const auto add_folder = [&] {
    command.add_option("DIR", options->folder, "a folder that gust run made")->required();
  };
  if (folder_first) add_folder();
  command.add_option("FILE", options->file, "the pack")->required();
  if (!folder_first) add_folder();
}

}  // namespace

void command_store(CLI::App& app, int& exit_code) {
  CLI::App* store = app.add_subcommand("store", "Packs, unpacks, checks and repairs finished trials");
  store->require_subcommand(1);
  const auto options = std::make_shared<Options>();

  CLI::App* packing = store->add_subcommand("pack", "Writes the finished trials of DIR into one compressed FILE");
  add_arguments(*packing, options, /*folder_first=*/true);
  packing->add_flag("--trainings", options->trainings, "only what takes long; the rest is measured again from it");
  packing->footer("Example:\n  gust store pack demo.gust demo.pack");
  packing->callback([options, &exit_code] { exit_code = pack(*options); });

  const auto add_check = [&](CLI::App& command, const char* example) {
    command.add_option("DIR", options->folder, "a folder that gust run made, or a store")->required();
    command.add_flag("--json", options->json, "what was found, as one JSON object");
    command.footer(cat("Example:\n  ", example));
  };
  CLI::App* checking = store->add_subcommand("check", "Reads every byte of a store, and changes nothing");
  add_check(*checking, "gust store check demo.gust --json");
  checking->callback([options, &exit_code] { exit_code = check(*options); });

  CLI::App* repairing = store->add_subcommand("repair", "Moves damaged trials aside, and removes what the dead left");
  add_check(*repairing, "gust store repair demo.gust && gust run studies/demo.toml --out demo.gust");
  repairing->callback([options, &exit_code] { exit_code = repair(*options); });

  CLI::App* unpacking =
      store->add_subcommand("unpack", "Adds the trials of FILE to DIR; none that is whole is touched");
  add_arguments(*unpacking, options, /*folder_first=*/false);
  unpacking->footer("Example:\n  gust store unpack demo.pack demo.gust && gust run studies/demo.toml --out demo.gust");
  unpacking->callback([options, &exit_code] { exit_code = unpack(*options); });
}

}  // namespace gust
