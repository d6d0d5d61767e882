#include "gust/cli/eval.h"

#include <algorithm>

#include "gust/cli/settings.h"
#include "gust/cli/text_output.h"
#include "gust/study/policies/file_policy.h"
#include "gust/study/text/parse.h"
#include "gust/study/text/warnings.h"
#include "gust/study/trials/folder.h"
#include "gust/study/trials/policy_notes.h"

namespace gust {
namespace {

constexpr std::int64_t kMostEpisodes = 100'000;

/// A request read and checked; the evaluation refers to the rest.
struct Prepared {
  Setup setup;
  Table policy;  ///< its keys that --set gave
  std::vector<Injection> injections;
  SweepCell cell;
  StartProtocol start;
  std::int64_t episodes = 1;
  bool terminate = true;
};

/// The options of --set, by what they belong to.
struct Settings {
  Table plant, readings, shape, injection, policy;
};

std::vector<std::string> names_of(const std::vector<FieldInfo>& fields) {
  std::vector<std::string> names;
  for (const FieldInfo& field : fields) names.push_back(field.name);
  return names;
}

/// Window and channels are the injection's, so "start" is the window's; where an episode starts is --start's.
Settings read_settings(const EvalRequest& request) {
  Settings settings;
  std::vector<SettingGroup> groups = {{&settings.injection, {"channels", "mask", "start", "end"}},
                                      {&settings.readings, field_names<Readings>()}};
  if (!request.waveform.empty())
    groups.push_back({&settings.shape, names_of(waveforms().at(request.waveform, {"--waveform"}).fields)});
  if (!request.effect.empty())
    groups.push_back({&settings.shape, names_of(effects().at(request.effect, {"--effect"}).fields)});
  groups.push_back({&settings.plant, names_of(plant_fields(request.plant, {"--plant"}))});
  groups.push_back({&settings.policy, names_of(request.kind().fields)});
  sort_settings(
      request.settings, groups,
      request.shape().empty() ? "; options of a disturbance need --site, --waveform or --effect, and --level" : "");
  return settings;
}

Setup prepare_setup(const EvalRequest& request, const Settings& settings) {
  Table plant = settings.plant;
  plant.place = {"--plant"};
  plant.set("kind", {request.plant, {"--plant"}});
  set_preset(plant, request.preset, {"--preset"});
  return make_setup(plant, &settings.readings);
}

std::vector<Injection> prepare_injections(const EvalRequest& request, const Settings& settings, const Interface& spec) {
  if (!request.waveform.empty() && !request.effect.empty())
    throw Error("--effect: a disturbance has a --waveform or an --effect, not both");
  const bool any = !request.site.empty() || !request.shape().empty() || !request.level.empty();
  const bool all = !request.site.empty() && !request.shape().empty() && !request.level.empty();
  if (any && !all) throw Error("a disturbance needs all of --site, --waveform (or --effect) and --level");
  if (!any && !settings.injection.items.empty()) {
    throw Error(cat("--set: '", settings.injection.items.front().first,
                    "' belongs to a disturbance: give --site, --waveform (or --effect) and --level"));
  }
  std::vector<Injection> injections;
  if (!any) return injections;
  const char* key = request.effect.empty() ? "waveform" : "effect";
  Table shape = settings.shape;
  shape.place = {"--set"};
  shape.set("kind", {request.shape(), {cat("--", key)}});
  Table table = settings.injection;
  table.set("site", {request.site, {"--site"}});
  table.set(key, {shape, {"--set"}});
  table.set("level", value_from_text(request.level, {"--level"}));
  injections.push_back(parse_injection(table, spec));
  return injections;
}

/// The parameters of the plant that the policy meets. Each must be one that the plant could have been made with.
std::vector<double> prepare_parameters(const EvalRequest& request, const Settings& settings, const Setup& setup) {
  const Interface& spec = setup.plant->spec();
  std::vector<double> values = nominal_parameters(spec);
  std::vector<std::string> names;
  for (const Parameter& parameter : spec.parameters) names.push_back(parameter.name);
  Settings other = settings;
  for (const std::string& text : request.parameters) {
    const Setting pair = split_setting(text, "--param");
    const auto at = std::ranges::find(names, pair.key);
    if (at == names.end()) {
      throw Error(cat("--param: unknown parameter '", pair.key, "'", did_you_mean(pair.key, names), "; the plant ",
                      setup.plant.kind, " has ", join(names, ", ")));
    }
    const bool scaled = pair.text.front() == 'x';
    const double number = value_from_text(pair.text.substr(scaled ? 1 : 0), {"--param"}).as_number(pair.key);
    double& value = values[static_cast<std::size_t>(at - names.begin())];
    value = scaled ? value * number : number;
    other.plant.set(pair.key, {value, {"--param"}});
  }
  prepare_setup(request, other);
  return values;
}

/// "x,x_dot,…": a number for every state of the plant.
StartProtocol explicit_start(const std::string& text, const LoopSource& source) {
  const Value value = value_from_text(text, {"--start"});
  std::vector<std::string> names, words;
  for (const Component& component : source.spec().state) names.push_back(component.name);
  for (const StartProtocol& start : source.starts()) words.push_back(start.name);
  if (names.empty() || std::holds_alternative<std::string>(value.data)) {
    const std::string state = names.empty() ? "" : cat(" or ", join(names, ","));
    throw Error(cat("--start: must be ", join(words, ", "), state, ", got '", text, "'", did_you_mean(text, words)));
  }
  StartProtocol start{text, false, value.as_numbers("start")};
  if (start.state.size() == names.size()) return start;
  throw Error(cat("--start: must have ", names.size(), " numbers (", join(names, ","), "), got ", start.state.size()));
}

StartProtocol named_start(const std::string& text, const LoopSource& source) {
  std::vector<StartProtocol> starts = source.starts();
  if (text.empty()) return std::move(starts.front());
  const auto named = std::ranges::find(starts, text, &StartProtocol::name);
  return named != starts.end() ? std::move(*named) : explicit_start(text, source);
}

StartProtocol prepare_start(const std::string& text, const LoopSource& source) {
  StartProtocol start = named_start(text, source);
  if (const std::string complaint = source.start_complaint(start); !complaint.empty())
    throw Error(cat("--start: ", complaint));
  return start;
}

Prepared prepare(const EvalRequest& request) {
  const Settings settings = read_settings(request);
  Prepared prepared;
  prepared.setup = prepare_setup(request, settings);
  prepared.policy = settings.policy;
  const Interface& spec = prepared.setup.plant->spec();
  prepared.injections = prepare_injections(request, settings, spec);
  prepared.cell.parameters = prepare_parameters(request, settings, prepared.setup);
  for (const Injection& injection : prepared.injections) prepared.cell.levels.push_back(injection.level);
  prepared.start = prepare_start(request.start, *prepared.setup.plant);
  prepared.episodes = checked_episodes(request, prepared.start.random ? 25 : 1);
  if (request.terminate != "yes" && request.terminate != "no") {
    throw Error(cat("--terminate: must be yes or no, got '", request.terminate, "'"));
  }
  prepared.terminate = request.terminate == "yes";
  if (!prepared.terminate && !spec.goes_on)
    throw Error("--terminate: must be yes: the plant tells nothing after a failure");
  return prepared;
}

/// The table of the policy: a name or a file, and the options that its kind has.
Table policy_table(const EvalRequest& request, const PolicyKind& kind, Table table) {
  table.place = {"POLICY"};
  if (request.has_file()) table.set("file", {request.policy, table.place});
  if (!request.has_file() && !request.output.empty()) throw Error("--output: is for a policy in a file");
  const std::vector<std::string> keys = names_of(kind.fields);
  const std::pair<const char*, const std::string*> options[] = {
      {"output", &request.output}, {"observe", &request.observe}, {"act", &request.act}, {"units", &request.units}};
  for (const auto& [key, text] : options) {
    if (text->empty()) continue;
    if (std::ranges::find(keys, key) == keys.end())
      throw Error(cat("--", key, ": is for a policy from a file; '", request.policy, "' is gust's own"));
    if (table.contains(key)) throw Error(cat("--", key, ": is given by --set as well"));
    table.set(key, setting_value(*text, {cat("--", key)}));
  }
  return table;
}

std::shared_ptr<const PolicySource> prepare_policy(const EvalRequest& request, const Setup& setup, const Table& keys,
                                                   const StudyFile& file) {
  const PolicyKind& kind = request.kind();
  if (kind.trained)
    throw Error(cat("POLICY: '", kind.name, "' has to be trained first (gust train); give the file that it leaves"));
  const FindFiles find = [&](const std::string& pattern, const Place& place) {
    return request.has_file() ? std::vector{file} : files_beside({})(pattern, place);
  };
  return kind.read(policy_table(request, kind, keys), {setup, find, {"POLICY"}});
}

/// The hint if most episodes, which nothing disturbs, end within a second.
std::string failure_note(const std::string& policy, const std::vector<EvalRow>& rows, const Interface& spec) {
  const std::optional<std::size_t> time = MetricSet(spec).first(MetricRole::failure_time);
  const auto early = std::ranges::count_if(rows, [&](const EvalRow& row) {
    return time && row.failed && row.not_finite.empty() && row.metrics[*time] <= kAtOnce;
  });
  const std::string failure = failure_hint_text(static_cast<std::size_t>(early), rows.size());
  return failure.empty() ? failure : cat(policy, ": ", failure, interface_hint(spec));
}

/// The metrics of a row. Those that sum over an episode's steps sum over the row's; the others keep their definition.
std::vector<double> row_metrics(const MetricSet& set, const Episode& episode, bool terminate) {
  Episode row = episode;
  row.ended = row.whole = episode.part(terminate);
  std::vector<double> values;
  for (std::size_t i = 0; i < set.size(); ++i) {
    values.push_back(set[i].value(set[i].traits().sums_over_row ? row : episode));
  }
  return values;
}

}  // namespace

std::int64_t checked_episodes(const EvalRequest& request, std::int64_t standard) {
  if (!request.episodes) return standard;
  if (*request.episodes >= 1 && *request.episodes <= kMostEpisodes) return *request.episodes;
  throw Error(cat("--episodes: must be 1 to ", kMostEpisodes, ", got ", *request.episodes));
}

const PolicyKind& EvalRequest::kind() const {
  for (const PolicyKind& kind : policy_kinds()) {
    if (kind.name == policy || (!kind.file_ending.empty() && policy.ends_with(kind.file_ending))) return kind;
  }
  std::vector<std::string> names, endings;
  for (const PolicyKind& kind : policy_kinds()) {
    if (!kind.trained) names.push_back(kind.name);
    if (!kind.file_ending.empty()) endings.push_back(kind.file_ending);
  }
  throw Error(cat("POLICY: unknown policy '", policy, "'", did_you_mean(policy, names), "; policies are ",
                  join(names, ", "), ", or a file that ends in ", join(endings, ", ")));
}

bool EvalRequest::has_file() const { return kind().name != policy; }

EvalRow eval_row(const Evaluation& evaluation, const EpisodeIndex& index, const Episode& episode, bool terminate) {
  const EpisodePart& part = episode.part(terminate);
  const std::optional<NotFiniteAction> action = not_finite_action(evaluation, index, episode);
  return {.seed = {},
          .episode = index.episode,
          .length = part.steps,
          .failed = episode.failed,
          .finite = episode.finite,
          .return_sum_commanded = part.return_commanded,
          .return_sum_disturbed = part.return_disturbed,
          .metrics = {},
          .applies = {},
          .initial_state = start_state(evaluation, index),
          .final_state = part.final_state,
          .not_finite = action ? not_finite_text(*action, evaluation.source->spec()) : std::string()};
}

EvalResult run_eval(const EvalRequest& request, std::string_view policy_bytes, const OnnxData& data) {
  const Prepared prepared = prepare(request);
  for (const std::string& warning : plant_warnings(prepared.setup)) tell(cat("warning: ", warning));
  const auto source =
      prepare_policy(request, prepared.setup, prepared.policy, {request.policy, std::string(policy_bytes), data});
  const std::unique_ptr<Policy> policy = source->make(prepared.setup, {});
  const Interface& spec = prepared.setup.plant->spec();
  for (const std::string& warning : wave_warnings(prepared.injections, spec)) tell(cat("warning: ", warning));
  const Evaluation evaluation{.source = prepared.setup.plant.object.get(),
                              .injections = prepared.injections,
                              .cells = {prepared.cell},
                              .starts = {prepared.start},
                              .episodes = prepared.episodes,
                              .root = Rng(static_cast<std::uint64_t>(request.seed))};
  EvalResult result{.metrics = MetricSet(spec), .two_efforts = prepared.setup.plant->plant() != nullptr};
  const MetricSet& metric_set = result.metrics;
  std::vector<EvalRow>& rows = result.rows;
  evaluate(evaluation, *policy, [&](const EpisodeIndex& index, const Episode& episode) {
    rows.push_back(eval_row(evaluation, index, episode, prepared.terminate));
    rows.back().metrics = row_metrics(metric_set, episode, prepared.terminate);
    rows.back().applies = metric_set.applying(evaluation.source->spec());
  });
  result.notes = source->warnings();
  const bool undisturbed = prepared.injections.empty() && request.parameters.empty();
  if (source->foreign() && undisturbed) result.notes.push_back(failure_note(request.policy, rows, spec));
  std::erase(result.notes, "");
  return result;
}

}  // namespace gust
