#include <map>

#include "gust/onnx/onnx.h"
#include "gust/study/policies/policy_fixture_test.h"
#include "gust/study/text/study_fixture.h"

// What every kind of policy has to keep, whoever adds it.

using namespace gust;
using namespace gust::test;

namespace {

/// A network that fits the plant.
std::string network_for(std::size_t inputs, std::size_t outputs) {
  Mlp<float> network({{inputs, 3, outputs}});
  Rng rng(5);
  std::uint64_t i = 0;
  for (float& weight : network.parameters()) weight = static_cast<float>(rng.uniform(i++)) - 0.5f;
  return write_onnx({std::move(network)}, {});
}

/// The study of a kind's example, and the policy that it gives; of the first plant that has such policies.
struct Example {
  Study study;
  PolicyMember member;

  const Setup& setup() const { return study.setup; }
  const PolicySource& source() const { return *study.policies.front().source; }
};

Example example_of(const PolicyKind& kind) {
  std::string refused;
  for (const std::string& plant : plants().names()) {
    const std::string own = cat("plant = { kind = \"", plant, "\" }\n");
    const bool said = kind.example.find("plant = ") != std::string::npos;
    const std::string text = cat("schema = 1\nname = \"example\"\n", said ? "" : own, kind.example, "\n");
    const Setup setup = make_setup(parse_toml(cat("kind = \"", plant, "\""), "plant"));
    const Interface& spec = setup.plant->spec();
    const std::string bytes = network_for(spec.observations(), spec.action.size());
    const FindFiles find = [&](const std::string& pattern, const Place&) {
      return std::vector<StudyFile>{{pattern, bytes}};
    };
    try {
      Example example{parse_study(text, "example.toml", {}, find), {}};
      if (kind.trained) example.member = {0, "training", bytes};
      return example;
    } catch (const Error& error) {  // it is of another plant
      refused += cat(error.what(), "\n");
    }
  }
  FAIL("the example of " << kind.name << " is no study: " << refused);
  throw Bug("unreachable");
}

/// The actions of some control steps, of which the first begin an episode.
std::vector<double> run(Policy& policy, const Interface& spec, std::size_t lanes, std::size_t lane) {
  std::vector<double> actions;
  Matrix<double> action(policy.actions(), lanes);
  for (std::int64_t k = 0; k < 5; ++k) {
    Matrix<double> seen = some_observations(spec, lanes);
    for (std::size_t i = 0; i < seen.rows(); ++i) {
      for (std::size_t l = 0; l < lanes; ++l) {
        const std::uint64_t stream = l == lane ? 1 : 2 + l;  // the lane that is looked at meets the same in any batch
        seen.at(i, l) = Rng(stream).split(static_cast<std::uint64_t>(k)).uniform(i) - 0.5;
      }
    }
    policy.act(seen.view(), std::vector<std::int64_t>(lanes, k), action.view());
    for (std::size_t i = 0; i < action.rows(); ++i) actions.push_back(action.at(i, lane));
  }
  return actions;
}

}  // namespace

TEST_CASE("every kind of policy says what it is, with an example that is a study") {
  for (const PolicyKind& kind : policy_kinds()) {
    CAPTURE(kind.name);
    CHECK_FALSE(kind.summary.empty());
    CHECK_FALSE(kind.source.empty());
    CHECK(kind.example.find(kind.name) != std::string::npos);
    for (const FieldInfo& field : kind.fields) {
      CAPTURE(field.name);
      CHECK_FALSE(field.help.empty());
      CHECK_FALSE(field.standard.empty());
      CHECK_FALSE(field.type.empty());
    }
    const Example example = example_of(kind);
    CHECK(example.study.policies.front().kind == kind.name);
    CHECK(kind.trained == (example.source().training() != nullptr));
    CHECK(example.source().members().size() >= 1);
    const std::string unknown =
        cat("schema = 1\nname = \"x\"\nplant = { kind = \"cartpole\" }\n[[policy]]\nname = \"p\"\nkind = \"", kind.name,
            "\"\nno_such_key = 1\n");
    CHECK_THROWS_WITH_AS(parse_study(unknown, "x.toml", {}, no_files),
                         doctest::Contains("x.toml:7:15: unknown key 'no_such_key'"), Error);
  }
}

TEST_CASE("every kind of policy has one text for one policy, and texts of different kinds differ") {
  std::map<std::string, std::string> kinds;
  for (const PolicyKind& kind : policy_kinds()) {
    CAPTURE(kind.name);
    const Example one = example_of(kind), other = example_of(kind);
    const std::string text = one.source().canonical(one.member);

    CHECK(text == other.source().canonical(other.member));
    CHECK(text.ends_with("\n"));
    CHECK(text.starts_with(kind.trained ? one.member.training : kind.name));
    CHECK(kinds.emplace(text, kind.name).second);
  }
}

TEST_CASE("every kind of policy gives equal bits again, keeps its lanes apart, and begins anew with an episode") {
  for (const PolicyKind& kind : policy_kinds()) {
    CAPTURE(kind.name);
    const Example example = example_of(kind);
    const Interface& spec = example.setup().plant->spec();
    const auto policy = example.source().make(example.setup(), example.member);
    REQUIRE(policy->observations() == spec.observations());
    REQUIRE(policy->actions() == spec.action.size());

    const std::vector<double> once = run(*policy, spec, 1, 0);

    CHECK(run(*policy, spec, 1, 0) == once);  // what the first episode left is gone
    CHECK(run(*example.source().make(example.setup(), example.member), spec, 5, 3) == once);
    CHECK(policy->remembered().rows == policy->memory().size());
    for (const Component& component : policy->memory()) {
      CHECK_FALSE(component.name.empty());
      CHECK_FALSE(component.unit.empty());
    }
    for (const double value : once) CHECK(std::isfinite(value));
  }
}
