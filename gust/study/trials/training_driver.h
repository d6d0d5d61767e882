#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>

#include "gust/agents/agent.h"
#include "gust/store/store.h"

namespace gust {

/// Where the state of a training is kept while it is not finished.
class CheckpointPlace {
 public:
  virtual ~CheckpointPlace() = default;
  /// What was kept last; nothing if that is damaged, or of another training.
  virtual std::optional<std::string> load() const = 0;
  /// Replaces it, whole or not at all. Throws Error if it cannot be written.
  virtual void keep(std::string_view state) const = 0;
  virtual void remove() const = 0;
};

/// STORE/checkpoints/<id>; the store must outlive it.
std::unique_ptr<CheckpointPlace> checkpoint_in(const Store& store, std::string id);
/// A file of its own, in the same format. `identity` is equal for trainings that are the same.
std::unique_ptr<CheckpointPlace> checkpoint_file(std::filesystem::path file, std::string identity);

/// A training that goes on from its checkpoint, or begins where there is none that this version can read.
std::unique_ptr<Training> begin_training(const Agent& agent, const TrainingTask& task, const CheckpointPlace& place);

/// Advances to the end, keeping checkpoints now and then and when it is stopped; false if it was stopped before the
/// end. Tells the share that is done. A checkpoint that cannot be written is a warning, and the training goes on.
bool train_to_end(Training& training, const CheckpointPlace& place, const std::stop_token& stop,
                  const std::function<void(double)>& tell_share, const std::function<void(const std::string&)>& warn);

/// Keeps the state of a training now; what goes wrong is a warning.
void keep_checkpoint(const Training& training, const CheckpointPlace& place,
                     const std::function<void(const std::string&)>& warn);

}  // namespace gust
