#include "gust/study/policies/file_policy.h"
#include "gust/study/policies/policy_entry.h"
#include "gust/study/text/agent_options.h"
#include "gust/study/text/parse.h"

namespace gust {
namespace {

std::vector<std::int64_t> read_seeds(const Value& value) {
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

struct Train final : PolicySource {
  Written agent{"required", "table"};
  Written seeds{"1", "list of whole numbers"};
  Written alpha{"the agent's", "number"};

  static constexpr bool kTrained = true;
  static constexpr std::tuple kFields = {
      field("agent", &Train::agent,
            "its kind, its profile (a preset, or one of its own such as modern) and any option of it (gust list "
            "agents); disturb: disturbances that are on during training; randomise: parameters of the plant that are "
            "sampled for every episode of the training"),
      field("seeds", &Train::seeds, "one training and one policy a seed", non_negative),
      field("alpha", &Train::alpha, "the risk level to act at, of an agent whose policy takes one", kLevels),
  };

  void prepare(const PolicyContext& context) override {
    const Plant& plant = context.equations("a training");
    if (!agent) throw error_at(context.place, "a policy to train needs an 'agent', such as agent = { kind = \"ppo\" }");
    read_agent(context);
    training_.agent->check(plant.spec(), agent->place);
    if (alpha) read_level();
    training_.seeds = {1};
    if (seeds) training_.seeds = read_seeds(*seeds);
  }

  std::string canonical(const PolicyMember& member) const override {
    return cat(member.training, "\n", level_text(level_));
  }

  std::vector<std::string> members() const override {
    std::vector<std::string> names;
    for (const std::int64_t seed : training_.seeds) names.push_back(cat(seed));
    return names;
  }

  const PolicyTraining* training() const override { return &training_; }

  std::unique_ptr<Policy> make(const Setup& setup, const PolicyMember& member) const override {
    return onnx_policy(member.network, member.training, setup, {.alpha = level_});
  }

 private:
  void read_agent(const PolicyContext& context) {
    Table options = agent->as_table("agent");
    if (const Value* disturb = options.find("disturb")) {
      training_.disturbed = parse_disturb(*disturb, context.spec());
      options.erase("disturb");
    }
    if (const Value* randomise = options.find("randomise")) {
      training_.randomised = parse_randomise(*randomise, context.setup);
      options.erase("randomise");
    }
    if (const Value* curve = options.find("curve")) {
      training_.curve_as_trained = parse_curve(*curve);
      options.erase("curve");
    }
    if (const Value* kind = options.find("kind")) agents().at(kind->as_text("kind"), kind->place);
    training_.agent = make_agent(options, context.setup);
  }

  /// The trained policy must be able to act at the level that is asked for.
  void read_level() {
    read_value(level_.emplace(), *alpha, "alpha", alpha.range);
    const std::optional<LevelRange> levels = training_.agent->levels();
    if (!levels)
      throw error_at(alpha->place, "'alpha' is for agents whose policy takes a risk level, such as wcpg; ",
                     training_.agent.kind, " does not");
    if (*level_ < levels->low || *level_ > levels->high)
      throw error_at(alpha->place, "'alpha' must be a level that the agent trains, ", levels->low, " to ", levels->high,
                     ", got ", *level_);
  }

  PolicyTraining training_;
  std::optional<double> level_;
};

}  // namespace

PolicyKind policy_train() {
  return policy_entry<Train>({"train", "The policies that an agent learns, one a seed: trained first, then measured.",
                              "docs/agents.md",
                              "[[policy]]\nname  = \"ppo\"\nkind  = \"train\"\nagent = { kind = \"ppo\", steps = "
                              "100_000 }\nseeds = [1, 2, 3]"});
}

}  // namespace gust
