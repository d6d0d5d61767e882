#pragma once

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "gust/store/store.h"

namespace gust {

/// When a checkpoint is due: no sooner than `least` after the last one, and so seldom that writing them takes at most a
/// fiftieth of the time, for the memory of a training may have a hundred megabytes.
class CheckpointPace {
 public:
  using Clock = std::chrono::steady_clock;

  explicit CheckpointPace(Clock::duration least) : least_(least), wait_(least), last_(Clock::now()) {}

  bool due() const { return Clock::now() - last_ > wait_; }

  /// Writes a checkpoint by calling `write`.
  template <class Write>
  void keep(Write&& write) {
    const Clock::time_point start = Clock::now();
    write();
    last_ = Clock::now();
    wait_ = std::max(least_, 50 * (last_ - start));
  }

 private:
  Clock::duration least_;
  Clock::duration wait_;
  Clock::time_point last_;
};

inline constexpr std::size_t kCheckpointBytes = std::size_t{4} << 30;  ///< a replay buffer is the greatest part

/// A checkpoint of whoever `owner` names, as it is written wherever it lies.
std::string checkpoint_text(std::string_view owner, std::string_view state);
/// The state in such a text; nothing if it is damaged or another one's.
std::optional<std::string> checkpoint_state(std::string_view text, std::string_view owner);

/// Whether a training was begun and not finished.
bool has_checkpoint(const Store& store, std::string_view id);

/// Keeps the state of a training in progress: STORE/checkpoints/<id>, replaced whole or not at all. Committing the
/// trial removes it.
void save_checkpoint(const Store& store, std::string_view id, std::string_view bytes);

/// The bytes last saved for the trial; nothing if there are none or if they are damaged.
std::optional<std::string> load_checkpoint(const Store& store, std::string_view id);

/// Forgets the checkpoint of a trial, if there is one.
void remove_checkpoint(const Store& store, std::string_view id);

/// Forgets the checkpoints of trials that are finished, which a second process may have left.
void remove_idle_checkpoints(const Store& store);

}  // namespace gust
