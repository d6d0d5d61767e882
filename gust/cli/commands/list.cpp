#include <fmt/format.h>

#include "gust/cli/catalogue.h"
#include "gust/cli/command.h"

namespace gust {

void command_list(CLI::App& app, int&) {
  struct Options {
    std::string kind;
    bool json = false;
  };
  auto options = std::make_shared<Options>();  // shared: the callback outlives this function
  CLI::App* command = app.add_subcommand("list", "Lists plants, waveforms, agents, metrics, presets, sites, commands");
  command->add_option("KIND", options->kind, "one of them (default: all)");
  command->add_flag("--json", options->json, "as JSON: an array, or without KIND an object of arrays");
  command->footer("Example:\n  gust list waveforms\n\ngust describe KIND NAME says more about one.");
  command->callback([&app, options] {
    const std::vector<CatalogueKind> kinds = catalogue(app);
    if (options->kind.empty()) return fmt::print("{}", options->json ? list_json(kinds) : list_text(kinds));
    const CatalogueKind& kind = find_kind(kinds, options->kind);
    fmt::print("{}", options->json ? list_json(kind) : list_text({kind}));
  });
}

}  // namespace gust
