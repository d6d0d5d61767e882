#include "gust/study/timings.h"

#include <nlohmann/json.hpp>

#include "gust/study/files.h"

namespace gust {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFile = "timings.json";

}  // namespace

Timings::Timings(const std::filesystem::path& store) : file_(store / kFile) {
  std::error_code error;
  if (!std::filesystem::exists(file_, error)) return;
  try {
    const Json json = Json::parse(read_file(file_));
    for (const auto& [kind, sum] : json.items())
      known_[kind] = {sum.at("predicted").get<double>(), sum.at("seconds").get<double>()};
  } catch (const std::exception&) {  // predictions are worth no trouble
    known_.clear();
  }
}

void Timings::note(const std::string& kind, double predicted, double seconds) {
  const std::lock_guard lock(mutex_);
  noted_[kind].predicted += predicted;
  noted_[kind].seconds += seconds;
}

void Timings::save() const {
  const std::lock_guard lock(mutex_);
  if (noted_.empty()) return;
  std::map<std::string, Sum> all = known_;
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
  return at == known_.end() || !(at->second.predicted > 0) ? 1.0 : at->second.seconds / at->second.predicted;
}

std::string timing_kind(const Study& study, const Trial& trial) {
  const StudyPolicy& policy = study.policies[trial.policy];
  const bool trained = policy.kind == StudyPolicy::Kind::kTrain;
  return cat(kind_name(trial.kind), " ", trained ? policy.agent.kind : "untrained", " ", study.setup.plant.kind, " ",
             study.setup.preset);
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
