#pragma once

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "gust/setup/toml.h"
#include "gust/study/policies/policy_source.h"

namespace gust::test {

/// A plant by itself under the standard preset, with options in TOML: "kind = \"cartpole\"".
inline Setup setup_of(const std::string& plant) { return make_setup(parse_toml(plant, "plant.toml")); }

/// Finds files among these, by their path.
inline FindFiles among(std::vector<StudyFile> files) {
  return [files = std::move(files)](const std::string& pattern, const Place&) {
    std::vector<StudyFile> found;
    for (const StudyFile& file : files) {
      if (file.path == pattern) found.push_back(file);
    }
    return found;
  };
}

/// The source of a [[policy]] without its name: "kind = \"gain\"\nk = [[1, 2, 3, 4]]".
inline std::shared_ptr<const PolicySource> source_of(const std::string& policy, const Setup& setup,
                                                     const std::vector<StudyFile>& files = {}) {
  const Table table = parse_toml(policy, "study.toml");
  const PolicyKind& kind = policy_kind(table.find("kind")->as_text("kind"), table.find("kind")->place);
  return kind.read(table, {setup, among(files), table.place});
}

/// What the user is told of a [[policy]]; empty if nothing is wrong.
inline std::string complaint_about(const std::string& policy, const Setup& setup,
                                   const std::vector<StudyFile>& files = {}) {
  try {
    source_of(policy, setup, files);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

/// The actions of a fresh policy in some lanes before their first steps; `seen` is observations x lanes.
inline Matrix<double> first_actions(const PolicySource& source, const Setup& setup, const Matrix<double>& seen) {
  const std::vector<std::int64_t> steps(seen.lanes(), 0);
  const std::unique_ptr<Policy> policy = source.make(setup, {});
  Matrix<double> actions(policy->actions(), seen.lanes());
  policy->act(seen.view(), steps, actions.view());
  return actions;
}

/// Numbers that look like observations: of every row and lane other ones.
inline Matrix<double> some_observations(const Interface& spec, std::size_t lanes) {
  Matrix<double> seen(spec.observations(), lanes);
  for (std::size_t i = 0; i < seen.rows(); ++i) {
    for (std::size_t lane = 0; lane < lanes; ++lane) seen.at(i, lane) = Rng(9).split(i).split(lane).uniform(0) - 0.5;
  }
  return seen;
}

}  // namespace gust::test
