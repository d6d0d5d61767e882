#pragma once

#include "gust/store/rows.h"
#include "gust/store/store.h"
#include "gust/study/plan/plan.h"
#include "gust/study/trials/executor.h"

namespace gust {

// Files of a trial in the store; their formats are in docs/formats.md.
inline constexpr std::string_view kPolicyFile = "policy.onnx";
/// "adversary-1.onnx", …: what the policy was trained against, if anything.
inline std::string adversary_file(std::size_t number) { return cat("adversary-", number, ".onnx"); }
inline constexpr std::string_view kCurveFile = "curve.csv";
inline constexpr std::string_view kFailureFile = "failure.txt";  ///< why a training ended without a policy
inline constexpr std::string_view kRowsFile = "rows.bin";
inline constexpr std::string_view kTracesFile = "traces.json";
inline constexpr std::string_view kNotFiniteFile = "not_finite.txt";  ///< the first action that was NaN or infinite
inline constexpr std::string_view kLevelFile = "level.txt";           ///< failure level that a search found

/// Runs one trial and puts its outcome into the store; what is there already is only looked at. Trainings go on from
/// their checkpoint. Throws or returns a failure with its reason; returns `stopped` soon after the token fires.
Outcome run_trial(const Study& study, const Plan& plan, std::size_t index, const Store& store, std::stop_token stop,
                  ProgressSink& progress);

/// What the rows of an evaluation of so many cells are.
RowsHeader rows_header(const Study& study, std::uint64_t cells);

/// What an evaluation trial measures. The study must outlive it.
struct TrialEvaluation {
  std::vector<Injection> injections;  ///< the study's own, then the swept one
  Evaluation evaluation;              ///< refers to `injections`
};
std::unique_ptr<TrialEvaluation> trial_evaluation(const Study& study, const Trial& trial);

/// All metrics of an episode as the study measures them, in the order of its metric set.
void measure(const Study& study, Episode episode, std::span<double> metrics);

/// The policy of a trial; a trained one is read from the store. Throws Error if it is not there.
std::unique_ptr<Policy> trial_policy(const Study& study, const Plan& plan, const Trial& trial, const Store& store);

/// Why the training of this trial's policy, or the trial itself if it is one, ended without a policy; none while it may
/// still get one.
std::optional<std::string> training_failure(const Plan& plan, const Trial& trial, const Store& store);

/// The failure level of a finished search; infinite if nothing failed up to the limit, none if it is not finished.
std::optional<double> found_level(const Plan& plan, const Trial& trial, const Store& store);
/// The same from its files; an Error if it is not one number that is not negative.
double read_level(const StoredTrial& stored);

/// The number that a whole text is; an Error, which begins with the name, if it is none.
double number_from_text(std::string_view text, std::string_view name);

/// Learning curves as the store keeps them.
std::string curve_text(const std::vector<CurvePoint>& curve);
std::vector<CurvePoint> read_curve(std::string_view text, std::string_view name);

/// Kept episodes as the store keeps them.
std::string traces_text(const std::vector<Trace>& traces);
std::vector<Trace> read_traces(std::string_view text, std::string_view name);

}  // namespace gust
