#include "gust/control/loop.h"

namespace gust {

void run_episodes(Loop& loop, Policy& policy, std::span<const EpisodeStart> starts,
                  const std::function<void(std::int64_t steps)>& watch) {
  GUST_CHECK(starts.size() == loop.lanes() && policy.observations() == loop.spec().observations() &&
             policy.actions() == loop.spec().action.size());
  Matrix<double> action(policy.actions(), loop.lanes());
  for (std::size_t lane = 0; lane < starts.size(); ++lane) loop.begin(lane, starts[lane]);
  watch(0);
  for (std::int64_t k = 1; k <= loop.spec().steps; ++k) {
    policy.act(loop.observation(), loop.steps_done(), action.view());
    loop.step(action.view());
    watch(k);
  }
}

}  // namespace gust
