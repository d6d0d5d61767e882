#include "gust/study/export.h"

#include "gust/cli/command.h"
#include "gust/cli/study_command.h"

namespace gust {

void command_export(CLI::App& app, int&) {
  struct Options {
    std::string folder, csv, sqlite;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("export", "Writes every episode of a study as one table");
  command->add_option("DIR", options->folder, "the folder that gust run left")->required();
  CLI::Option* csv = command->add_option("--csv", options->csv, "CSV file: a row an episode and metric, in plan order");
  CLI::Option* sqlite =
      command->add_option("--sqlite", options->sqlite, "SQLite file: the same, and the learning curves");
  csv->type_name("FILE");
  sqlite->type_name("FILE");
  command->footer("Example:\n  gust export demo.gust --csv demo.csv");
  command->callback([options] {
    if (options->csv.empty() && options->sqlite.empty())
      throw Error("where to? give --csv FILE, --sqlite FILE, or both (gust export --help)");
    if (options->csv == options->sqlite) throw Error("--csv and --sqlite: name two files");
    const OpenStudy open = open_study(options->folder);
    if (!options->csv.empty()) export_csv(open.study, open.plan, *open.store, options->csv);
    if (!options->sqlite.empty()) export_sqlite(open.study, open.plan, *open.store, options->sqlite);
  });
}

}  // namespace gust
