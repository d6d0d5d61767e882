#include "tests/page/fixture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "gust/core/error.h"
#include "gust/core/rng.h"
#include "gust/stats/margin.h"

namespace gust {
namespace {

struct Wave {
  const char* name;
  double strength;  // how much of it a policy bears, against a step
};

constexpr std::array kWaves = {Wave{"white noise", 1.5}, Wave{"step", 1.0}, Wave{"impulse", 5.0},
                               Wave{"sawtooth 1 Hz", 1.2}, Wave{"triangle 1 Hz", 1.3}};
constexpr std::array kSites = {"observation", "action", "dynamics"};
constexpr std::array kUnits = {"", "N", "N"};
constexpr std::array kReach = {0.12, 10.0, 0.5};  // the level of a step at which a score has lost half
constexpr std::size_t kLevels = 11;

double logistic(double x) { return 1 / (1 + std::exp(-x)); }

/// Where policy p loses half its score on a sweep, in levels of the sweep.
double half_level(std::size_t policy, std::size_t site, std::size_t wave) {
  const double wobble = Rng(7).split(policy * 100 + site * 10 + wave).uniform(0);
  return kReach[site] * kWaves[wave].strength * (0.75 + 0.5 * wobble + (policy == 1 ? 0.15 : 0));
}

/// Score of a policy at a share of its half level; metric 2 is an error and grows.
double score(std::size_t metric, double share) {
  const double kept = logistic(9 * (1 - share)) / logistic(9);
  if (metric == 2) return 0.06 + 14 * (1 - kept) * share;
  if (metric == 3) return kept > 0.9 ? 1 : std::round(25 * kept) / 25;
  if (metric == 4) return std::min(1.0, 0.02 + 0.6 * share * share);
  return (metric == 1 ? 0.97 : 0.98) * (metric == 1 ? kept : 0.25 + 0.75 * kept);
}

void name_things(Page& page) {
  page.name = "cartpole-first-look";
  page.question =
      "How much noise, step, impulse, sawtooth and triangle do a linear regulator and three trained policies stand on "
      "a "
      "cart-pole? (Invented data of a test.)";
  page.plant = "cartpole, scg-2022";
  page.policies = {
      {"lqr", "lqr", 1}, {"ppo", "train ppo", 10}, {"ppo-modern", "train ppo, modern", 3}, {"theirs", "onnx", 1}};
  page.metrics = {{"anr", "return / length", "Mean reward a step until the episode ends.", 0, 1},
                  {"anr_h", "return / 250", "Return over the whole horizon; early ends cost.", 0, 1},
                  {"rmse_paper", "RMSE", "Root mean square of the state error over 250 steps, never terminated.",
                   Page::kUnknown, Page::kUnknown},
                  {"survival", "survival", "Share of episodes without a failure.", 0, 1},
                  {"saturated", "saturated steps", "Share of steps with a saturated action.", 0, 1}};
  page.starts = {{"nominal", "the preset's one fixed start"}, {"random", "25 seeded starts"}};
  page.survival_metric = 3;
  page.saturation_metric = 4;
  page.interval = "95 % stratified bootstrap over training seeds, 2000 resamples";
  page.run_command = "gust run studies/demo.toml";
  page.export_command = "gust export cartpole-first-look.gust --csv cartpole-first-look.csv";
  page.provenance = {{"gust", "0.1.0"},
                     {"study", "studies/demo.toml"},
                     {"root seed", "20231"},
                     {"training seeds", "1, 2, 3"},
                     {"made", "2026-01-31 12:00 UTC, 41 s"},
                     {"machine", "2 cores, x86-64-v3"},
                     {"trials", "64 of 64 done"}};
  page.study_text =
      "schema = 1\nname   = \"cartpole-first-look\"\nseed   = 20231\nplant  = { kind = \"cartpole\", preset = "
      "\"scg-2022\" }\n\n"
      "[[sweep]]\nname     = \"action step\"\nsite     = \"action\"\nwaveform = { kind = \"step\", offset = 2 "
      "}\nlevels   = "
      "{ from = 0, to = 15, count = 11 }\n";
}

void add_curves(Page& page, std::size_t sweep, double (*half)(std::size_t, std::size_t, std::size_t), std::size_t site,
                std::size_t wave) {
  for (std::size_t start = 0; start < page.starts.size(); ++start) {
    for (std::size_t p = 0; p < page.policies.size(); ++p) {
      const double middle = half(p, site, wave) * (start == 0 ? 1 : 0.9);
      for (std::size_t metric = 0; metric < page.metrics.size(); ++metric) {
        Page::Curve curve{sweep, p, start, metric, {}};
        for (const double level : page.sweeps[sweep].levels) {
          const double value = score(metric, level / middle);
          const double spread =
              page.policies[p].seeds > 1 ? 0.02 + 0.3 * std::abs(value - score(metric, level / middle * 1.1)) : 0;
          curve.band.value.push_back(value);
          if (metric == 4) continue;
          curve.band.low.push_back(std::max(0.0, value - spread));
          curve.band.high.push_back(metric == 2 ? value + spread : std::min(1.0, value + spread));
        }
        page.curves.push_back(std::move(curve));
      }
    }
  }
}

void add_sites(Page& page) {
  for (std::size_t wave = 0; wave < kWaves.size(); ++wave) {
    for (std::size_t site = 0; site < kSites.size(); ++site) {
      Page::Sweep sweep{cat(kSites[site], " ", kWaves[wave].name),
                        kSites[site],
                        kWaves[wave].name,
                        kUnits[site],
                        {},
                        Page::kUnknown,
                        ""};
      const double end = 1.5 * kReach[site] * kWaves[wave].strength;
      for (std::size_t i = 0; i < kLevels; ++i) sweep.levels.push_back(end * static_cast<double>(i) / (kLevels - 1));
      sweep.command = cat("gust eval lqr --study cartpole-first-look.gust --sweep '", sweep.name, "' --level ",
                          sweep.levels[5], " --start nominal");
      page.sweeps.push_back(std::move(sweep));
      const std::size_t index = page.sweeps.size() - 1;
      add_curves(page, index, half_level, site, wave);
      for (std::size_t start = 0; start < 2; ++start) {
        for (std::size_t p = 0; p < page.policies.size(); ++p) {
          const double level = half_level(p, site, wave) * (start == 0 ? 0.79 : 0.71);
          const double spread = page.policies[p].seeds > 1 ? 0.08 * level : 0;
          const bool censored = wave == 2 && site < 2 && p != 3;
          page.margins.push_back({index,
                                  p,
                                  start,
                                  {censored ? end : level, censored ? end : level - spread, level + spread},
                                  censored,
                                  0.98,
                                  {}});
          if (censored) page.margins.back().level.high = std::numeric_limits<double>::infinity();
        }
      }
    }
  }
}

/// Gives the margins their texts.
void tell_margins(Page& page) {
  for (Page::Margin& margin : page.margins) {
    const Interval level{.estimate = margin.level.value, .low = margin.level.low, .high = margin.level.high};
    margin.text = margin_text({.level = level, .censored = margin.censored, .last_level = margin.level.value});
  }
}

double length_half(std::size_t policy, std::size_t, std::size_t) { return 2.2 + 0.4 * static_cast<double>(policy); }

void add_parameters(Page& page) {
  page.sweeps.push_back({"pole length",
                         "",
                         "pole_length",
                         "m",
                         {0.125, 0.25, 0.5, 0.75, 1, 2, 3},
                         0.5,
                         "gust eval lqr --param pole_length=1 --json"});
  add_curves(page, page.sweeps.size() - 1, length_half, 0, 0);
  page.sweeps.push_back({"cart mass", "", "cart_mass", "kg", {0.5, 1, 1.5, 2, 3, 4}, 1.0, ""});
  add_curves(page, page.sweeps.size() - 1, length_half, 0, 0);
  Page::Grid grid{"length and mass", {"pole_length", "m", {}}, {"pole_mass", "kg", {}}, {}, ""};
  for (int i = 0; i < 12; ++i) {
    grid.columns.values.push_back(0.1 + 0.25 * i);
    grid.rows.values.push_back(0.02 + 0.18 * i);
  }
  for (std::size_t p = 0; p < 3; ++p) {
    Page::Grid::Layer layer{p, 0, 0, {}};
    for (const double mass : grid.rows.values) {
      for (const double length : grid.columns.values) {
        layer.values.push_back(score(0, (length / 3 + mass / 2.5) / (0.8 + 0.15 * static_cast<double>(p))));
      }
    }
    grid.layers.push_back(std::move(layer));
  }
  page.grids.push_back(std::move(grid));
}

void add_learning(Page& page) {
  for (std::size_t p = 1; p < 3; ++p) {
    Page::Learning learning{.policy = p, .source = "", .steps = {}, .mean = {}, .runs = {}};
    for (int k = 0; k <= 50; ++k) learning.steps.push_back(20000.0 * k);
    const std::size_t seeds = page.policies[p].seeds;
    std::vector<double> sum(learning.steps.size(), 0);
    for (std::size_t seed = 0; seed < seeds; ++seed) {
      Page::Learning::Run run{cat(seed + 1), learning.steps, {}};
      const double middle = 45000 + 9000 * static_cast<double>(seed % 4);
      const Rng noise = Rng(3).split(p * 50 + seed);
      for (std::size_t k = 0; k < run.steps.size(); ++k) {
        run.score.push_back(std::clamp(
            0.98 * logistic((run.steps[k] - middle) / 12000) - 0.06 * noise.uniform(k) * noise.uniform(k + 99), 0.0,
            1.0));
        sum[k] += run.score.back() / static_cast<double>(seeds);
      }
      learning.runs.push_back(std::move(run));
    }
    for (const double mean : sum) {
      learning.mean.value.push_back(mean);
      learning.mean.low.push_back(std::max(0.0, mean - 0.03));
      learning.mean.high.push_back(std::min(1.0, mean + 0.02));
    }
    page.learning.push_back(std::move(learning));
  }
  page.learning_scores = {"return / horizon", "RMSE"};
  Page::Learning error = page.learning[0];
  error.score = 1;
  for (auto* values : {&error.mean.value, &error.mean.low, &error.mean.high, &error.runs[0].score}) {
    for (double& value : *values) value = 2.0 * (1.0 - value);
  }
  std::swap(error.mean.low, error.mean.high);
  error.runs.resize(1);
  page.learning.push_back(std::move(error));
  Page::Learning other{
      .policy = 1, .source = "reference implementation", .steps = page.learning[0].steps, .mean = {}, .runs = {}};
  for (const double step : other.steps) other.mean.value.push_back(0.975 * logistic((step - 70000) / 15000));
  page.learning.push_back(std::move(other));
}

/// A cart-pole under a linear feedback, as far as a replay needs one.
struct Simulation {
  std::array<double, 4> state = {0, 0, 0.05, 0};

