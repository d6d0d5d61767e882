#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "gust/agents/agent.h"
#include "gust/setup/setup.h"
#include "gust/study/trials/training_driver.h"

namespace gust {

/// What `gust train` is asked, as it was typed.
struct TrainRequest {
  std::string agent;
  std::string plant;
  std::string preset = std::string(kStandardPreset);
  std::optional<std::int64_t> steps;
  std::int64_t seed = 1;
  std::vector<std::string> settings;  ///< key=value: of the agent, the readings or the plant
  std::string out;
  bool force = false;  ///< replace what is no policy of gust
};

/// One training whose policy becomes a file. While it runs its state is kept in OUT.checkpoint, so that a run that was
/// stopped or killed goes on and gives the same bytes; the checkpoint of another training is not used.
class TrainingRun {
 public:
  enum class End { done, failed, stopped };

  /// Mistakes in the request are Errors, and so is a folder that cannot be written.
  explicit TrainingRun(const TrainRequest& request);

  /// Trains to the end or until a stop is asked for; tells the share that is done now and then.
  End go(const std::stop_token& stop, const std::function<void(double)>& tell_share);

  /// What the user should know of the plant that was asked for, one sentence each.
  std::vector<std::string> warnings() const;
  std::int64_t steps() const { return training_->steps(); }
  std::int64_t total_steps() const { return training_->total_steps(); }
  /// On one core, guessed.
  double predicted_seconds() const;
  const std::string& failure() const { return training_->failure(); }
  /// Return over horizon of the last point of the learning curve; NaN if there is none.
  double last_score() const;

 private:
  void write_policy() const;

  std::string out_;
  std::int64_t seed_;
  Setup setup_;
  Made<Agent> agent_;
  Randomisation randomised_;
  std::string identity_;  ///< equal for trainings that are the same
  std::unique_ptr<CheckpointPlace> checkpoint_;
  std::unique_ptr<Training> training_;
};

}  // namespace gust
