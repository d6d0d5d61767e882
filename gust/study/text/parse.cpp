#include "gust/study/text/parse.h"

#include <algorithm>
#include <numeric>

#include "gust/setup/toml.h"
#include "gust/study/trials/trials.h"

namespace gust {
namespace {

constexpr std::int64_t kSchema = 1;
constexpr std::size_t kLongestName = 200;
constexpr std::size_t kMostCells = 20'000'000;  // of all policies and sweeps

/// The tables of "[[key]]", none if it is absent.
std::vector<const Table*> tables_of(const Table& study, std::string_view key) {
  std::vector<const Table*> tables;
  const Value* list = study.find(key);
  if (list == nullptr) return tables;
  for (const Value& item : list->as_list(key)) tables.push_back(&item.as_table(key));
  return tables;
}

template <class Item>
void check_new_name(const std::vector<Item>& items, const std::string& name, const Place& place, const char* what) {
  for (const Item& item : items) {
    if (item.name == name)
      throw error_at(place, "duplicate ", what, " name '", name, "'; every ", what, " needs its own");
  }
}

/// An explicit initial state: { x = 0.1, theta = 0.05 }, the rest as in the preset.
StartProtocol explicit_start(const Table& table, const LoopSource& source) {
  std::vector<std::string> names;
  for (const Component& component : source.spec().state) names.push_back(component.name);
  if (names.empty()) throw error_at(table.place, "the plant tells no state that a start could set; name a start");
  check_keys(table, names, "a start");
  StartProtocol start = source.starts().front();
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Value* value = table.find(names[i]);
    if (value == nullptr) continue;
    start.state[i] = value->as_number(names[i]);
    parts.push_back(cat(names[i], "=", start.state[i]));
  }
  start.name = parts.empty() ? "nominal" : join(parts, " ");
  return start;
}

StartProtocol any_start(const Value& value, const LoopSource& source) {
  if (const auto* table = std::get_if<Table>(&value.data)) return explicit_start(*table, source);
  const std::string& name = value.as_text("start");
  std::vector<std::string> names;
  for (StartProtocol& start : source.starts()) {
    if (start.name == name) return std::move(start);
    names.push_back(start.name);
  }
  const bool states = !source.spec().state.empty();
  const std::string state = states ? cat(", or a state such as { ", source.spec().state.front().name, " = 0.1 }") : "";
  throw error_at(value.place, "unknown start '", name, "'", did_you_mean(name, names), "; starts are ",
                 join(names, ", "), state);
}

StartProtocol parse_start(const Value& value, const LoopSource& source) {
  StartProtocol start = any_start(value, source);
  if (const std::string complaint = source.start_complaint(start); !complaint.empty())
    throw error_at(value.place, "start: ", complaint);
  return start;
}

void parse_evaluate(const Table& table, Study& study) {
  check_keys(table, {"episodes", "start", "terminate", "metrics", "disturb", "margin_tolerance"}, "[evaluate]");
  const LoopSource& source = *study.setup.plant;
  study.episodes = optional_int(table, "episodes", study.episodes, positive);
  if (const Value* terminate = table.find("terminate")) {
    study.terminate = terminate->as_bool("terminate");
    if (!study.terminate && !source.spec().goes_on)
      throw error_at(terminate->place, "'terminate' must be true: the plant tells nothing after a failure");
  }
  if (const Value* tolerance = table.find("margin_tolerance"))
    read_value(study.margin_tolerance, *tolerance, "margin_tolerance", between(0.0, 0.5));
  if (const Value* start = table.find("start")) {
    study.starts.clear();
    const auto* list = std::get_if<Value::List>(&start->data);
    if (list == nullptr) study.starts.push_back(parse_start(*start, source));
    for (const Value& item : list ? *list : Value::List{}) {
      study.starts.push_back(parse_start(item, source));
      for (std::size_t i = 0; i + 1 < study.starts.size(); ++i) {
        if (study.starts[i].name == study.starts.back().name)
          throw error_at(item.place, "duplicate start '", study.starts[i].name, "'");
      }
    }
    if (study.starts.empty()) throw error_at(start->place, "'start' must name at least one start: nominal, random");
  }
  if (const std::string wrong = complaint(rows_header(study, 1)); !wrong.empty()) {
    const Value* episodes = table.find("episodes");
    throw error_at(episodes ? episodes->place : table.place, wrong);
  }
  if (const Value* names = table.find("metrics")) {
    study.metrics.clear();
    for (const Value& name : names->as_list("metrics")) {
      const std::size_t index = study.metric_set.index(name.as_text("metrics"), name.place);
      if (std::ranges::find(study.metrics, index) == study.metrics.end()) study.metrics.push_back(index);
    }
    if (study.metrics.empty()) throw error_at(names->place, "'metrics' must name at least one (gust list metrics)");
  }
  if (const Value* disturb = table.find("disturb")) study.always = parse_disturb(*disturb, source.spec());
}

/// The sweeps, of which every policy, seed by seed, measures every level.
void parse_sweeps(const Table& table, Study& study) {
  std::size_t members = 0;
  for (const StudyPolicy& policy : study.policies) members += policy.count();
  std::size_t cells = 0;
  for (const Table* sweep : tables_of(table, "sweep")) {
    Sweep parsed = parse_sweep(*sweep, study);
    check_new_name(study.sweeps, parsed.name, sweep->find("name")->place, "sweep");
    cells += members * std::max<std::size_t>(1, parsed.cells());
    if (cells > kMostCells) {
      throw error_at(sweep->place, "with sweep '", parsed.name, "' the study has ", cells,
                     " cells (policies and seeds times levels); at most ", kMostCells);
    }
    study.sweeps.push_back(std::move(parsed));
  }
}

void parse_head(const Table& table, Study& study) {
  check_keys(table,
             {"schema", "name", "question", "seed", "plant", "readings", "evaluate", "policy", "sweep", "names",
              "claim", "report"},
             "the study");
  const Value* schema = table.find("schema");
  if (schema == nullptr) throw error_at(table.place, "a study begins with 'schema = ", kSchema, "'");
  if (schema->as_int("schema") != kSchema) {
    throw error_at(schema->place, "this gust reads schema ", kSchema, ", got ", schema->as_int("schema"));
  }
  study.name = checked_name(table, "name", "the study");
  if (study.name.find_first_of("/\\") != std::string::npos || study.name.front() == '.') {
    throw error_at(table.find("name")->place, "'name' names the result folder: no slashes, no leading dot, got '",
                   study.name, "'");
  }
  if (const Value* question = table.find("question")) study.question = question->as_text("question");
  study.seed = optional_int(table, "seed", study.seed, non_negative);
  const Value* plant = table.find("plant");
  if (plant == nullptr)
    throw error_at(table.place,
                   "a study needs a plant, such as plant = { kind = \"cartpole\", preset = \"scg-2022\" }");
  const Value* readings = table.find("readings");
  study.setup = make_setup(plant->as_table("plant"), readings ? &readings->as_table("readings") : nullptr);
}

/// "dynamics step(offset = 2) on fx in steps 25:50 at 0.2": all that makes it another one.
std::string injection_text(const Injection& injection, const Interface& spec) {
  const bool all = std::ranges::all_of(injection.factors, [](double factor) { return factor == 1; });
  const std::string& waveform = injection.shape();
  const std::string shape = waveform.ends_with("()") ? injection.kind() : waveform;
  const std::int64_t end = std::min(injection.end, spec.steps);
  const bool whole = injection.start == 0 && end == spec.steps;
  return cat(site_name(injection.site), " ", shape, all ? "" : cat(" on ", channels_text(injection, spec)),
             whole ? "" : cat(" in steps ", injection.start, ":", end), " at ", injection.level);
}

}  // namespace

