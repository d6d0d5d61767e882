#include <algorithm>

#include "gust/study/text/agent_options.h"
#include "gust/study/text/parse.h"
#include "gust/study/trials/policies.h"

namespace gust {
namespace {

using Kind = StudyPolicy::Kind;

Kind kind_from(const Table& table) {
  const std::string& name = required_text(table, "kind", "a policy");
  const std::vector<std::string> names = {"lqr", "pd", "zero", "onnx", "train"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) return static_cast<Kind>(i);
  }
  throw error_at(table.find("kind")->place, "unknown policy kind '", name, "'", did_you_mean(name, names),
                 "; kinds are ", join(names, ", "));
}

std::vector<double> weights(const Table& table, const char* key, const std::vector<double>& standard,
                            const Range& range) {
  std::vector<double> values = standard;
  const Value* value = table.find(key);
  if (value == nullptr) return values;
  read_value(values, *value, key, range);
  if (values.size() != standard.size()) {
    throw error_at(value->place, "'", key, "' must have ", standard.size(), " numbers, got ", values.size());
  }
  return values;
}

void parse_lqr(const Table& table, const Study& study, StudyPolicy& policy) {
  check_keys(table, {"name", "kind", "q", "r"}, "an lqr policy");
  const Plant& plant = study.setup.equations("lqr", table.find("kind")->place);
  const LqrWeights standard = reward_weights(plant.spec());
  policy.weights = {weights(table, "q", standard.q, non_negative), weights(table, "r", standard.r, positive)};
  try {
    lqr_gain(plant, policy.weights);
  } catch (const Error& error) {
    throw error_at(table.place, error.what());
  }
}

/// The risk level at which a policy acts, if the study says one.
std::optional<double> parse_level(const Table& table) {
  const Value* value = table.find("alpha");
  if (value == nullptr) return std::nullopt;
  double level = 0;
  read_value(level, *value, "alpha", Range{.low = 0, .high = 1, .low_open = true});
  return level;
}

/// Checks that the trained policy can act at the level that is asked for.
void check_level(const StudyPolicy& policy, const Table& table) {
  if (!policy.alpha) return;
  const Place& place = table.find("alpha")->place;
  const std::optional<LevelRange> levels = policy.agent->levels();
  if (!levels)
    throw error_at(place, "'alpha' is for agents whose policy takes a risk level, such as wcpg; ", policy.agent.kind,
                   " does not");
  if (*policy.alpha < levels->low || *policy.alpha > levels->high)
    throw error_at(place, "'alpha' must be a level that the agent trains, ", levels->low, " to ", levels->high,
                   ", got ", *policy.alpha);
}

/// Files of one content are one policy, not several seeds: the first of them stays.
void leave_out_copies(StudyPolicy& policy) {
  std::vector<StudyPolicy::File> kept;
  for (StudyPolicy::File& file : policy.files) {
    const auto same = std::ranges::find_if(
        kept, [&](const StudyPolicy::File& other) { return other.bytes == file.bytes && other.data == file.data; });
    if (same == kept.end())
      kept.push_back(std::move(file));
    else
      policy.copies.emplace_back(file.path, same->path);
  }
  policy.files = std::move(kept);
}

void parse_onnx(const Table& table, const Study& study, const FindFiles& find, StudyPolicy& policy) {
  check_keys(table, {"name", "kind", "file", "alpha", "output", "observe", "act", "units"}, "an onnx policy");
  policy.alpha = parse_level(table);
  if (const Value* output = table.find("output")) policy.output = output->as_text("output");
  policy.interface = read_interface(table, study.setup.plant->spec());
  const std::string& pattern = required_text(table, "file", "an onnx policy");
  const Place& place = table.find("file")->place;
  policy.files = find(pattern, place);
  if (policy.files.empty()) throw error_at(place, "no file matches '", pattern, "'");
  leave_out_copies(policy);
  for (const StudyPolicy::File& file : policy.files) {
    const PolicyUse use{
        .alpha = policy.alpha, .output = policy.output, .data = &file.data, .interface = policy.interface};
    const FilePolicy read = file_policy(file.bytes, file.path, study.setup, use);
    policy.foreign = policy.foreign || read.foreign;
    if (policy.unit_warning.empty()) policy.unit_warning = read.unit_warning;
  }
}

std::vector<std::int64_t> parse_seeds(const Value& value) {
  std::vector<std::int64_t> seeds;
  if (!std::holds_alternative<Value::List>(value.data)) {
    seeds.push_back(value.as_int("seeds"));
  } else {
    for (const Value& seed : value.as_list("seeds")) seeds.push_back(seed.as_int("seeds"));
  }
  if (seeds.empty()) throw error_at(value.place, "'seeds' must name at least one seed, such as [1, 2, 3]");
  if (seeds.size() > kMostSeeds) throw error_at(value.place, "at most ", kMostSeeds, " seeds, got ", seeds.size());
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    if (seeds[i] < 0) throw error_at(value.place, "'seeds' must be >= 0, got ", seeds[i]);
    for (std::size_t j = 0; j < i; ++j) {
      if (seeds[i] == seeds[j]) throw error_at(value.place, "duplicate seed ", seeds[i]);
    }
  }
  return seeds;
}

void parse_train(const Table& table, const Study& study, StudyPolicy& policy) {
  check_keys(table, {"name", "kind", "agent", "seeds", "alpha"}, "a policy to train");
  const Plant& plant = study.setup.equations("a training", table.find("kind")->place);
  const Value* agent = table.find("agent");
  if (agent == nullptr)
    throw error_at(table.place, "a policy to train needs an 'agent', such as agent = { kind = \"ppo\" }");
  Table options = agent->as_table("agent");
  if (const Value* disturb = options.find("disturb")) {
    policy.disturbed = parse_disturb(*disturb, study.setup.plant->spec());
    options.erase("disturb");
  }
  if (const Value* randomise = options.find("randomise")) {
    policy.randomised = parse_randomise(*randomise, study.setup);
    options.erase("randomise");
  }
  if (const Value* curve = options.find("curve")) {
    policy.curve_as_trained = parse_curve(*curve);
    options.erase("curve");
  }
  if (const Value* kind = options.find("kind")) agents().at(kind->as_text("kind"), kind->place);
  policy.agent = make_agent(options, study.setup);
  policy.agent->check(plant.spec(), agent->place);
  policy.alpha = parse_level(table);
  check_level(policy, table);
  policy.seeds = {1};
  if (const Value* seeds = table.find("seeds")) policy.seeds = parse_seeds(*seeds);
}

}  // namespace

StudyPolicy parse_policy(const Table& table, const Study& study, const FindFiles& find) {
  StudyPolicy policy;
  policy.name = checked_name(table, "name", "a policy");
  policy.kind = kind_from(table);
  policy.place = table.place;
  switch (policy.kind) {
    case Kind::kLqr:
      parse_lqr(table, study, policy);
      break;
    case Kind::kPd:
      check_keys(table, {"name", "kind"}, "a pd policy");
      pd_policy(study.setup, table.place);
      break;
    case Kind::kZero:
      check_keys(table, {"name", "kind"}, "a zero policy");
      break;
    case Kind::kOnnx:
      parse_onnx(table, study, find, policy);
      break;
    case Kind::kTrain:
      parse_train(table, study, policy);
      break;
  }
  return policy;
}

}  // namespace gust
