#include <cmath>
#include <limits>

#include "gust/control/loop_source.h"

namespace gust {
namespace {

/// The least that a loop can be: a number that drifts by 0.1 a step and by what the policy gives, and a reward of minus
/// its size. Nobody is told a state, a force, what the actuator did or a failure. Far away it breaks, as an environment
/// of somebody else may.
struct Drift {
  double drift = 0.1;
  double breaks_at = 1000.0;

  static constexpr std::tuple kFields = {
      field("drift", &Drift::drift, "what is added in a step"),
      field("breaks_at", &Drift::breaks_at, "size of the number that breaks the loop", positive)};
};

class DriftLoop final : public Loop {
 public:
  DriftLoop(const Interface& spec, const Drift& of, std::span<const Injection> injections, std::size_t lanes)
      : spec_(spec),
        of_(of),
        disturber_(injections, {spec.steps, spec.control_rate}, lanes),
        counter_(lanes, 0),
        reward_(lanes, 0.0),
        value_(1, lanes),
        seen_(1, lanes),
        action_(1, lanes) {}

  const Interface& spec() const override { return spec_; }
  std::size_t lanes() const override { return counter_.size(); }
  Rows<const double> observation() const override { return seen_.view(); }
  std::span<const std::int64_t> steps_done() const override { return counter_; }
  StepRecord record() const override { return {.reward = reward_}; }

  void begin(std::size_t lane, const EpisodeStart& start) override {
    disturber_.begin(lane, start);
    counter_[lane] = start.step;
    value_.at(0, lane) = seen_.at(0, lane) = start.state[0];
    disturber_.apply(Site::kObservation, counter_[lane], seen_.view(), lane);
  }

  void step(Rows<const double> command) override {
    for (std::size_t lane = 0; lane < lanes(); ++lane) action_.at(0, lane) = command.at(0, lane);
    disturber_.apply(Site::kAction, counter_, action_.view(), {});
    for (std::size_t lane = 0; lane < lanes(); ++lane) {
      value_.at(0, lane) += of_.drift + action_.at(0, lane);
      if (std::abs(value_.at(0, lane)) > of_.breaks_at) throw Error("the drift has broken");
      reward_[lane] = -std::abs(value_.at(0, lane));
      seen_.at(0, lane) = value_.at(0, lane);
      ++counter_[lane];
    }
    disturber_.apply(Site::kObservation, counter_, seen_.view(), {});
  }

 private:
  const Interface& spec_;
  Drift of_;
  Disturber disturber_;
  std::vector<std::int64_t> counter_;
  std::vector<double> reward_;
  Matrix<double> value_, seen_, action_;
};

class Drifts final : public LoopSource {
 public:
  explicit Drifts(const Drift& of) : of_(of) {
    constexpr double kAny = std::numeric_limits<double>::infinity();
    spec_.observation = {{"value", "1"}};
    spec_.action = {{"change", "1"}};
    spec_.control_rate = 10;
    spec_.steps = 20;
    spec_.action_scale = {1};
    spec_.action_offset = {0};
    spec_.action_low = {-kAny};
    spec_.action_high = {kAny};
    spec_.reward = {};
    spec_.tells_effort = spec_.fails = spec_.goes_on = false;
  }

  const Interface& spec() const override { return spec_; }
  std::vector<StartProtocol> starts() const override { return {random_starts()}; }
  std::vector<double> start_state(const StartProtocol&, Rng episode) const override {
    return {episode.split("start").uniform(0)};
  }
  std::unique_ptr<Loop> make(std::span<const Injection> injections, std::size_t lanes) const override {
    return std::make_unique<DriftLoop>(spec_, of_, injections, lanes);
  }

 private:
  Interface spec_;
  Drift of_;
};

}  // namespace

Entry<LoopSource> loop_drift() {
  return make_entry<LoopSource, Drift>("drift", "Number that drifts and tells nothing but a reward.", "gust",
                                       [](const Drift& options) { return std::make_unique<Drifts>(options); });
}

}  // namespace gust