std::size_t Sweep::cells() const {
  std::size_t cells = 1;
  for (const Axis& axis : axes) cells *= axis.values.size();
  return cells;
}

std::vector<double> Sweep::at(std::size_t cell) const {
  std::vector<double> values(axes.size());
  for (std::size_t a = axes.size(); a-- > 0; cell /= axes[a].values.size())
    values[a] = axes[a].values[cell % axes[a].values.size()];
  return values;
}

std::string Sweep::unit(const Interface& spec, std::size_t axis) const {
  if (!axes[axis].parameter.empty()) return spec.parameters[axes[axis].index].unit;
  if (injection->is_effect()) return std::string(injection->effect->unit());
  const std::vector<Component>& channels = channels_of(injection->site, spec);
  std::vector<std::string> units;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const bool known = std::ranges::find(units, channels[c].unit) != units.end();
    if (injection->factors[c] != 0 && !known) units.push_back(channels[c].unit);
  }
  return join(units, ", ");
}

std::string channels_text(const Injection& injection, const Interface& spec) {
  const std::vector<Component>& channels = channels_of(injection.site, spec);
  std::vector<std::string> parts;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const double factor = injection.factors[c];
    if (factor != 0) parts.push_back(factor == 1 ? channels[c].name : cat(channels[c].name, "=", factor));
  }
  return join(parts, " ");
}

std::string Sweep::setting(const Interface& spec) const {
  std::vector<std::string> parts;
  for (const auto& [index, value] : parameters) parts.push_back(cat(spec.parameters[index].name, " = ", value));
  for (const Injection& injection : disturbed) parts.push_back(injection_text(injection, spec));
  return join(parts, ", ");
}

