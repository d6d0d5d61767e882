#include "gust/cli/eval.h"
#include "gust/cli/study_command.h"
#include "gust/study/text/parse.h"
#include "gust/study/trials/trials.h"

namespace gust {
namespace {

/// The sweep that was named, reduced to the one cell that is asked for; kNominal if none was named.
std::size_t prepare_sweep(const EvalRequest& request, Study& study) {
  if (request.sweep.empty()) {
    if (!request.level.empty()) throw Error("--level: needs its --sweep beside it; without one nothing is disturbed");
    return Trial::kNominal;
  }
  const Sweep& found = named(study.sweeps, {request.sweep, {"--sweep"}}, "sweep");
  const auto index = static_cast<std::size_t>(&found - study.sweeps.data());
  Sweep& sweep = study.sweeps[index];
  if (request.level.empty()) throw Error(cat("--sweep: '", sweep.name, "' needs the --level to measure"));
  const std::vector<double> level = value_from_text(request.level, {"--level"}).as_numbers("level");
  if (level.size() != sweep.axes.size()) {
    throw Error(cat("--level: sweep '", sweep.name, "' has ", sweep.axes.size(), " axes, got ", level.size()));
  }
  for (std::size_t i = 0; i < level.size(); ++i) {
    Sweep::Axis& axis = sweep.axes[i];
    if (!axis.parameter.empty() && !(level[i] > 0)) {
      throw Error(cat("--level: '", axis.parameter, "' must be > 0, got ", level[i]));
    }
    if (axis.parameter.empty()) {
      const std::string complaint = level_complaint(*sweep.injection, level[i]);
      if (!complaint.empty()) throw Error(cat("--level: ", complaint));
    }
    axis.values = {level[i]};
  }
  return index;
}

/// Adds the rows of one policy; the study has this cell only.
void add_rows(const OpenStudy& open, const Trial& trial, std::vector<EvalRow>& rows) {
  const Study& study = open.study;
  const std::unique_ptr<Policy> policy = trial_policy(study, open.plan, trial, open.trials("eval"));
  const std::unique_ptr<TrialEvaluation> task = trial_evaluation(study, trial);
  evaluate(task->evaluation, *policy, [&](const EpisodeIndex& index, const Episode& episode) {
    EvalRow& row = rows.emplace_back(eval_row(task->evaluation, index, episode, study.terminate));
    row.seed = study.policies[trial.policy].member(trial.member);
    row.metrics.resize(study.metric_set.size());
    measure(study, episode, row.metrics);
    row.applies = study.metric_set.applying(task->evaluation.source->spec());
  });
}

}  // namespace

EvalResult run_cell(const EvalRequest& request) {
  OpenStudy open(request.study);
  open.trials("eval");
  Study& study = open.study;
  const StudyPolicy& policy = named(study.policies, {request.policy, {"POLICY"}}, "policy");
  const std::size_t sweep = prepare_sweep(request, study);
  const std::string start = request.start.empty() ? study.starts.front().name : request.start;
  study.starts = {named(study.starts, {start, {"--start"}}, "start")};
  study.episodes = checked_episodes(request, study.episodes);
  EvalResult result{.metrics = study.metric_set, .two_efforts = study.setup.plant->plant() != nullptr};
  for (Trial trial : open.plan.trials) {
    const bool nominal = trial.kind == Trial::Kind::kEvaluate && trial.sweep == Trial::kNominal;
    if (!nominal || &study.policies[trial.policy] != &policy) continue;
    trial.sweep = sweep;
    add_rows(open, trial, result.rows);
  }
  return result;
}

}  // namespace gust