  void advance(double force, double fx) {
    constexpr double m = 0.1, big = 1.0, l = 0.5, g = 9.8, inertia = 0.00835417;
    for (int i = 0; i < 20; ++i) {
      const double s = std::sin(state[2]), c = std::cos(state[2]);
      const double a = big + m, b = m * l * c, d = inertia + m * l * l;
      const double p = force + fx + m * l * s * state[3] * state[3], q = m * g * l * s + fx * l * c;
      const double det = a * d - b * b;
      state[1] += 0.001 * (p * d - b * q) / det;
      state[3] += 0.001 * (a * q - b * p) / det;
      state[0] += 0.001 * state[1];
      state[2] += 0.001 * state[3];
    }
  }
};

/// The push at a step of a site, where it is the one disturbed.
double push(std::size_t site, std::size_t disturbed, int k, double level) {
  if (site != disturbed) return 0;
  if (site == 0) return level * (2 * std::fmod(k / 50.0, 1.0) - 1);
  return k >= 2 ? level : 0;
}

Page::Episode episode(std::size_t policy, std::size_t disturbed, double level) {
  Page::Episode out;
  out.policy = policy;
  out.sweep = disturbed == 0 ? 9 : 3 + disturbed;
  out.level = level;
  out.plant = "cartpole";
  out.geometry = {{"pole_length", 0.5}, {"x_limit", 2.4}, {"action_limit", 10}};
  out.states = {{"x", "m", {}}, {"x_dot", "m/s", {}}, {"theta", "rad", {}}, {"theta_dot", "rad/s", {}}};
  out.commanded = {{"force", "N", {}}};
  out.applied = {{"force", "N", {}}};
  if (disturbed == 0) out.disturbances = {{"observation", {"x", "m", {}}}, {"observation", {"theta", "rad", {}}}};
  if (disturbed == 1) out.disturbances = {{"action", {"force", "N", {}}}};
  if (disturbed == 2) out.disturbances = {{"dynamics", {"fx", "N", {}}}};
  Simulation simulation;
  const double gain = policy == 0 ? 1.0 : 1.3;
  for (int k = 0; k <= 250; ++k) {
    for (std::size_t i = 0; i < 4; ++i) out.states[i].values.push_back(simulation.state[i]);
    if (std::abs(simulation.state[0]) > 2.4 || std::abs(simulation.state[2]) > std::numbers::pi / 2) {
      out.failed_step = static_cast<std::size_t>(k);
      out.failure = std::abs(simulation.state[0]) > 2.4 ? "|x| > 2.4 m" : "|theta| > 90°";
    }
    if (k == 250 || out.failed_step != Page::kNone) break;
    const auto& s = simulation.state;
    const double seen = push(0, disturbed, k, level);
    const double command = gain * (1.0 * (s[0] + seen) + 2.2 * s[1] + 34 * (s[2] + seen) + 8 * s[3]);
    const double noisy = command + push(1, disturbed, k, level);
    const double applied = std::clamp(noisy, -10.0, 10.0);
    for (auto& one : out.disturbances) one.trace.values.push_back(push(disturbed, disturbed, k, level));
    out.commanded[0].values.push_back(command);
    out.applied[0].values.push_back(applied);
    simulation.advance(applied, push(2, disturbed, k, level));
    out.reward.push_back(std::exp(-5 * s[0] * s[0] - s[2] * s[2]));
  }
  out.title = cat(policy == 0 ? "lqr" : "ppo, seed 2", ": ", kSites[disturbed],
                  disturbed == 0 ? " sawtooth " : " step ", level, " ", kUnits[disturbed]);
  out.command = cat("gust eval ", policy == 0 ? "lqr" : "ppo", " --study cartpole-first-look.gust --sweep '",
                    kSites[disturbed], disturbed == 0 ? " sawtooth" : " step", "' --level ", level, " --start nominal");
  return out;
}

}  // namespace

Page demo_page() {
  Page page;
  name_things(page);
  add_sites(page);
  add_parameters(page);
  add_learning(page);
  page.episodes = {episode(0, 2, 0.4), episode(0, 2, 1.6), episode(1, 2, 1.6),
                   episode(0, 1, 4),   episode(1, 1, 9.5), episode(1, 0, 0.15)};
  tell_margins(page);
  for (Page::Margin& margin : page.margins) {
    for (std::size_t e = page.episodes.size(); e-- > 0;) {
      if (page.episodes[e].policy == margin.policy && page.episodes[e].sweep == margin.sweep) margin.episode = e;
    }
  }
  page.claims = {
      {"step-2N", "PPO survives an action step of 2 N.", "survival >= 0.95", "1.00 [0.87, 1.00]", Ruling::holds, true},
      {"beats-lqr", "PPO stands a larger dynamics step than LQR.", "margin(ppo) > margin(lqr)",
       "0.44 [0.40, 0.48] against 0.43", Ruling::undecided, false},
      {"noise", "PPO keeps nine tenths of its score under observation noise of 0.3.", "anr >= 0.88",
       "0.41 [0.36, 0.47]", Ruling::fails, false}};
  return page;
}

Page single_page() {
  Page page = demo_page();
  const auto other = [](const auto& item) { return item.policy != 0; };
  page.policies.resize(1);
  std::erase_if(page.curves, other);
  std::erase_if(page.margins, other);
  for (auto& margin : page.margins) margin.episode = 0;
  std::erase_if(page.episodes, other);
  for (auto& grid : page.grids) std::erase_if(grid.layers, other);
  page.learning.clear();
  return page;
}

Page hostile_page() {
  Page page = demo_page();
  const std::string bad =
      "</script><script>window.hacked=1</script><img src=x onerror=\"window.hacked=1\"> {{data}} '\"& \xE2\x80\xAE txt "
      "\xFF [x](y)";
  page.name = page.question = page.plant = page.interval = page.run_command = page.study_text = bad;
  page.learning_scores = {bad, bad};
  page.warnings = page.answer = page.confidence = {bad};
  page.provenance = {{bad, bad}};
  for (auto& policy : page.policies) policy = {cat(bad, &policy - page.policies.data()), bad, policy.seeds};
  page.policies[1].name = "__proto__";
  for (auto& metric : page.metrics) metric.title = metric.help = bad;
  for (auto& start : page.starts) start.title = bad;
  for (auto& sweep : page.sweeps) sweep.name = sweep.waveform = sweep.command = sweep.unit = bad;
  for (std::size_t i = 0; i < page.sweeps.size(); ++i) page.sweeps[i].waveform += cat(i / 3);
  for (auto& sweep : page.sweeps)
    if (sweep.site == "action") sweep.site = bad;
  for (auto& grid : page.grids) grid.name = grid.columns.name = grid.rows.unit = bad;
  for (auto& learning : page.learning) learning.source = learning.source.empty() ? "" : bad;
  for (auto& claim : page.claims) claim.id = claim.text = claim.condition = claim.measured = bad;
  for (auto& one : page.episodes) {
    one.title = one.command = one.failure = bad;
    one.states[0].unit = one.applied[0].name = bad;
    for (auto& push : one.disturbances) push.site = push.site == "action" ? bad : push.site;
  }
  page.episodes[1].plant = "constructor";
  auto& runaway = page.episodes[2].states;
  runaway[0].values[5] = 1e300;
  runaway[0].values[6] = runaway[2].values[7] = Page::kUnknown;
  runaway[0].values[8] = runaway[2].values[9] = std::numeric_limits<double>::infinity();
  page.episodes[2].applied[0].values[5] = -std::numeric_limits<double>::infinity();
  page.curves[0].band.value[3] = page.curves[1].band.low[2] = std::numeric_limits<double>::infinity();
  page.curves[0].band.value[4] = page.learning[0].mean.value[7] = page.grids[0].layers[0].values[5] = Page::kUnknown;
  return page;
}

Page large_page() {
  Page page;
  name_things(page);
  page.policies.clear();
  for (int p = 0; p < 20; ++p) page.policies.push_back({cat("policy ", p), "onnx", 3});
  for (int m = 5; m < 12; ++m) page.metrics.push_back({cat("metric_", m), cat("metric ", m), "", 0, 1});
  for (std::size_t site = 0; site < 3; ++site) {
    for (int wave = 0; wave < 25; ++wave) {
      if (page.sweeps.size() == 25) break;
      page.sweeps.push_back({cat("sweep ", page.sweeps.size()),
                             kSites[site],
                             cat("sine ", wave % 9, " Hz"),
                             kUnits[site],
                             {},
                             Page::kUnknown,
                             ""});
      for (int i = 0; i < 100; ++i) page.sweeps.back().levels.push_back(kReach[site] * 0.02 * i);
      if (wave == 8) break;
    }
  }
  const Rng noise(1);
  for (std::size_t sweep = 0; sweep < page.sweeps.size(); ++sweep) {
    const auto& levels = page.sweeps[sweep].levels;
    for (std::size_t p = 0; p < 20; ++p) {
      for (std::size_t start = 0; start < 2; ++start) {
        page.margins.push_back({sweep, p, start, {levels[50], levels[45], levels[55]}, false, 0.98, {}});
        for (std::size_t metric = 0; metric < page.metrics.size(); ++metric) {
          Page::Curve curve{sweep, p, start, metric, {}};
          for (std::size_t i = 0; i < levels.size(); ++i) {
            const double value = 0.9 * score(0, 0.02 * static_cast<double>(i)) + 0.05 * noise.split(p).uniform(i);
            curve.band.value.push_back(value);
            curve.band.low.push_back(value - 0.03 * noise.split(p).uniform(i + 1000));
            curve.band.high.push_back(value + 0.03 * noise.split(p).uniform(i + 2000));
          }
          page.curves.push_back(std::move(curve));
        }
      }
    }
  }
  tell_margins(page);
  return page;
}

}  // namespace gust
