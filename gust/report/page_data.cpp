#include "gust/report/page_data.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>

#include "gust/core/error.h"
#include "gust/core/text.h"
#include "gust/report/json_writer.h"

namespace gust {
namespace {

constexpr std::size_t kBytesPerNumber = 8;     // five digits, point, sign, comma
constexpr std::size_t kPointsPerRun = 200;     // of a learning curve: more than a screen shows
constexpr std::size_t kEpisodesKeptFirst = 8;  // before the curves of lesser metrics

/// Which of n points stay when at most `most` may: evenly spread, both ends included.
std::vector<std::size_t> spread(std::size_t n, std::size_t most) {
  std::vector<std::size_t> kept;
  if (n <= most) most = n;
  for (std::size_t i = 0; i < most; ++i) kept.push_back(most == 1 ? 0 : i * (n - 1) / (most - 1));
  return kept;
}

std::vector<double> at(const std::vector<double>& values, const std::vector<std::size_t>& places) {
  std::vector<double> out;
  if (values.empty()) return out;
  for (const std::size_t place : places) out.push_back(values[place]);
  return out;
}

/// Writes finished JSON values into named lists for as long as there is room, and counts what no longer fits.
class Shelves {
 public:
  explicit Shelves(std::size_t room) : room_(room) {}

  /// Puts values in a list, all or none; where there is no room, counts them under `what`.
  void put(const std::string& list, const std::vector<std::string>& values, const std::string& what) {
    std::size_t size = 0;
    for (const auto& value : values) size += value.size() + 1;
    if (size > room_) {
      left_out_[what] += values.size();
      return;
    }
    room_ -= size;
    std::string& text = lists_[list];
    for (const auto& value : values) {
      if (!text.empty()) text += ',';
      text += value;
    }
  }

  std::string list(const std::string& name) { return "[" + lists_[name] + "]"; }
  const std::map<std::string, std::size_t>& left_out() const { return left_out_; }

