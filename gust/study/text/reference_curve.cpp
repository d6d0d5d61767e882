#include "gust/study/text/reference_curve.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "gust/core/csv.h"
#include "gust/core/error.h"
#include "gust/core/text.h"

namespace gust {
namespace {

constexpr std::size_t kMostEpisodes = 200;  // of a monitor.csv that are drawn each for itself

/// A file of Stable-Baselines3, by its header: the columns that are drawn, and those that are returns of an episode.
struct Format {
  std::string_view steps, score;
  std::array<std::string_view, 2> returns;
  bool lengths = false;  ///< `steps` are those of one episode
};

constexpr Format kMonitor{"l", "r", {"r"}, true};
constexpr Format kProgress{"time/total_timesteps", "rollout/ep_rew_mean", {"rollout/ep_rew_mean", "eval/mean_reward"}};
constexpr Format kPlain{};

/// The first line of a monitor.csv is a comment in JSON.
bool is_monitor(std::string_view text) { return text.starts_with("#{"); }

const Format& format_of(const CsvTable& table, bool monitor) {
  if (monitor || (table.has("r") && table.has("l") && table.has("t"))) return kMonitor;
  return table.has(kProgress.steps) ? kProgress : kPlain;
}

std::string column(const std::string& asked, std::string_view standard, std::string_view key, std::string_view name) {
  if (!asked.empty()) return asked;
  if (!standard.empty()) return std::string(standard);
  throw Error(cat(name, ": which column? '", key, "' must name one; only monitor.csv and progress.csv of ",
                  "Stable-Baselines3 are known without"));
}

/// The means of so many neighbours that at most kMostEpisodes are left.
CurvePoints thinned(const CurvePoints& all) {
  const std::size_t block = (all.steps.size() + kMostEpisodes - 1) / kMostEpisodes;
  if (block <= 1) return all;
  CurvePoints points;
  for (std::size_t first = 0; first < all.steps.size(); first += block) {
    const std::size_t count = std::min(block, all.steps.size() - first);
    double sum = 0;
    for (std::size_t i = first; i < first + count; ++i) sum += all.score[i];
    points.steps.push_back(all.steps[first + count - 1]);
    points.score.push_back(sum / static_cast<double>(count));
  }
  return points;
}

/// Throws where a length is none, or a step lies before the one above it.
void check_steps(const std::string& place, const std::string& column, double told, bool is_length,
                 const CurvePoints& before) {
  if (is_length && !(told > 0 && std::isfinite(told)))
    throw Error(cat(place, ": '", column, "' is the length of an episode and must be above 0, got ", told));
  if (is_length) return;
  if (!(told >= 0 && std::isfinite(told)))
    throw Error(cat(place, ": '", column, "' counts steps and must be 0 or more, got ", told));
  if (!before.steps.empty() && told < before.steps.back())
    throw Error(cat(place, ": '", column, "' must not fall from row to row, got ", told, " after ", before.steps.back(),
                    "; sort the rows"));
}

}  // namespace

CurvePoints read_reference_curve(std::string_view bytes, std::string_view name, const CurveColumns& columns) {
  std::string_view text = utf8_text(bytes, name);
  const bool monitor = is_monitor(text);
  if (monitor) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  const CsvTable table(text, name);
  const Format& format = format_of(table, monitor);
  const std::string steps = column(columns.steps, format.steps, "steps", name);
  const std::string score = column(columns.score, format.score, "score", name);
  const bool is_return = std::ranges::find(format.returns, score) != format.returns.end();
  const bool is_length = format.lengths && steps == format.steps;
  CurvePoints points;
  double step = 0;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double told = table.number(i, steps), value = table.number(i, score);
    if (std::isnan(told) || std::isnan(value)) continue;
    check_steps(table.place(i), steps, told, is_length, points);
    step = is_length ? step + told : told;
    points.steps.push_back(step);
    points.score.push_back(is_return ? value / static_cast<double>(columns.horizon) : value);
  }
  if (points.steps.empty()) throw Error(cat(name, ": has no row with both '", steps, "' and '", score, "'"));
  return format.lengths ? thinned(points) : points;
}

}  // namespace gust
