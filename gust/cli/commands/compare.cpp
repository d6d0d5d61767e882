#include <cmath>
#include <nlohmann/json.hpp>

#include "gust/cli/command.h"
#include "gust/cli/study_command.h"
#include "gust/core/text.h"
#include "gust/study/summary/comparison.h"

namespace gust {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string a, b, folder, start;
  bool json = false;
};

std::size_t policy_of(const Study& study, const std::string& name) {
  std::vector<std::string> known;
  for (std::size_t p = 0; p < study.policies.size(); ++p) {
    if (study.policies[p].name == name) return p;
    known.push_back(study.policies[p].name);
  }
  throw Error(cat("the study has no policy '", name, "'", did_you_mean(name, known), "; it has ", join(known, ", ")));
}

std::size_t start_of(const Study& study, const std::string& name) {
  if (name.empty()) return compared_start(study);
  std::vector<std::string> known;
  for (std::size_t s = 0; s < study.starts.size(); ++s) {
    if (study.starts[s].name == name) return s;
    known.push_back(study.starts[s].name);
  }
  throw Error(cat("the study has no start '", name, "'", did_you_mean(name, known), "; it has ", join(known, ", ")));
}

std::string_view standing_name(Standing standing) {
  constexpr std::string_view kNames[] = {"ahead", "behind", "undecided"};
  return kNames[static_cast<std::size_t>(standing)];
}

std::string sweep_name(const Study& study, const SweepComparison& item) {
  return item.sweep == Trial::kNominal ? "undisturbed" : study.sweeps[item.sweep].name;
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json interval_json(const Interval& interval) {
  Json json = {{"estimate", number(interval.estimate)}, {"low", number(interval.low)}, {"high", number(interval.high)}};
  if (!std::isnan(interval.most)) json["at_most"] = number(interval.most);  // null: at least the estimate
  json["over"] = unit_name(interval.unit);
  json["n"] = interval.n;
  return json;
}

Json difference_json(const SweepComparison& item, const PairedDifference& difference) {
  Json json = interval_json(difference.interval);
  json["verdict"] = standing_name(item.standing_of(difference.interval));
  json["needed"] = number(difference.needed);
  return json;
}

Json sweep_json(const Study& study, const SweepComparison& item) {
  Json levels = Json::array();
  for (std::size_t i = 0; i < item.found.levels.size(); ++i) {
    Json level = {{"level", item.found.levels[i]}};
    level.update(difference_json(item, item.found.scores[i]));
    levels.push_back(std::move(level));
  }
  return {{"sweep", item.sweep == Trial::kNominal ? Json(nullptr) : Json(study.sweeps[item.sweep].name)},
          {"verdict", standing_name(item.standing_of(item.found.over.interval))},
          {"difference", difference_json(item, item.found.over)},
          {"margin_ratio", interval_json(item.found.ratio)},
          {"improvement", interval_json(item.found.improvement)},
          {"needed", item.needed()},
          {"levels", levels}};
}

std::string json_text(const Study& study, const PolicyPair& pair, const std::vector<SweepComparison>& found,
                      const std::vector<std::string>& missing) {
  Json sweeps = Json::array();
  for (const SweepComparison& item : found) sweeps.push_back(sweep_json(study, item));
  return Json{{"study", study.name},
              {"a", study.policies[pair.a].name},
              {"b", study.policies[pair.b].name},
              {"start", study.starts[pair.start].name},
              {"metric", study.metric_set.name(margin_metric(study))},
              {"comparisons", sweeps},
              {"missing", missing}}
             .dump(2, ' ', false, Json::error_handler_t::replace) +
         "\n";
}

/// "0.12 [0.08, 0.15]" without what it was resampled over, which stands once.
std::string bare(Interval interval) {
  interval.unit = Unit::none;
  return std::isnan(interval.estimate) ? "-" : interval_text(interval);
}

std::string share_text(const Interval& share) {
  if (std::isnan(share.low)) return fmt::format("{:.0f} %", 100 * share.estimate);
  return fmt::format("{:.0f} % [{:.0f}, {:.0f}]", 100 * share.estimate, 100 * share.low, 100 * share.high);
}

/// "ahead at 12, behind at 3, undecided at 1 of 16 levels"
std::string levels_text(const SweepComparison& item) {
  std::vector<std::string> parts;
  for (const Standing standing : {Standing::ahead, Standing::behind, Standing::undecided}) {
    const std::size_t count = item.count(standing);
    if (count > 0) parts.push_back(cat(standing_name(standing), " at ", count));
  }
  return cat(join(parts, ", "), " of ", item.found.levels.size(), " levels");
}

std::string sweep_text(const Study& study, const SweepComparison& item) {
  const Comparison& found = item.found;
  std::string text =
      cat(sweep_name(study, item), ": ", study.policies[item.pair.a].name, " is ",
          standing_name(item.standing_of(found.over.interval)), "\n  difference    ", bare(found.over.interval), "\n");
  if (!std::isnan(found.ratio.estimate)) text += cat("  margin ratio  ", bare(found.ratio), "\n");
  text += cat("  improvement   ", share_text(found.improvement), "\n");
  if (found.levels.size() > 1) text += cat("  by level      ", levels_text(item), "\n");
  if (const std::string needed = item.needed(); !needed.empty()) text += cat("  ", needed, "\n");
  return text;
}

std::string plain_text(const Study& study, const PolicyPair& pair, const std::vector<SweepComparison>& found) {
  std::string text = cat(study.policies[pair.a].name, " against ", study.policies[pair.b].name, ": ",
                         study.metric_set.name(margin_metric(study)), " on the same episodes, ",
                         study.starts[pair.start].name, " start, 95 % intervals\n\n");
  for (const SweepComparison& item : found) text += sweep_text(study, item) + "\n";
  return text +
         "Difference: of the mean score over the levels.\n"
         "Improvement: the probability that the first scores higher.\n";
}

int compare_command(const Options& options) {
  const OpenStudy open(options.folder);
  const PolicyPair pair{policy_of(open.study, options.a), policy_of(open.study, options.b),
                        start_of(open.study, options.start)};
  if (pair.a == pair.b) throw Error(cat("'", options.a, "' is compared with itself; name two policies"));
  const std::vector<SweepComparison> found = compare_policies(*open.measured, pair);
  const std::vector<std::string> missing = open.measured->missing({pair.a, pair.b});
  print_lines(options.json ? json_text(open.study, pair, found, missing) : plain_text(open.study, pair, found));
  for (const std::string& trial : missing) tell(cat("not in the store: ", trial));
  const std::size_t lacks = open.study.sweeps.size() + 1 - found.size();
  if (lacks > 0) tell(cat("not in the store: ", lacks, " of ", open.study.sweeps.size() + 1, " comparisons"));
  return lacks == 0 && missing.empty() ? kDone : kTrialFailed;
}

}  // namespace

void command_compare(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("compare", "Says which of two policies is better, and by how much");
  command->add_option("A", options->a, "a policy of the study, by name")->required();
  command->add_option("B", options->b, "the policy to compare it with")->required();
  command->add_option("DIR", options->folder, "the folder that gust run left")->required();
  command->add_option("--start", options->start, "the start, by name; a random one if there is one");
  command->add_flag("--json", options->json, "one JSON object with every level");
  command->footer("Example:\n  gust compare lqr ppo demo.gust");
  command->callback([options, &exit_code] { exit_code = compare_command(*options); });
}

}  // namespace gust
