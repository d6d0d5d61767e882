#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "gust/study/plan/plan.h"

namespace gust {

/// How long trials take on this machine, beside what was predicted without having measured it. Of no influence on any
/// number; a store keeps it in timings.json.
class Timings {
 public:
  /// What a store has measured so far; nothing where there is no such file, or one that cannot be read.
  explicit Timings(const std::filesystem::path& store);

  /// Notes a trial that ran from its beginning to its end. From any thread.
  void note(const std::string& kind, double predicted, double seconds);
  /// Adds what was noted to the store's file, if it can be written.
  void save() const;

  /// By what a prediction of this kind is to be multiplied; 1 where nothing is known.
  double factor(const std::string& kind) const;

 private:
  struct Sum {
    double predicted = 0;
    double seconds = 0;
  };
  /// Believes a sum of the file, unless somebody wrote nonsense into it.
  void take(const std::string& kind, const Sum& sum);

  std::filesystem::path file_;
  mutable std::mutex mutex_;
  std::map<std::string, Sum> known_;
  std::map<std::string, Sum> noted_;
};

/// What of a trial its time depends on beside its size: "train ppo cartpole scg-2022".
std::string timing_kind(const Study& study, const Trial& trial);

/// Predicts the seconds of all trials of a plan from what was measured.
void predict(const Study& study, const Timings& timings, Plan& plan);

}  // namespace gust