std::vector<std::size_t> starts_to_tell(const Study& study, std::string_view first) {
  std::vector<std::size_t> order(study.starts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_partition(order, [&](std::size_t start) { return study.starts[start].random; });
  std::ranges::stable_partition(order, [&](std::size_t start) { return study.starts[start].name == first; });
  return order;
}

std::size_t margin_metric(const Study& study) {
  for (const std::size_t metric : study.metrics) {
    const MetricTraits& traits = study.metric_set[metric].traits();
    if (traits.higher_is_better && traits.role != MetricRole::survival) return metric;
  }
  return study.metric_set.leading().front();
}

const std::string& required_text(const Table& table, std::string_view key, std::string_view what) {
  const Value* value = table.find(key);
  if (value == nullptr) throw error_at(table.place, what, key.front() == 'i' ? " needs an '" : " needs a '", key, "'");
  return value->as_text(key);
}

std::string checked_name(const Table& table, std::string_view key, std::string_view what) {
  const std::string name = required_text(table, key, what);
  const bool control = std::ranges::any_of(name, [](unsigned char letter) { return letter < 0x20 || letter == 0x7f; });
  if (name.empty() || name.size() > kLongestName || control) {
    throw error_at(table.find(key)->place, "'", key, "' must be 1 to ", kLongestName, " printable characters");
  }
  return name;
}

std::int64_t optional_int(const Table& table, std::string_view key, std::int64_t standard, const Range& range) {
  if (const Value* value = table.find(key)) read_value(standard, *value, key, range);
  return standard;
}

Injection parse_injection(const Table& table, const Interface& spec, const std::vector<std::string>& also) {
  const Value* channels = table.find("channels");
  const Value* mask = table.find("mask");
  if (channels && mask) throw error_at(mask->place, "'mask' and 'channels' say the same; give one of them");
  Injection injection = read_injection(table, spec, also);
  if (std::ranges::any_of(injection.factors, [](double factor) { return factor != 0; })) return injection;
  std::vector<std::string> names;
  for (const Component& channel : channels_of(injection.site, spec)) names.push_back(channel.name);
  const Value* chosen = mask ? mask : channels;
  throw error_at(chosen ? chosen->place : table.place, "disturbs nothing; choose at least one of the channels ",
                 join(names, ", "), " with a factor that is not 0");
}

std::vector<Injection> parse_disturb(const Value& list, const Interface& spec) {
  std::vector<Injection> injections;
  for (const Value& item : list.as_list("disturb")) {
    const Table& table = item.as_table("disturb");
    if (!table.contains("level")) throw error_at(table.place, "a disturbance that is always on needs a 'level'");
    injections.push_back(parse_injection(table, spec));
    const std::string complaint = together_complaint(injections);
    if (!complaint.empty()) throw error_at(table.place, complaint);
  }
  return injections;
}

Study parse_study(std::string_view bytes, std::string_view name, const std::vector<std::string>& settings,
                  const FindFiles& find) {
  Table table = parse_toml(bytes, name);
  for (const std::string& setting : settings) apply_setting(table, setting);
  Study study;
  study.text = bytes;
  const FindFiles keep = [&](const std::string& pattern, const Place& place) {
    return study.found.emplace_back(find(pattern, place));
  };
  parse_head(table, study);
  study.starts = study.setup.plant->starts();
  study.metric_set = MetricSet(study.setup.plant->spec());
  study.metrics = study.metric_set.leading();
  if (const Value* evaluate = table.find("evaluate")) parse_evaluate(evaluate->as_table("evaluate"), study);
  for (const StartProtocol& start : study.starts) {  // those of the study are checked: the plant's own
    if (const std::string complaint = study.setup.plant->start_complaint(start); !complaint.empty())
      throw error_at(table.find("plant")->place, "start: ", complaint);
  }
  for (const Table* policy : tables_of(table, "policy")) {
    StudyPolicy parsed = parse_policy(*policy, study, keep);
    check_new_name(study.policies, parsed.name, policy->find("name")->place, "policy");
    study.policies.push_back(std::move(parsed));
  }
  if (study.policies.empty()) throw error_at(table.place, "a study needs at least one [[policy]]");
  parse_sweeps(table, study);
  if (const Value* names = table.find("names")) study.names = parse_names(names->as_table("names"));
  for (const Table* claim : tables_of(table, "claim")) {
    study.claims.push_back(parse_claim_of(*claim, study));
    for (std::size_t i = 0; i + 1 < study.claims.size(); ++i) {
      if (study.claims[i].id == study.claims.back().id)
        throw error_at(claim->find("id")->place, "duplicate claim id '", study.claims[i].id, "'");
    }
  }
  if (const Value* report = table.find("report")) parse_report(report->as_table("report"), keep, study);
  return study;
}

}  // namespace gust
