#include "gust/study/trials/training_driver.h"

#include "gust/core/text.h"
#include "gust/store/checkpoint.h"
#include "gust/store/files.h"

namespace gust {
namespace {

constexpr std::chrono::seconds kBetweenCheckpoints{2};

class StorePlace final : public CheckpointPlace {
 public:
  StorePlace(const Store& store, std::string id) : store_(store), id_(std::move(id)) {}
  std::optional<std::string> load() const override { return load_checkpoint(store_, id_); }
  void keep(std::string_view state) const override { save_checkpoint(store_, id_, state); }
  void remove() const override { remove_checkpoint(store_, id_); }

 private:
  const Store& store_;
  std::string id_;
};

class FilePlace final : public CheckpointPlace {
 public:
  FilePlace(std::filesystem::path file, std::string identity)
      : file_(std::move(file)), identity_(std::move(identity)) {}

  std::optional<std::string> load() const override {
    std::error_code unknown;
    if (!std::filesystem::is_regular_file(file_, unknown)) return std::nullopt;
    return checkpoint_state(read_file(file_, kCheckpointBytes), identity_);
  }
  void keep(std::string_view state) const override { write_file_atomically(file_, checkpoint_text(identity_, state)); }
  void remove() const override {
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
  }

 private:
  std::filesystem::path file_;
  std::string identity_;
};

}  // namespace

std::unique_ptr<CheckpointPlace> checkpoint_in(const Store& store, std::string id) {
  return std::make_unique<StorePlace>(store, std::move(id));
}

std::unique_ptr<CheckpointPlace> checkpoint_file(std::filesystem::path file, std::string identity) {
  return std::make_unique<FilePlace>(std::move(file), std::move(identity));
}

std::unique_ptr<Training> begin_training(const Agent& agent, const TrainingTask& task, const CheckpointPlace& place) {
  std::unique_ptr<Training> training = agent.start(task);
  const std::optional<std::string> state = place.load();
  if (!state) return training;
  try {
    training->load(*state);
    return training;
  } catch (const Error&) {  // from another version: train from the start
    place.remove();
    return agent.start(task);
  }
}

void keep_checkpoint(const Training& training, const CheckpointPlace& place,
                     const std::function<void(const std::string&)>& warn) {
  try {
    place.keep(training.save());
  } catch (const Error& error) {
    warn(cat("warning: no checkpoint: ", error.what()));
  }
}

bool train_to_end(Training& training, const CheckpointPlace& place, const std::stop_token& stop,
                  const std::function<void(double)>& tell_share, const std::function<void(const std::string&)>& warn) {
  CheckpointPace pace(kBetweenCheckpoints);
  while (!training.done()) {
    const bool stopping = stop.stop_requested();
    if (stopping || pace.due()) pace.keep([&] { keep_checkpoint(training, place, warn); });
    if (stopping) return false;
    training.advance();
    tell_share(static_cast<double>(training.steps()) / static_cast<double>(training.total_steps()));
  }
  return true;
}

}  // namespace gust
