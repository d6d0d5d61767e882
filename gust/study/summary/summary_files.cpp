#include <algorithm>

#include "gust/study/summary/summary.h"
#include "gust/study/trials/trial_check.h"
#include "gust/study/trials/trials.h"

namespace gust {
namespace {

constexpr std::size_t kMostTraces = 60;  // about 3 MB of a page

std::vector<Trace> stored_traces_of(const StoredTrial& stored) {
  try {
    return read_traces(stored.read(kTracesFile), (stored.folder / kTracesFile).string());
  } catch (const Error& error) {
    throw Error(cat(error.what(), Store::remedy(stored.folder.parent_path().parent_path())));
  }
}

}  // namespace

std::vector<SeedCurve> stored_curves(const Plan& plan, const Store& store) {
  std::vector<SeedCurve> curves;
  for (const Trial& trial : plan.trials) {
    if (trial.kind != Trial::Kind::kTrain) continue;
    const std::optional<StoredTrial> stored = load_trial(plan, trial, store);
    if (stored) curves.push_back({trial.policy, trial.member, read_curve(stored->read(kCurveFile), kCurveFile)});
  }
  return curves;
}

std::vector<KeptTraces> stored_traces(const Plan& plan, const Store& store) {
  std::vector<const Trial*> trials;
  for (const Trial& trial : plan.trials) {
    if (trial.kind == Trial::Kind::kEvaluate && trial.member == 0) trials.push_back(&trial);
  }
  std::vector<KeptTraces> kept;
  const std::size_t each = std::max<std::size_t>(1, trials.empty() ? 1 : kMostTraces / trials.size());
  const std::size_t stride = std::max<std::size_t>(1, (trials.size() + kMostTraces - 1) / kMostTraces);
  for (std::size_t t = 0; t < trials.size(); t += stride) {
    const Trial& trial = *trials[t];
    const std::optional<StoredTrial> stored = load_trial(plan, trial, store);
    if (!stored) continue;
    std::vector<Trace> traces = stored_traces_of(*stored);
    if (traces.size() > each) traces.resize(each);
    if (!traces.empty()) kept.push_back({trial.policy, trial.member, trial.sweep, std::move(traces)});
  }
  return kept;
}

}  // namespace gust
