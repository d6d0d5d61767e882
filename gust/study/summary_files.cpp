#include <algorithm>

#include "gust/study/summary.h"
#include "gust/study/trials.h"

namespace gust {
namespace {

constexpr std::size_t kMostTraces = 60;  // about 3 MB of a page

}  // namespace

std::vector<SeedCurve> stored_curves(const Plan& plan, const Store& store) {
  std::vector<SeedCurve> curves;
  for (const Trial& trial : plan.trials) {
    if (trial.kind != Trial::Kind::kTrain) continue;
    const std::optional<StoredTrial> stored = store.load(kind_name(trial.kind), trial.id);
    if (stored) curves.push_back({trial.policy, trial.member, read_curve(stored->read(kCurveFile), trial.id)});
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
    const std::optional<StoredTrial> stored = store.load(kind_name(trial.kind), trial.id);
    if (!stored) continue;
    std::vector<Trace> traces = read_traces(stored->read(kTracesFile), trial.id);
    if (traces.size() > each) traces.resize(each);
    if (!traces.empty()) kept.push_back({trial.policy, trial.member, trial.sweep, std::move(traces)});
  }
  return kept;
}

}  // namespace gust
