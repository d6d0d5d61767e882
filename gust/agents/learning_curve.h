#pragma once

#include <optional>

#include "gust/agents/agent.h"

namespace gust {

inline constexpr std::int64_t kStepsBetweenPoints = 20'000;

/// Measures a deterministic actor in ten episodes that start in the training distribution, without disturbances unless
/// the task's curve has them. Equal streams give equal episodes.
CurvePoint measure_actor(const TrainingTask& task, const ActorNetwork& actor, Rng rng);

/// A learning curve in the making: a point at the start, at the first step at or after every multiple of
/// kStepsBetweenPoints, and at the end.
class LearningCurve {
 public:
  LearningCurve(const TrainingTask& task, Rng rng) : task_(task), rng_(rng) {}

  const std::vector<CurvePoint>& points() const { return points_; }

  /// Adds the point that is due after `steps` steps of a training, if one is. The actor has learned from all of them
  /// unless told otherwise.
  void follow(const Training& training, std::int64_t steps, bool last,
              std::optional<std::int64_t> protagonist_steps = std::nullopt);

  template <class Archive, class Self>
  static void archive(Archive& archive, Self& self) {
    archive.list(self.points_);
  }

 private:
  TrainingTask task_;
  Rng rng_;
  std::vector<CurvePoint> points_;
};

}  // namespace gust
