#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gust {

/// Where a learning curve of others stands in a CSV file, and in what episodes it was measured.
struct CurveColumns {
  std::string steps;         ///< empty: what Stable-Baselines3 calls it
  std::string score;         ///< the same
  std::int64_t horizon = 1;  ///< control steps in an episode
};

struct CurvePoints {
  std::vector<double> steps;
  std::vector<double> score;
};

/// Reads a learning curve. A row without a score is left out. Throws Error with file and line.
///
/// The column `score` is taken as it is; it stands beside our return / horizon. Of the files of Stable-Baselines3 gust
/// knows that: `monitor.csv` has an episode a row, whose length `l` is summed up to steps and whose return `r` is
/// divided by the horizon; of more than 200 episodes neighbours are averaged. In `progress.csv` the steps are
/// `time/total_timesteps`, and `rollout/ep_rew_mean` or `eval/mean_reward` are divided by the horizon too.
CurvePoints read_reference_curve(std::string_view bytes, std::string_view name, const CurveColumns& columns);

}  // namespace gust