 private:
  std::size_t room_;
  std::map<std::string, std::string> lists_;
  std::map<std::string, std::size_t> left_out_;
};

void write_band(JsonWriter& json, const Page::Band& band, const std::vector<std::size_t>& places) {
  json.key("v").numbers(at(band.value, places));
  if (band.low.empty()) return;
  json.key("l").numbers(at(band.low, places));
  json.key("h").numbers(at(band.high, places));
}

std::string curve_json(const Page::Curve& curve, const std::vector<std::size_t>& places) {
  JsonWriter json;
  json.open('{').key("s").index(curve.sweep).key("p").index(curve.policy).key("t").index(curve.start);
  json.key("m").index(curve.metric);
  if (!curve.levels.empty()) json.key("x").numbers(at(curve.levels, places));
  write_band(json, curve.band, places);
  return json.close('}').take();
}

void write_traces(JsonWriter& json, std::string_view name, const std::vector<Page::Trace>& traces) {
  json.key(name).open('[');
  for (const auto& trace : traces) {
    json.open('{').key("name").text(trace.name).key("unit").text(trace.unit).key("v").numbers(trace.values).close('}');
  }
  json.close(']');
}

std::string episode_json(const Page::Episode& episode, std::size_t number) {
  JsonWriter json;
  json.open('{').key("number").index(number).key("title").text(episode.title).key("p").index(episode.policy);
  if (episode.sweep != Page::kNone) json.key("s").index(episode.sweep);
  json.key("level").number(episode.level).key("t").index(episode.start).key("command").text(episode.command);
  json.key("plant").text(episode.plant).key("rate").number(episode.rate).key("geometry").open('{');
  for (const auto& [name, value] : episode.geometry) json.key(name).number(value);
  json.close('}');
  write_traces(json, "states", episode.states);
  write_traces(json, "reference", episode.reference);
  write_traces(json, "commanded", episode.commanded);
  write_traces(json, "applied", episode.applied);
  if (!episode.memory.empty()) write_traces(json, "memory", episode.memory);
  json.key("disturbances").open('[');
  for (const auto& push : episode.disturbances) {
    json.open('{').key("site").text(push.site).key("name").text(push.trace.name).key("unit").text(push.trace.unit);
    json.key("v").numbers(push.trace.values).close('}');
  }
  json.close(']').key("reward").numbers(episode.reward);
  if (episode.failed_step != Page::kNone) json.key("failed").index(episode.failed_step);
  if (episode.observed) json.key("observed").index(1);
  if (episode.touched_ground) json.key("ground").index(1);
  return json.key("failure").text(episode.failure).close('}').take();
}

std::string learning_json(const Page::Learning& learning, std::size_t number) {
  const auto places = spread(learning.steps.size(), kPointsPerRun);
  JsonWriter json;
  json.open('{').key("number").index(number).key("p").index(learning.policy).key("m").index(learning.score);
  json.key("source").text(learning.source);
  json.key("x").numbers(at(learning.steps, places));
  write_band(json, learning.mean, places);
  return json.close('}').take();
}

std::string run_json(const Page::Learning::Run& run, std::size_t number) {
  const auto places = spread(run.steps.size(), kPointsPerRun);
  JsonWriter json;
  json.open('{').key("of").index(number).key("seed").text(run.seed);
  return json.key("x").numbers(at(run.steps, places)).key("v").numbers(at(run.score, places)).close('}').take();
}

std::string layer_json(const Page::Grid::Layer& layer, std::size_t grid) {
  JsonWriter json;
  json.open('{').key("g").index(grid).key("p").index(layer.policy).key("t").index(layer.start);
  return json.key("m").index(layer.metric).key("v").numbers(layer.values).close('}').take();
}

/// Curves that the page cannot do without: the first metric, survival, saturation.
bool leads(const Page& page, std::size_t metric) {
  return metric == 0 || metric == page.survival_metric || metric == page.saturation_metric;
}

/// The most levels a curve may keep so that the leading curves take at most two thirds of the room.
std::size_t level_cap(const Page& page, std::size_t limit) {
  std::size_t longest = 2;
  for (const auto& sweep : page.sweeps) longest = std::max(longest, sweep.levels.size());
  for (const auto& curve : page.curves) longest = std::max(longest, curve.band.value.size());
  const auto bytes = [&](std::size_t cap) {
    std::size_t numbers = 0;
    for (const auto& curve : page.curves) {
      if (!leads(page, curve.metric)) continue;
      numbers +=
          std::min(cap, curve.band.value.size()) * ((curve.levels.empty() ? 0 : 1) + (curve.band.low.empty() ? 1 : 3));
    }
    return numbers * kBytesPerNumber;
  };
  while (longest > 2 && bytes(longest) > limit / 3 * 2) longest = std::max<std::size_t>(2, longest * 3 / 4);
  return longest;
}

void put_curves(const Page& page, Shelves& shelves, std::size_t cap, bool leading) {
  for (std::size_t metric = 0; metric < page.metrics.size(); ++metric) {
    if (leads(page, metric) != leading) continue;
    std::vector<std::string> values;
    for (const auto& curve : page.curves) {
      if (curve.metric == metric) values.push_back(curve_json(curve, spread(curve.band.value.size(), cap)));
    }
    shelves.put("curves", values, cat("curves of ", page.metrics[metric].name));
  }
}

void put_layers(const Page& page, Shelves& shelves, bool leading) {
  for (std::size_t grid = 0; grid < page.grids.size(); ++grid) {
    for (const auto& layer : page.grids[grid].layers) {
      if (leads(page, layer.metric) == leading) shelves.put("layers", {layer_json(layer, grid)}, "heat maps");
    }
  }
}

void put_episodes(const Page& page, Shelves& shelves, std::size_t from, std::size_t to) {
  for (std::size_t i = from; i < std::min(to, page.episodes.size()); ++i) {
    shelves.put("episodes", {episode_json(page.episodes[i], i)}, "replays");
  }
}

/// What the reader would miss most goes first.
void fill(const Page& page, Shelves& shelves, std::size_t cap) {
  put_curves(page, shelves, cap, true);
  for (std::size_t i = 0; i < page.learning.size(); ++i) {
    shelves.put("learning", {learning_json(page.learning[i], i)}, "learning curves");
  }
  put_layers(page, shelves, true);
  put_episodes(page, shelves, 0, kEpisodesKeptFirst);
  put_curves(page, shelves, cap, false);
  put_layers(page, shelves, false);
  put_episodes(page, shelves, kEpisodesKeptFirst, page.episodes.size());
  for (std::size_t i = 0; i < page.learning.size(); ++i) {
    for (const auto& run : page.learning[i].runs) {
      shelves.put("runs", {run_json(run, i)}, "learning curves of single seeds");
    }
  }
}

void write_names(JsonWriter& json, const Page& page, const std::vector<std::size_t>& places) {
  json.key("policies").open('[');
  for (std::size_t p = 0; p < page.policies.size(); ++p) {
    const auto& policy = page.policies[p];
    json.open('{')
        .key("name")
        .text(policy.name)
        .key("kind")
        .text(policy.kind)
        .key("seeds")
        .index(policy.seeds)
        .key("place")
        .index(places[p])
        .close('}');
  }
  json.close(']').key("metrics").open('[');
  for (const auto& metric : page.metrics) {
    json.open('{').key("name").text(metric.name).key("title").text(metric.title).key("help").text(metric.help);
    json.key("low").number(metric.low).key("high").number(metric.high).close('}');
  }
  json.close(']').key("starts").open('[');
  for (const auto& start : page.starts) {
    json.open('{').key("name").text(start.name).key("title").text(start.title).close('}');
  }
  json.close(']');
}

void write_sweeps(JsonWriter& json, const Page& page, std::size_t cap) {
  json.key("sweeps").open('[');
  for (const auto& sweep : page.sweeps) {
    json.open('{').key("name").text(sweep.name).key("site").text(sweep.site).key("waveform").text(sweep.waveform);
    json.key("unit").text(sweep.unit).key("levels").numbers(at(sweep.levels, spread(sweep.levels.size(), cap)));
    json.key("possible").numbers(std::array{sweep.possible_low, sweep.possible_high});
    json.key("nominal").number(sweep.nominal).key("command").text(sweep.command).close('}');
  }
  json.close(']');
}

void write_grids(JsonWriter& json, const Page& page) {
  const auto axis = [&](std::string_view key, const Page::Grid::Axis& axis) {
    json.key(key).open('{').key("name").text(axis.name).key("unit").text(axis.unit);
    json.key("v").numbers(axis.values).close('}');
  };
  json.key("grids").open('[');
  for (const auto& grid : page.grids) {
    json.open('{').key("name").text(grid.name).key("command").text(grid.command);
    axis("columns", grid.columns);
    axis("rows", grid.rows);
    json.close('}');
  }
  json.close(']');
}

void write_margins(JsonWriter& json, const Page& page) {
  json.key("margins").open('[');
  for (const auto& margin : page.margins) {
    json.open('{').key("s").index(margin.sweep).key("p").index(margin.policy).key("t").index(margin.start);
    json.key("v").number(margin.level.value).key("l").number(margin.level.low).key("h").number(margin.level.high);
    json.key("censored").flag(margin.censored).key("nominal").number(margin.nominal).close('}');
  }
  json.close(']').key("marginShare").number(page.margin_share);
  if (page.margin_metric < page.metrics.size()) json.key("marginMetric").index(page.margin_metric);
}

void write_rest(JsonWriter& json, const Page& page) {
  json.key("name").text(page.name).key("interval").text(page.interval);
  json.key("learningScores").open('[');
  for (const auto& score : page.learning_scores) json.text(score);
  json.close(']');
  json.key("runCommand").text(page.run_command).key("exportCommand").text(page.export_command);
  if (page.survival_metric != Page::kNone) json.key("survival").index(page.survival_metric);
  if (page.saturation_metric != Page::kNone) json.key("saturation").index(page.saturation_metric);
}

std::vector<std::string> left_out(const Page& page, const Shelves& shelves, std::size_t cap) {
  std::vector<std::string> out;
  std::size_t longest = 0;
  for (const auto& sweep : page.sweeps) longest = std::max(longest, sweep.levels.size());
  if (longest > cap) out.push_back(cat("Curves show at most ", cap, " of up to ", longest, " levels."));
  std::vector<std::string> parts;
  for (const auto& [what, count] : shelves.left_out()) {
    if (count > 0) parts.push_back(cat(what, " (", count, ")"));
  }
  if (!parts.empty())
    out.push_back(cat("Left out, to keep this page small: ", join(parts, ", "), "; the exported data hold all."));
  return out;
}

}  // namespace

PageData page_data(const Page& page) {
  DataShare alone{page.data_limit, std::vector<std::size_t>(page.policies.size())};
  std::iota(alone.places.begin(), alone.places.end(), std::size_t{0});
  return page_data(page, alone);
}

PageData page_data(const Page& page, const DataShare& share) {
  GUST_CHECK(share.places.size() == page.policies.size());
  const std::size_t cap = level_cap(page, share.limit);
  Shelves shelves(share.limit);
  fill(page, shelves, cap);
  JsonWriter json;
  json.open('{');
  write_rest(json, page);
  write_names(json, page, share.places);
  write_sweeps(json, page, cap);
  write_grids(json, page);
  write_margins(json, page);
  for (const std::string_view name : {"curves", "learning", "runs", "layers", "episodes"}) {
    json.key(name).raw(shelves.list(std::string(name)));
  }
  json.close('}');
  return {json.take(), left_out(page, shelves, cap)};
}

}  // namespace gust
