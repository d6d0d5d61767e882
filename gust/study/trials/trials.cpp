#include "gust/study/trials/trials.h"

#include <algorithm>
#include <cmath>

#include "gust/core/version.h"
#include "gust/onnx/onnx.h"
#include "gust/study/trials/cell_collector.h"
#include "gust/study/trials/margin_trial.h"
#include "gust/study/trials/trace_choice.h"
#include "gust/study/trials/training_driver.h"
#include "gust/study/trials/trial_check.h"

namespace gust {
namespace {

Outcome failure(std::string reason) { return {Outcome::State::failed, std::move(reason)}; }

/// Every adversary that the policy was trained against, with where it acts and how far it reaches.
void write_adversaries(TrialWriter& writer, const Training& training, std::map<std::string, std::string> metadata) {
  std::size_t number = 0;
  for (const TrainedAdversary& adversary : training.adversaries()) {
    metadata["gust.units"] = "adversary";  // its action is no policy's
    metadata["gust.site"] = site_name(adversary.against.site);
    metadata["gust.scale"] = cat(adversary.against.scale);
    metadata["gust.offset"] = cat(adversary.against.offset);
    writer.write(adversary_file(++number), write_onnx(adversary.actor, metadata));
  }
}

Outcome run_train(const Study& study, const Trial& trial, const Store& store, std::stop_token stop,
                  ProgressSink& progress) {
  const StudyPolicy& policy = study.policies[trial.policy];
  const PolicyTraining& asked = *policy.training();
  const TrainingTask task{&study.setup.equations("a training", policy.place),
                          study.setup.readings,
                          asked.disturbed,
                          asked.seeds[trial.member],
                          asked.randomised.draws,
                          asked.curve_as_trained};
  const std::unique_ptr<CheckpointPlace> place = checkpoint_in(store, trial.id);
  const std::unique_ptr<Training> training = begin_training(*asked.agent, task, *place);
  const auto tell_share = [&](double share) { progress.set(share); };
  const auto warn = [&](const std::string& warning) { store.tell(warning); };
  if (!train_to_end(*training, *place, stop, tell_share, warn)) return {Outcome::State::stopped, ""};

  TrialWriter writer = store.begin(kind_name(trial.kind), trial.id);
  writer.write(kCurveFile, curve_text(training->curve()));
  if (training->failure().empty()) {
    const std::map<std::string, std::string> metadata = {{"gust.plant", study.setup.plant.kind},
                                                         {"gust.preset", study.setup.preset},
                                                         {"gust.units", study.setup.plant->spec().action_unit()},
                                                         {"gust.seed", cat(asked.seeds[trial.member])},
                                                         {"gust.version", std::string(kVersion)},
                                                         {"gust.trial", trial.id}};
    writer.write(kPolicyFile, write_onnx(training->actor(), metadata));
    write_adversaries(writer, *training, metadata);
  } else {
    writer.write(kFailureFile, training->failure());
  }
  writer.commit(trial.canonical);
  return training->failure().empty() ? Outcome{} : failure(training->failure());
}

struct Stopped {};  // leaves an evaluation between two episodes

Outcome run_evaluate(const Study& study, const Plan& plan, const Trial& trial, const Store& store, std::stop_token stop,
                     ProgressSink& progress) {
  const std::unique_ptr<Policy> policy = trial_policy(study, plan, trial, store);
  const std::unique_ptr<TrialEvaluation> task = trial_evaluation(study, trial);
  const Evaluation& evaluation = task->evaluation;
  TrialWriter writer = store.begin(kind_name(trial.kind), trial.id);
  OutputFile& file = writer.file(kRowsFile);
  RowsWriter rows(rows_header(study, evaluation.cells.size()), [&](std::string_view bytes) { file.append(bytes); });
  CellCollector collector(study, evaluation, rows);
  TraceChoice choice(study.traces, study.metric_set[study.metrics.front()].traits().higher_is_better);
  std::optional<NotFiniteAction> not_finite;
  try {
    evaluate(evaluation, *policy, [&](const EpisodeIndex& index, const Episode& episode) {
      if (!not_finite) not_finite = not_finite_action(evaluation, index, episode);
      if (stop.stop_requested()) throw Stopped{};
      collector.take(index, episode);
      choice.offer(index, collector.last(study.metrics.front()));
      progress.set(static_cast<double>(index.cell) / static_cast<double>(evaluation.cells.size()));
    });
  } catch (const Stopped&) {
    return {Outcome::State::stopped, ""};
  }
  rows.finish();
  std::vector<Trace> traces;
  for (const EpisodeIndex& index : choice.chosen()) traces.push_back(trace_episode(evaluation, *policy, index));
  writer.write(kTracesFile, traces_text(traces));
  if (not_finite) writer.write(kNotFiniteFile, not_finite_text(*not_finite, study.setup.plant->spec()));
  writer.commit(trial.canonical);
  return {};
}

/// What all cells of a trial have in common: levels as declared, parameters as the sweep sets them.
SweepCell plain_cell(const Study& study, const Trial& trial, std::span<const Injection> injections) {
  SweepCell cell{{}, nominal_parameters(study.setup.plant->spec())};
  for (const Injection& injection : injections) cell.levels.push_back(injection.level);
  if (trial.sweep == Trial::kNominal) return cell;
  for (const auto& [index, value] : study.sweeps[trial.sweep].parameters) cell.parameters[index] = value;
  return cell;
}

/// Whether the policy fails at a level, from the nominal start.
bool fails_at(const Evaluation& evaluation, Policy& policy, double level) {
  Evaluation one = evaluation;
  one.cells.resize(1);
  one.cells.front().levels.back() = level;
  bool failed = false;
  evaluate(one, policy, [&](const EpisodeIndex&, const Episode& episode) { failed = failed || episode.failed; });
  return failed;
}

/// The smallest level that fails, within five percent, by doubling and then bisection; 0 if it fails undisturbed.
double search_level(const Evaluation& evaluation, Policy& policy, double limit) {
  if (fails_at(evaluation, policy, 0.0)) return 0.0;
  constexpr double kFirst = 1e-3;
  constexpr double kWithin = 1.05;
  double high = kFirst;
  while (high < limit && !fails_at(evaluation, policy, high)) high *= 2;
  if (high >= limit && !fails_at(evaluation, policy, limit)) return std::numeric_limits<double>::infinity();
  high = std::min(high, limit);
  double low = high / 2;
  while (high / low > kWithin) {
    const double middle = 0.5 * (low + high);
    (fails_at(evaluation, policy, middle) ? high : low) = middle;
  }
  return high;
}

Outcome run_search(const Study& study, const Plan& plan, const Trial& trial, const Store& store) {
  const std::unique_ptr<Policy> policy = trial_policy(study, plan, trial, store);
  const std::unique_ptr<TrialEvaluation> task = trial_evaluation(study, trial);
  task->evaluation.starts = {study.setup.plant->starts().front()};
  task->evaluation.episodes = 1;
  task->evaluation.cells = {plain_cell(study, trial, task->injections)};
  const double limit = search_limit(task->injections.back(), study.setup.plant->spec());
  const double level = search_level(task->evaluation, *policy, limit);
  TrialWriter writer = store.begin(kind_name(trial.kind), trial.id);
  writer.write(kLevelFile, cat(level));
  writer.commit(trial.canonical);
  return {};
}

}  // namespace

Outcome run_trial(const Study& study, const Plan& plan, std::size_t index, const Store& store, std::stop_token stop,
                  ProgressSink& progress) {
  const Trial& trial = plan.trials[index];
  if (const std::optional<StoredTrial> done = load_trial(plan, trial, store)) {
    return done->contains(kFailureFile) ? failure(done->read(kFailureFile)) : Outcome{};
  }
  switch (trial.kind) {
    case Trial::Kind::kTrain:
      return run_train(study, trial, store, stop, progress);
    case Trial::Kind::kSearch:
      return run_search(study, plan, trial, store);
    case Trial::Kind::kMargin:
      return run_margin(study, plan, trial, store, stop, progress);
    default:
      return run_evaluate(study, plan, trial, store, stop, progress);
  }
}

RowsHeader rows_header(const Study& study, std::uint64_t cells) {
  RowsHeader header{.episodes = static_cast<std::uint64_t>(study.episodes), .cells = cells};
  for (const std::size_t m : study.metric_set.stored()) header.metrics.push_back(study.metric_set.name(m));
  for (const StartProtocol& start : study.starts) header.starts.push_back(start.name);
  return header;
}

std::unique_ptr<TrialEvaluation> trial_evaluation(const Study& study, const Trial& trial) {
  auto task = std::make_unique<TrialEvaluation>();
  task->injections = study.always;
  const Sweep* sweep = trial.sweep == Trial::kNominal ? nullptr : &study.sweeps[trial.sweep];
  if (sweep) task->injections.insert(task->injections.end(), sweep->disturbed.begin(), sweep->disturbed.end());
  if (sweep && sweep->injection) task->injections.push_back(*sweep->injection);

  Evaluation& evaluation = task->evaluation;
  evaluation.source = study.setup.plant.object.get();
  evaluation.injections = task->injections;
  evaluation.starts = study.starts;
  evaluation.episodes = study.episodes;
  evaluation.root = Rng(static_cast<std::uint64_t>(study.seed));
  evaluation.cells.assign(sweep ? sweep->cells() : 1, plain_cell(study, trial, task->injections));
  if (sweep == nullptr) return task;
  for (std::size_t c = 0; c < evaluation.cells.size(); ++c) {
    const std::vector<double> at = sweep->at(c);
    for (std::size_t a = 0; a < sweep->axes.size(); ++a) {
      const Sweep::Axis& axis = sweep->axes[a];
      (axis.parameter.empty() ? evaluation.cells[c].levels.back() : evaluation.cells[c].parameters[axis.index]) = at[a];
    }
  }
  return task;
}

void measure(const Study& study, Episode episode, std::span<double> metrics) {
  if (!study.terminate) episode.ended = episode.whole;
  for (std::size_t m = 0; m < metrics.size(); ++m) metrics[m] = study.metric_set[m].value(episode);
}

std::unique_ptr<Policy> trial_policy(const Study& study, const Plan& plan, const Trial& trial, const Store& store) {
  PolicyMember member{trial.member};
  if (!trial.inputs.empty()) {
    const Trial& training = plan.trials[trial.inputs.front()];
    const std::optional<StoredTrial> stored = load_trial(plan, training, store);
    if (!stored || !stored->contains(kPolicyFile))
      throw Error(cat("the policy of '", training.what, "' is not in the store"));
    member.training = training.id;
    member.network = stored->read(kPolicyFile);
  }
  return study.policies[trial.policy].source->make(study.setup, member);
}

std::optional<std::string> training_failure(const Plan& plan, const Trial& trial, const Store& store) {
  const Trial& first = trial.inputs.empty() ? trial : plan.trials[trial.inputs.front()];
  if (first.kind != Trial::Kind::kTrain) return {};
  const std::optional<StoredTrial> stored = load_trial(plan, first, store);
  if (!stored || !stored->contains(kFailureFile)) return {};
  return stored->read(kFailureFile);
}

std::optional<double> found_level(const Plan& plan, const Trial& trial, const Store& store) {
  const std::optional<StoredTrial> stored = load_trial(plan, trial, store);
  if (!stored) return std::nullopt;
  return read_level(*stored);
}

double read_level(const StoredTrial& stored) {
  const double level = number_from_text(stored.read(kLevelFile), kLevelFile);
  if (!(level >= 0)) throw Error(cat(kLevelFile, ": must be a level, got ", level));
  return level;
}

}  // namespace gust
