#include <fmt/format.h>

#include "gust/cli/command.h"
#include "gust/cli/study_command.h"
#include "gust/study/files.h"
#include "gust/study/pack.h"

namespace gust {
namespace {

struct Options {
  std::string folder;
  std::string file;
  bool trainings = false;
};

/// "2.5 kB", "13.1 MB".
std::string size_text(std::uint64_t bytes) {
  const auto size = static_cast<double>(bytes);
  return size < 1e6 ? fmt::format("{:.1f} kB", size * 1e-3) : fmt::format("{:.1f} MB", size * 1e-6);
}

int pack(const Options& options) {
  check_folder_of(options.file, "FILE");
  const Store store(StudyFolder(options.folder).store(), Store::Access::read, tell);
  const PackCount count = pack_store(store, options.file, options.trainings ? kind_name(Trial::Kind::kTrain) : "");
  print_lines(cat(options.file, ": ", count.trials, " trials, ", size_text(count.bytes), "\n"));
  if (count.damaged == 0) return kDone;
  tell(cat(options.file, ": lacks ", count.damaged, count.damaged == 1 ? " damaged trial" : " damaged trials",
           "; run the study again"));
  return kTrialFailed;
}

void unpack(const Options& options) {
  check_pack(options.file);  // before anything is made
  const Store store(StudyFolder(options.folder).store(), Store::Access::write, tell);
  const PackCount count = unpack_store(options.file, store);
  print_lines(cat(options.folder, ": ", count.trials, " trials added, ", count.present, " were there\n"));
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
  CLI::App* store = app.add_subcommand("store", "Packs finished trials into one file, and unpacks them");
  store->require_subcommand(1);
  const auto options = std::make_shared<Options>();

  CLI::App* packing = store->add_subcommand("pack", "Writes the finished trials of DIR into one compressed FILE");
  add_arguments(*packing, options, /*folder_first=*/true);
  packing->add_flag("--trainings", options->trainings, "only what takes long; the rest is measured again from it");
  packing->footer("Example:\n  gust store pack demo.gust demo.pack");
  packing->callback([options, &exit_code] { exit_code = pack(*options); });

  CLI::App* unpacking =
      store->add_subcommand("unpack", "Adds the trials of FILE to DIR; none that is whole is touched");
  add_arguments(*unpacking, options, /*folder_first=*/false);
  unpacking->footer("Example:\n  gust store unpack demo.pack demo.gust && gust run studies/demo.toml --out demo.gust");
  unpacking->callback([options] { unpack(*options); });
}

}  // namespace gust
