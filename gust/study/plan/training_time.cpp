#include "gust/study/plan/training_time.h"

namespace gust {
namespace {

constexpr double kSecondsPerOperation = 1e-11;
constexpr double kSecondsPerTrainingStep = 1e-6;

}  // namespace

double training_seconds(const Agent& agent, const LoopSource& source) {
  const double step = kSecondsPerTrainingStep + source.seconds_per_step();
  return static_cast<double>(agent.steps()) * (step + kSecondsPerOperation * agent.work());
}

}  // namespace gust
