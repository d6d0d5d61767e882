#include "gust/study/plan/timings.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "gust/store/files.h"
#include "gust/store/store_manifest.h"

namespace gust {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFarthest = 1e4;  // that a measurement lies from its prediction
constexpr std::size_t kMostBytes = std::size_t{1} << 20;

}  // namespace

Timings::Timings(const std::filesystem::path& store) : file_(store / kTimingsName) {
  std::error_code error;
  if (!std::filesystem::exists(file_, error)) return;
  try {
    const Json json = Json::parse(read_file(file_, kMostBytes));
    for (const auto& [kind, sum] : json.items())
      take(kind, {sum.at("predicted").get<double>(), sum.at("seconds").get<double>()});
  } catch (const std::exception&) {  // predictions are worth no trouble
    known_.clear();
  }
}

void Timings::take(const std::string& kind, const Sum& sum) {
  const bool sane = std::isfinite(sum.predicted) && sum.predicted > 0 && std::isfinite(sum.seconds) && sum.seconds > 0;
  if (sane) known_[kind] = sum;
}

void Timings::note(const std::string& kind, double predicted, double seconds) {
  const std::lock_guard lock(mutex_);
  noted_[kind].predicted += predicted;
  noted_[kind].seconds += seconds;
}

void Timings::save() const {
  const std::lock_guard lock(mutex_);
  if (noted_.empty()) return;
  std::map<std::string, Sum> all = Timings(file_.parent_path()).known_;  // other processes may have noted theirs
  for (const auto& [kind, sum] : noted_) {
    all[kind].predicted += sum.predicted;
    all[kind].seconds += sum.seconds;
  }
  Json json = Json::object();
  for (const auto& [kind, sum] : all) json[kind] = {{"predicted", sum.predicted}, {"seconds", sum.seconds}};
  try {
    write_file_atomically(file_, json.dump(1) + "\n");
  } catch (const Error&) {  // a full disk; the run goes on
  }
}

double Timings::factor(const std::string& kind) const {
  const std::lock_guard lock(mutex_);
  const auto at = known_.find(kind);
  if (at == known_.end()) return 1.0;
  return std::clamp(at->second.seconds / at->second.predicted, 1.0 / kFarthest, kFarthest);
}

std::string timing_kind(const Study& study, const Trial& trial) {
  const PolicyTraining* training = study.policies[trial.policy].training();
  return cat(kind_name(trial.kind), " ", training ? training->agent.kind : "untrained", " ", study.setup.plant.kind,
             " ", study.setup.preset);
}

void predict(const Study& study, const Timings& timings, Plan& plan) {
  std::map<std::string, double> factors;
  for (Trial& trial : plan.trials) {
    const std::string kind = timing_kind(study, trial);
    const auto [at, is_new] = factors.try_emplace(kind, 0.0);
    if (is_new) at->second = timings.factor(kind);
    trial.seconds *= at->second;
  }
}

}  // namespace gust
