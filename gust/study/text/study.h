#pragma once

#include <optional>
#include <set>

#include "gust/eval/evaluate.h"
#include "gust/eval/metric.h"
#include "gust/stats/claim.h"
#include "gust/study/policies/policy_source.h"

namespace gust {

/// A policy of a study, which may be several: one a training seed or a file.
struct StudyPolicy {
  std::string name;
  std::string kind;
  Place place;
  std::shared_ptr<const PolicySource> source;  ///< shared because it never changes
  std::vector<std::string> members;            ///< its source's

  /// How many policies share the name: training seeds or files, else one.
  std::size_t count() const { return members.size(); }
  /// Which of them it is: the training seed or the file; empty for a policy that stands alone.
  const std::string& member(std::size_t index) const { return members[index]; }
  /// What has to be trained first; null if nothing has to be.
  const PolicyTraining* training() const { return source->training(); }
};

/// Something that grows along an axis while everything else stays: the level of a disturbance, or plant parameters.
struct Sweep {
  struct Axis {
    std::string parameter;       ///< empty: the level of the injection
    std::size_t index = 0;       ///< of the parameter in the plant's spec
    std::vector<double> values;  ///< ascending; absolute for parameters

    std::string name() const { return parameter.empty() ? "level" : parameter; }
  };

  std::string name;
  Place place;
  std::optional<Injection> injection;
  bool automatic = false;                                  ///< the levels are found by bisection first
  std::vector<Axis> axes;                                  ///< one, or two for a grid (the first varies slowest)
  std::vector<Injection> disturbed;                        ///< on in all cells, beside what the study has on
  std::vector<std::pair<std::size_t, double>> parameters;  ///< of the plant, by index: other values in all cells

  std::size_t cells() const;
  /// The values of the axes in a cell; the last axis runs fastest.
  std::vector<double> at(std::size_t cell) const;
  /// Of an axis: the parameter's, or what the disturbed channels are measured in: "N", "rad", "m, rad" of several.
  std::string unit(const Interface& spec, std::size_t axis = 0) const;
  /// What is different in all cells, with all that makes it so: "pole_mass = 0.15, dynamics step(offset = 2) on fx in
  /// steps 25:50 at 0.2"; empty if nothing is.
  std::string setting(const Interface& spec) const;
  /// Whether its one axis is the level of a disturbance.
  bool along_levels() const { return injection.has_value() && axes.size() == 1; }
};

/// "fx fz=0.5": the channels that are disturbed, with factors that are not 1.
std::string channels_text(const Injection& injection, const Interface& spec);

/// A statement about the outcome, decided with an interval: a bound for one metric in one place, or a formula.
struct StudyClaim {
  std::string id;
  std::string text;
  std::string holds;               ///< "survival >= 0.95", or the formula's text
  std::optional<Formula> formula;  ///< if it says no `where`
  std::string metric;              ///< of the formula's score()
  std::string policy;
  std::string sweep;       ///< empty: undisturbed
  std::vector<double> at;  ///< level, or one value per axis
  std::string start;
  bool required = true;
  Place place;
};

/// Which episodes of a sweep are kept whole, for the replay.
struct TraceRule {
  std::int64_t worst = 0;
  std::int64_t median = 0;
};

/// Somebody else's learning curve, to be drawn beside those of a policy.
struct ReferenceCurve {
  std::string policy;
  std::string source;  ///< whose it is
  std::vector<double> steps;
  std::vector<double> score;
};

/// A study as it was written, every default filled in.
struct Study {
  std::string text;  ///< the bytes of the file
  std::string name;
  std::string question;
  std::int64_t seed = 1;
  Setup setup;
  std::int64_t episodes = 25;
  std::vector<StartProtocol> starts;
  bool terminate = true;
  double margin_tolerance = 0.02;    ///< of a margin: how far apart levels around it may be; 0 asks for no more levels
  std::vector<std::size_t> metrics;  ///< what the page leads with, by index
  std::vector<Injection> always;     ///< on in every evaluation
  std::vector<StudyPolicy> policies;
  std::vector<Sweep> sweeps;
  FormulaNames names;  ///< for formulas
  std::vector<StudyClaim> claims;
  TraceRule traces;
  std::vector<ReferenceCurve> reference_curves;
  MetricSet metric_set;
  std::vector<std::vector<StudyFile>> found;  ///< every file that was read, by pattern, in the order of asking
};

/// The starts of a study by index, in the order in which results are told: the one that is named, then random ones.
std::vector<std::size_t> starts_to_tell(const Study& study, std::string_view first = {});

/// What margins are of, and score() in claims: the first leading metric that is better when higher, but not survival,
/// which has no slope.
std::size_t margin_metric(const Study& study);

/// Reads a study. `settings` are key=value pairs that replace what the text says, the last one first
/// ("evaluate.episodes=5", "policy.ppo.seeds=[1,2]"). Throws Error with the place and what would be right.
Study parse_study(std::string_view bytes, std::string_view name, const std::vector<std::string>& settings,
                  const FindFiles& find);

}  // namespace gust
