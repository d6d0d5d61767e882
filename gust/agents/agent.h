#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gust/control/adversary.h"
#include "gust/core/catalog.h"
#include "gust/nn/actor_network.h"
#include "gust/sim/randomise.h"

namespace gust {

/// What an agent trains on. Plant, injections and draws must outlive the training.
struct TrainingTask {
  const Plant* plant = nullptr;
  Readings readings;
  std::span<const Injection> injections;           ///< on during training, each at its own level
  std::int64_t seed = 0;                           ///< of every random stream of the training
  std::span<const ParameterDraw> randomised = {};  ///< parameters that are sampled for every episode of the training
  bool curve_as_trained = false;                   ///< the learning curve's episodes are drawn and disturbed, too
};

/// Ten deterministic episodes from the starts of the training, without any disturbance, with nominal parameters, unless
/// the task says otherwise (docs/algorithms.md 7.4).
struct CurvePoint {
  std::int64_t steps = 0;  ///< environment steps of the training so far
  double return_mean = 0;  ///< of the return sum, the episode ending at failure
  double return_std = 0;   ///< population standard deviation
  double length_mean = 0;
  double anr = 0;    ///< return / length
  double anr_h = 0;  ///< return / horizon
  double rmse_scg = 0;
  std::int64_t protagonist_steps = 0;  ///< those that the policy itself has learned from
};

/// A number of a learning curve, as files and formulas call it.
struct CurveColumn {
  const char* name;
  double CurvePoint::*value;
};

/// All of them, in the order of the files.
inline constexpr CurveColumn kCurveColumns[] = {{"return_mean", &CurvePoint::return_mean},
                                                {"return_std", &CurvePoint::return_std},
                                                {"length_mean", &CurvePoint::length_mean},
                                                {"anr", &CurvePoint::anr},
                                                {"anr_h", &CurvePoint::anr_h},
                                                {"rmse_scg", &CurvePoint::rmse_scg}};

/// An adversary that a policy was trained against, and where it acts.
struct TrainedAdversary {
  ActorNetwork actor;
  AdversarySite against;
};

/// A training in progress. One thread at a time; equal tasks and options give equal bits.
class Training {
 public:
  virtual ~Training() = default;

  /// Does one iteration. NaN and infinities end the training with a failure, they do not throw.
  virtual void advance() = 0;
  virtual bool done() const = 0;
  virtual std::int64_t steps() const = 0;        ///< environment steps done
  virtual std::int64_t total_steps() const = 0;  ///< environment steps when done
  /// Why the training ended early; empty if it did not.
  virtual const std::string& failure() const = 0;
  virtual const std::vector<CurvePoint>& curve() const = 0;
  /// The deterministic actor as it is now: observation in, action in the policy's unit out.
  virtual ActorNetwork actor() const = 0;

  /// The adversaries as they are now; none if the policy learns by itself.
  virtual std::vector<TrainedAdversary> adversaries() const { return {}; }

  /// The whole state between two iterations. A training that loads it goes on exactly as the saved one would have.
  virtual std::string save() const = 0;
  /// Throws Error if the bytes are no state of such a training.
  virtual void load(std::string_view bytes) = 0;
};

/// Risk levels that a policy was trained for.
struct LevelRange {
  double low = 0;
  double high = 1;
};

/// Trains policies. Immutable; options come from the catalogue.
class Agent {
 public:
  virtual ~Agent() = default;

  virtual std::int64_t steps() const = 0;  ///< environment steps of a full training
  /// Floating-point operations of one such step with what is learned from it, about: what predicted times scale with.
  virtual double work() const = 0;
  /// Whether it disturbs its own training.
  virtual bool disturbs() const { return false; }
  /// Bytes that grow during a training of this plant, at their most: a replay buffer.
  virtual std::uint64_t memory(const PlantSpec&) const { return 0; }
  /// Throws Error at the place if it cannot train on such a plant.
  virtual void check(const PlantSpec& /*spec*/, const Place& /*place*/) const {}
  /// The risk levels that its policies may be told to act at; none if they take none.
  virtual std::optional<LevelRange> levels() const { return {}; }
  virtual std::unique_ptr<Training> start(const TrainingTask& task) const = 0;
};

/// Every agent there is, in the order of list.inc.
const Catalog<Agent>& agents();

}  // namespace gust
