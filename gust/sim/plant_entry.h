#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "gust/core/dual.h"
#include "gust/core/pack.h"
#include "gust/sim/plant.h"

namespace gust {

/// The plant of a law: `Options` gives the spec, the reference and `template <class T> Law`, the equations written
/// once. Law<T>(options, parameters) prepares what a control step shares; start(state) begins one; substep(state,
/// action, force, dt) moves by dt. The state is kStates visible components, then kHidden rows of memory, which
/// remember(state, moving) sets.
template <class Options>
class LawPlant final : public Plant {
 public:
  explicit LawPlant(const Options& options)
      : options_(options), spec_(options.spec()), substeps_(std::lround(spec_.physics_rate / spec_.control_rate)) {}

  const PlantSpec& spec() const override { return spec_; }

  void advance(const Motion& motion) const noexcept override {
    if (motion.split) {
      for (std::size_t lane = 0; lane < motion.state.lanes; lane += kPackLanes) advance_split(motion, lane);
      return;
    }
    for (std::size_t lane = 0; lane < motion.state.lanes; lane += kTogether * kPackLanes) advance_packs(motion, lane);
  }

  void reference(std::size_t sample, std::span<double> to) const noexcept override { options_.reference(sample, to); }

  void begin(Rows<double> state, std::size_t lane, bool moving) const noexcept override {
    std::array<double, kRows> x;
    for (int i = 0; i < Options::kStates; ++i) x[i] = state.at(i, lane);
    options_.remember(x.data(), moving);
    for (int i = Options::kStates; i < kRows; ++i) state.at(i, lane) = x[i];
  }

  bool near_ground(std::span<const double> state) const noexcept override { return options_.near_ground(state); }

  Linearisation linearise(std::span<const double> state, std::span<const double> action) const override {
    constexpr int kInputs = Options::kStates + Options::kActions;
    using D = Dual<kInputs>;
    std::array<D, kRows> x;
    std::array<D, Options::kActions> u;
    std::array<D, Options::kForces> force;
    std::array<D, Options::kParameters> parameters;
    for (int i = 0; i < Options::kStates; ++i) x[i] = D::input(state[i], i);
    options_.remember(x.data(), true);
    for (int i = 0; i < Options::kActions; ++i) u[i] = D::input(action[i], Options::kStates + i);
    for (int i = 0; i < Options::kParameters; ++i) parameters[i] = D(spec_.parameters[i].nominal);

    const typename Options::template Law<D> law(options_, parameters.data());
    law.start(x.data());
    for (long n = 0; n < substeps_; ++n) law.substep(x.data(), u.data(), force.data(), 1.0 / spec_.physics_rate);

    Linearisation result{Eigen::MatrixXd(Options::kStates, Options::kStates),
                         Eigen::MatrixXd(Options::kStates, Options::kActions)};
    for (int i = 0; i < Options::kStates; ++i) {
      for (int j = 0; j < Options::kStates; ++j) result.a(i, j) = x[i].slope[j];
      for (int j = 0; j < Options::kActions; ++j) result.b(i, j) = x[i].slope[Options::kStates + j];
    }
    return result;
  }

 private:
  static constexpr int kRows = Options::kStates + Options::kHidden;
  static constexpr std::size_t kTogether = 4;  // packs whose chains of dependent operations overlap; see bench/plants

  struct Lanes {
    std::array<Pack, kRows> state;
    std::array<Pack, Options::kActions> action;
    std::array<Pack, Options::kForces> force;
    std::optional<typename Options::template Law<Pack>> law;

    void load(const Motion& motion, const Options& options, std::size_t lane) {
      std::array<Pack, Options::kParameters> parameters;
      for (int i = 0; i < Options::kParameters; ++i) parameters[i] = gust::load(&motion.parameters.at(i, lane));
      law.emplace(options, parameters.data());
      for (int i = 0; i < kRows; ++i) state[i] = gust::load(&motion.state.at(i, lane));
      for (int i = 0; i < Options::kActions; ++i) action[i] = gust::load(&motion.action.at(i, lane));
      for (int i = 0; i < Options::kForces; ++i) force[i] = gust::load(&motion.force.at(i, lane));
      law->start(state.data());
    }
    void substep(double dt) { law->substep(state.data(), action.data(), force.data(), dt); }
    void store(const Motion& motion, std::size_t lane) const {
      for (int i = 0; i < kRows; ++i) gust::store(&motion.state.at(i, lane), state[i]);
    }
  };

  void advance_packs(const Motion& motion, std::size_t lane) const noexcept {
    std::array<Lanes, kTogether> lanes;
    for (std::size_t p = 0; p < kTogether; ++p) lanes[p].load(motion, options_, lane + p * kPackLanes);
    const double dt = 1.0 / spec_.physics_rate;
    for (long n = 0; n < substeps_; ++n) {
#pragma GCC unroll 8
      for (std::size_t p = 0; p < kTogether; ++p) lanes[p].substep(dt);
    }
    for (std::size_t p = 0; p < kTogether; ++p) lanes[p].store(motion, lane + p * kPackLanes);
  }

  /// The same with signals that change within the step. A lane in which nothing changes has the bits of the above.
  void advance_split(const Motion& motion, std::size_t lane) const noexcept {
    const SplitStep& split = *motion.split;
    Lanes late;
    late.load(motion, options_, lane);
    const Pack action_until = gust::load(&split.action_until.at(0, lane));
    const Pack force_until = gust::load(&split.force_until.at(0, lane));
    const Pack seen_after = gust::load(&split.seen_after.at(0, lane));
    std::array<Pack, Options::kActions> action;
    std::array<Pack, Options::kForces> force;
    for (long n = 0; n < substeps_; ++n) {
      const Pack done = Pack{} + static_cast<double>(n);
      for (int i = 0; i < Options::kActions; ++i)
        action[i] = select(done < action_until, gust::load(&split.action.at(i, lane)), late.action[i]);
      for (int i = 0; i < Options::kForces; ++i)
        force[i] = select(done < force_until, gust::load(&split.force.at(i, lane)), late.force[i]);
      late.law->substep(late.state.data(), action.data(), force.data(), 1.0 / spec_.physics_rate);
      for (int i = 0; i < Options::kStates; ++i) {
        double* seen = &split.seen.at(i, lane);
        gust::store(seen, select(done + 1.0 == seen_after, late.state[i], gust::load(seen)));
      }
    }
    late.store(motion, lane);
  }

  Options options_;
  PlantSpec spec_;
  long substeps_;
};

template <class Options>
Entry<Plant> plant_entry(std::string name, std::string summary, std::string source) {
  return make_entry<Plant, Options>(std::move(name), std::move(summary), std::move(source), [](const Options& options) {
    return std::make_unique<LawPlant<Options>>(options);
  });
}

}  // namespace gust
