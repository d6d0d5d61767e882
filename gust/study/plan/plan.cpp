#include "gust/study/plan/plan.h"

#include <algorithm>
#include <cmath>

#include "gust/core/hash.h"
#include "gust/core/text.h"
#include "gust/study/plan/training_time.h"

namespace gust {
namespace {

// Raised when the same text would give another outcome.
constexpr int kTrainVersion = 1;
constexpr int kSearchVersion = 2;
constexpr int kEvaluateVersion = 1;
constexpr int kMarginVersion = 1;
constexpr double kMarginLevels = 40;  // that a margin looks at, about

// Predicted seconds on one core of a current machine, until this one was measured (timings.h).
constexpr double kSecondsPerEpisodeStep = 1.5e-7;

void name_trial(Trial& trial, std::string_view label) {
  trial.guess = trial.seconds;
  trial.id = cat(slug(label, 40), "-", hash_hex(trial.canonical).substr(0, 20));
}

/// Whether commands clipped to the policy's box are those that the actuator would clip anyway.
bool box_is_actuator(const Interface& spec) {
  if (!spec.normalized_action) return true;
  for (std::size_t i = 0; i < spec.action.size(); ++i) {
    if (spec.action_offset[i] - spec.action_scale[i] != spec.action_low[i] ||
        spec.action_offset[i] + spec.action_scale[i] != spec.action_high[i])
      return false;
  }
  return true;
}

/// What a training stands on. Where nothing is disturbed, nobody can tell where a force would pull, nor, as long as the
/// reward does not charge the sum that is clipped, when the actuator clips it: such trainings have one text and are
/// shared.
std::string training_text(const Study& study, const PolicyTraining& training) {
  Setup setup = study.setup;
  if (!training.disturbed.empty() || training.agent->disturbs()) return setup.canonical();
  setup.readings.tap_point = Readings{}.tap_point;
  setup.plant.options = setup.plant.options.with("tap_point", canonical_text(setup.readings.tap_point));
  if (setup.readings.effort != "disturbed" && box_is_actuator(setup.plant->spec()))
    setup.readings.saturate = Readings{}.saturate;
  return setup.canonical();
}

std::string injections_text(const std::vector<Injection>& injections) {
  std::string text;
  for (const Injection& injection : injections) {
    text += cat("disturb ", injection.canonical(), " level ", canonical_text(injection.level), "\n");
  }
  return text;
}

std::string randomised_text(const Study& study, const PolicyTraining& training) {
  const std::string text = training.randomised.canonical(study.setup.plant->spec());
  return text.empty() ? text : cat("randomise ", text, "\n");
}

/// What is different in all cells of a sweep.
std::string setting_text(const Study& study, const Sweep& sweep) {
  std::string text = injections_text(sweep.disturbed);
  for (const auto& [index, value] : sweep.parameters)
    text += cat("parameter ", study.setup.plant->spec().parameters[index].name, " ", canonical_text(value), "\n");
  return text;
}

/// What the policy is, without its name: equal policies in two studies share their trials.
std::string policy_text(const Study& study, const Trial& trial, const Plan& plan) {
  PolicyMember member{trial.member};
  if (!trial.inputs.empty()) member.training = plan.trials[trial.inputs.front()].id;
  return cat("policy ", study.policies[trial.policy].source->canonical(member));
}

std::string member_label(const StudyPolicy& policy, std::size_t member) {
  if (policy.training()) return cat(policy.name, " seed ", policy.member(member));
  return policy.count() > 1 ? cat(policy.name, " ", policy.member(member)) : policy.name;
}

Trial train_trial(const Study& study, std::size_t policy, std::size_t member) {
  const PolicyTraining& training = *study.policies[policy].training();
  Trial trial{.kind = Trial::Kind::kTrain, .policy = policy, .member = member};
  trial.canonical =
      cat("train v", kTrainVersion, "\n", training_text(study, training), "agent ", training.agent.canonical(), "\n",
          injections_text(training.disturbed), randomised_text(study, training),
          training.curve_as_trained ? "curve training\n" : "", "seed ", training.seeds[member], "\n");
  trial.what = cat("train ", member_label(study.policies[policy], member));
  if (!training.randomised.draws.empty())
    trial.what += cat(" · randomise ", training.randomised.label(study.setup.plant->spec()));
  trial.seconds = training_seconds(*training.agent.object, *study.setup.plant);
  name_trial(trial, cat(training.agent.kind, " s", training.seeds[member]));
  return trial;
}

Trial search_trial(const Study& study, Trial trial, const Plan& plan) {
  const Sweep& sweep = study.sweeps[trial.sweep];
  trial.kind = Trial::Kind::kSearch;
  trial.canonical = cat("search v", kSearchVersion, "\n", study.setup.canonical(), policy_text(study, trial, plan),
                        injections_text(study.always), setting_text(study, sweep), "sweep ",
                        sweep.injection->canonical(), "\nseed ", study.seed, "\n");
  trial.what = cat("search ", member_label(study.policies[trial.policy], trial.member), " · ", sweep.name);
  trial.seconds = 0.1;
  name_trial(trial, cat(site_name(sweep.injection->site), " ", sweep.injection->kind()));
  return trial;
}

std::string sweep_text(const Study& study, const Trial& trial) {
  if (trial.sweep == Trial::kNominal) return "nominal\n";
  const Sweep& sweep = study.sweeps[trial.sweep];
  std::string text = setting_text(study, sweep);
  if (sweep.injection) text += cat("sweep ", sweep.injection->canonical(), "\n");
  for (const Sweep::Axis& axis : sweep.axes) {
    text += cat("axis ", axis.name(), " ", canonical_text(axis.values), "\n");
  }
  return text;
}

std::string starts_text(const Study& study) {
  std::string text;
  for (const StartProtocol& start : study.starts) {
    text += start.random ? "start random\n" : cat("start ", canonical_text(start.state), "\n");
  }
  return text;
}

std::string sweep_label(const Study& study, const Trial& trial) {
  if (trial.sweep == Trial::kNominal) return "nominal";
  const Sweep& sweep = study.sweeps[trial.sweep];
  if (sweep.along_levels()) return cat(site_name(sweep.injection->site), " ", sweep.injection->kind());
  return sweep.axes.size() == 1 ? sweep.axes[0].parameter : cat(sweep.axes[0].parameter, " ", sweep.axes[1].parameter);
}

/// What one episode and one cell after the other take.
double evaluation_seconds(const Study& study, double cells) {
  const Interface& spec = study.setup.plant->spec();
  const double steps =
      cells * static_cast<double>(study.starts.size()) * static_cast<double>(study.episodes * spec.steps);
  return steps * (kSecondsPerEpisodeStep + study.setup.plant->seconds_per_step());
}

Trial evaluate_trial(const Study& study, Trial trial, const Plan& plan) {
  trial.kind = Trial::Kind::kEvaluate;
  trial.canonical =
      cat("evaluate v", kEvaluateVersion, "\n", study.setup.canonical(), policy_text(study, trial, plan),
          injections_text(study.always), sweep_text(study, trial), starts_text(study), "episodes ", study.episodes,
          "\nterminate ", study.terminate, "\nseed ", study.seed, "\ntraces worst ", study.traces.worst, " median ",
          study.traces.median, " by ", study.metric_set.name(study.metrics.front()), "\n");
  const std::string name = trial.sweep == Trial::kNominal ? "nominal" : study.sweeps[trial.sweep].name;
  trial.what = cat("evaluate ", member_label(study.policies[trial.policy], trial.member), " · ", name);
  trial.cells = trial.sweep == Trial::kNominal ? 1 : study.sweeps[trial.sweep].cells();
  trial.seconds = evaluation_seconds(study, static_cast<double>(trial.cells));
  name_trial(trial, sweep_label(study, trial));
  return trial;
}

/// The evaluations of a policy's members, undisturbed and along a sweep, without those whose training failed.
std::vector<std::size_t> margin_inputs(const Plan& plan, std::size_t policy, std::size_t sweep,
                                       const std::set<std::string>& failed) {
  std::vector<std::size_t> inputs;
  for (std::size_t i = 0; i < plan.trials.size(); ++i) {
    const Trial& trial = plan.trials[i];
    if (trial.kind != Trial::Kind::kEvaluate || trial.policy != policy) continue;
    if (trial.sweep != sweep && trial.sweep != Trial::kNominal) continue;
    const bool trained = trial.inputs.empty() || !failed.contains(plan.trials[trial.inputs.front()].id);
    if (trained) inputs.push_back(i);
  }
  return inputs;
}

Trial margin_trial(const Study& study, const Plan& plan, std::vector<std::size_t> inputs) {
  const Trial& first = plan.trials[inputs.back()];
  Trial trial{.kind = Trial::Kind::kMargin, .policy = first.policy, .member = first.member, .sweep = first.sweep};
  trial.canonical = cat("margin v", kMarginVersion, "\n");
  for (const std::size_t input : inputs) trial.canonical += cat("input ", plan.trials[input].id, "\n");
  trial.canonical += cat("score ", study.metric_set.name(margin_metric(study)), "\ntolerance ",
                         canonical_text(study.margin_tolerance), "\n");
  const auto members = static_cast<double>(inputs.size()) / 2;
  trial.what = cat("margin ", study.policies[trial.policy].name, " · ", study.sweeps[trial.sweep].name);
  trial.inputs = std::move(inputs);
  trial.seconds = evaluation_seconds(study, kMarginLevels * members);
  name_trial(trial, sweep_label(study, trial));
  return trial;
}

/// The training that a policy's member comes from, if it is trained.
std::vector<std::size_t> inputs_of(const Plan& plan, std::size_t policy, std::size_t member) {
  for (std::size_t i = 0; i < plan.trials.size(); ++i) {
    const Trial& trial = plan.trials[i];
    if (trial.kind == Trial::Kind::kTrain && trial.policy == policy && trial.member == member) return {i};
  }
  return {};
}

template <class Visit>
void for_each_member(const Study& study, Visit&& visit) {
  for (std::size_t policy = 0; policy < study.policies.size(); ++policy) {
    for (std::size_t member = 0; member < study.policies[policy].count(); ++member) visit(policy, member);
  }
}

}  // namespace

std::string_view kind_name(Trial::Kind kind) {
  static constexpr std::string_view kNames[] = {"train", "search", "evaluate", "margin"};
  return kNames[static_cast<int>(kind)];
}

bool refines_margin(const Study& study, const Sweep& sweep) {
  return study.margin_tolerance > 0 && sweep.along_levels() && sweep.axes.front().values.size() > 1 &&
         sweep.axes.front().values.front() >= 0;
}

Plan expand(const Study& study, const FoundLevels& found, const std::set<std::string>& failed) {
  Plan plan{.starts = study.starts, .episodes = static_cast<std::uint64_t>(study.episodes)};
  for_each_member(study, [&](std::size_t policy, std::size_t member) {
    if (study.policies[policy].training()) plan.trials.push_back(train_trial(study, policy, member));
  });
  for_each_member(study, [&](std::size_t policy, std::size_t member) {
    const Trial base{.policy = policy, .member = member, .inputs = inputs_of(plan, policy, member)};
    for (std::size_t sweep = 0; sweep < study.sweeps.size(); ++sweep) {
      if (!study.sweeps[sweep].automatic) continue;
      Trial trial = base;
      trial.sweep = sweep;
      plan.trials.push_back(search_trial(study, trial, plan));
    }
  });
  for_each_member(study, [&](std::size_t policy, std::size_t member) {
    const Trial base{.policy = policy, .member = member, .inputs = inputs_of(plan, policy, member)};
    plan.trials.push_back(evaluate_trial(study, base, plan));
    for (std::size_t sweep = 0; sweep < study.sweeps.size(); ++sweep) {
      if (study.sweeps[sweep].automatic && !found.contains(sweep)) {
        plan.complete = false;
        continue;
      }
      Trial trial = base;
      trial.sweep = sweep;
      plan.trials.push_back(evaluate_trial(study, trial, plan));
    }
  });
  for (std::size_t policy = 0; policy < study.policies.size(); ++policy) {
    for (std::size_t sweep = 0; sweep < study.sweeps.size(); ++sweep) {
      const bool waits = study.sweeps[sweep].automatic && !found.contains(sweep);
      if (waits || !refines_margin(study, study.sweeps[sweep])) continue;
      std::vector<std::size_t> inputs = margin_inputs(plan, policy, sweep, failed);
      if (!inputs.empty()) plan.trials.push_back(margin_trial(study, plan, std::move(inputs)));
    }
  }
  return plan;
}

void set_levels(Study& study, const FoundLevels& found) {
  for (const auto& [sweep, levels] : found) study.sweeps[sweep].axes.front().values = levels;
}

double search_limit(const Injection& injection, const Interface& spec) {
  if (injection.is_effect()) return injection.effect->limit(spec.control_rate);
  return injection.site == Site::kObservation ? 12.0 : 60.0;
}

std::vector<double> common_levels(const std::vector<double>& failure_levels, double limit) {
  static constexpr double kShares[] = {0, 0.25, 0.5, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.35, 1.5};
  double greatest = 0;
  for (const double level : failure_levels) greatest = std::max(greatest, std::isfinite(level) ? level : 0.0);
  const double unit = greatest > 0 ? greatest : limit / 1.5;
  std::vector<double> levels;
  for (const double share : kShares) {
    const double level = unit * share;
    levels.push_back(std::stod(fmt::format("{:.3g}", level)));  // levels that people can read
  }
  return levels;
}

}  // namespace gust
