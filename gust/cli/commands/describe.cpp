#include <fmt/format.h>

#include "gust/cli/catalogue.h"
#include "gust/cli/command.h"

namespace gust {

void command_describe(CLI::App& app, int&) {
  struct Options {
    std::string kind, name;
    bool json = false;
  };
  auto options = std::make_shared<Options>();  // shared: the callback outlives this function
  CLI::App* command = app.add_subcommand("describe", "Says all about one plant, waveform, agent, metric, preset, site");
  command->add_option("KIND", options->kind, "plant, waveform, agent, metric, preset, site or command")->required();
  command->add_option("NAME", options->name, "which one (gust list KIND)")->required();
  command->add_flag("--json", options->json, "as one JSON object");
  command->footer("Example:\n  gust describe waveform sawtooth");
  command->callback([&app, options] {
    const std::vector<CatalogueKind> kinds = catalogue(app);
    const CatalogueKind& kind = find_kind(kinds, options->kind);
    const CatalogueItem& item = find_item(kind, options->name);
    fmt::print("{}", options->json ? describe_json(kind, item) : describe_text(kind, item));
  });
}

}  // namespace gust
