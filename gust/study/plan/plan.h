#pragma once

#include <map>
#include <set>

#include "gust/study/text/study.h"

namespace gust {

/// One unit of work: a training, the search of a failure level, one sweep of one policy's seed, or the levels around
/// the margins of one policy along one sweep. Its outcome is a pure function of its canonical text, whose hash is its
/// name.
struct Trial {
  enum class Kind { kTrain, kSearch, kEvaluate, kMargin };
  static constexpr std::size_t kNominal = static_cast<std::size_t>(-1);

  Kind kind = Kind::kEvaluate;
  std::string id = {};         ///< slug and hash
  std::string what = {};       ///< for people: "ppo seed 2 · action step"
  std::string canonical = {};  ///< all that makes its outcome
  std::size_t policy = 0;
  std::size_t member = 0;                ///< which seed or file of the policy; of a margin, the first
  std::size_t sweep = kNominal;          ///< kNominal: undisturbed
  std::vector<std::size_t> inputs = {};  ///< of an evaluation its training; of a margin its evaluations
  std::size_t cells = 0;                 ///< of an evaluation
  double seconds = 0;                    ///< predicted, on one core
  double guess = 0;                      ///< the same without having measured anything
};

/// "train", "search", "evaluate", "margin": also the folders of the store.
std::string_view kind_name(Trial::Kind kind);

/// Levels that were found for automatic sweeps, by sweep.
using FoundLevels = std::map<std::size_t, std::vector<double>>;

/// All trials in their fixed order: trainings, searches, evaluations by policy, member and sweep, then margins by
/// policy and sweep. Evaluations of automatic sweeps are there once their levels are.
struct Plan {
  std::vector<Trial> trials;
  bool complete = true;                    ///< false while automatic sweeps wait for their levels
  std::vector<StartProtocol> starts = {};  ///< of every evaluation and margin
  std::uint64_t episodes = 0;              ///< from each start
};

/// `failed` are the ids of trainings that ended without a policy: margins are those of the other seeds.
Plan expand(const Study& study, const FoundLevels& found, const std::set<std::string>& failed = {});

/// Whether a sweep of this study has margins that are refined.
bool refines_margin(const Study& study, const Sweep& sweep);

/// A study whose automatic sweeps have the levels that were found.
void set_levels(Study& study, const FoundLevels& found);

/// The common grid of an automatic sweep from the failure levels of all policies (infinite where nothing failed, 0 for
/// one that falls undisturbed and says nothing): eleven levels from 0 to one and a half times the greatest, closer
/// together around it (decision 6).
std::vector<double> common_levels(const std::vector<double>& failure_levels, double limit);

/// Beyond this level of a disturbance the search for a failure ends.
double search_limit(const Injection& injection, const Interface& spec);

}  // namespace gust
