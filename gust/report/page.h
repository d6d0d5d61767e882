#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "gust/stats/claim.h"
#include "gust/stats/compare.h"

namespace gust {

/// Everything that a report shows, as plain data; the study fills it in, render_page draws it.
///
/// Policies, metrics, starts, sweeps and episodes are named by their index in the page's own lists. A number that is
/// not known is NaN, an index that points nowhere kNone. Texts are UTF-8 of any content; render_page escapes them.
struct Page {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  /// A number with the ends of its interval.
  struct Estimate {
    double value = kUnknown;
    double low = kUnknown;
    double high = kUnknown;
  };

  /// Estimates along an axis. low and high are empty, or as long as value.
  struct Band {
    std::vector<double> value;
    std::vector<double> low;
    std::vector<double> high;
  };

  struct Policy {
    std::string name;
    std::string kind;  // "train ppo", "lqr", "onnx": what the reader should know it as
    std::size_t seeds = 1;
  };

  /// A score. low and high are the ends of its axis where it has natural ones; where they are not known, each panel
  /// takes its own from the data.
  struct Metric {
    std::string name;   // as in the study
    std::string title;  // as on an axis: "return / length"
    std::string help;   // one sentence
    double low = kUnknown;
    double high = kUnknown;
  };

  struct Start {
    std::string name;   // "nominal", "random"
    std::string title;  // "25 seeded starts"
  };

  /// One axis of levels: a disturbance of a site by a waveform or, where site is empty, a parameter that varies.
  struct Sweep {
    std::string name;            // in the study
    std::string site;            // "observation", "action", "dynamics"; empty when a parameter varies
    std::string waveform;        // with the options that set it apart, "sawtooth 2 Hz"; or the name of the parameter
    std::string unit;            // of the levels; may be empty
    std::vector<double> levels;  // increasing
    double nominal = kUnknown;   // the undisturbed value of a parameter
    std::string command;         // measures one cell of it again
    double possible_low = kUnknown;  // outside these, where they are known, no policy can hold the plant
    double possible_high = kUnknown;
  };

  /// One metric of one policy along a sweep, one estimate a level.
  struct Curve {
    std::size_t sweep = 0;
    std::size_t policy = 0;
    std::size_t start = 0;
    std::size_t metric = 0;
    Band band;
    std::vector<double> levels = {};  // where it was measured, if at others than the sweep's
  };

  /// The level that a policy stands. An end of the interval beyond the grid is infinite.
  struct Margin {
    std::size_t sweep = 0;
    std::size_t policy = 0;
    std::size_t start = 0;
    Estimate level;               // where censored, value is the last level of the grid
    bool censored = false;        // the score did not fall far enough on the grid: "at least"
    double nominal = kUnknown;    // the undisturbed score
    std::string text;             // as margin_text() tells it, without its unit
    std::size_t episode = kNone;  // kept episode of the policy under this disturbance
    std::string reason = {};      // why there is none (value unknown), or why it is 0
  };

  /// Policy a against b on the same episodes, along a sweep.
  struct Comparison {
    std::size_t a = 0;
    std::size_t b = 0;
    std::size_t start = 0;
    std::size_t sweep = kNone;  // kNone: undisturbed, or a grid
    std::string name;           // of the sweep, "undisturbed"
    Standing standing = Standing::undecided;
    Estimate difference;           // of the mean score over the levels
    Estimate ratio;                // of margins; a's over b's
    double ratio_most = kUnknown;  // where the ratio is known as a bound only, the greatest that it may be
    Estimate improvement;          // probability that a scores higher
    std::vector<Standing> levels;  // at each level
    std::string needed;            // what would decide; empty where it is decided
    bool few_seeds = false;        // too few of them to decide anything
  };

  struct Claim {
    std::string id;
    std::string text;
    std::string condition;  // "survival >= 0.95"
    std::string measured;   // "1.00 [0.87, 1.00]"
    Ruling verdict = Ruling::undecided;
    bool required = false;
  };

  /// Two parameters that vary together.
  struct Grid {
    struct Axis {
      std::string name;
      std::string unit;
      std::vector<double> values;
    };
    /// values[row * columns.values.size() + column].
    struct Layer {
      std::size_t policy = 0;
      std::size_t start = 0;
      std::size_t metric = 0;
      std::vector<double> values;
    };
    std::string name;
    Axis columns;
    Axis rows;
    std::vector<Layer> layers;
    std::string command;
  };

  /// How one of a policy's scores changed while it was trained; a run per training seed, and their mean.
  struct Learning {
    struct Run {
      std::string seed;
      std::vector<double> steps;
      std::vector<double> score;
    };
    std::size_t policy = 0;
    std::size_t score = 0;  // of learning_scores
    std::string source;     // whose curve or what else it is, where it is not one of this study's means: drawn in grey
    std::vector<double> steps;
    Band mean;  // along steps
    std::vector<Run> runs;
  };

  /// One scalar over an episode.
  struct Trace {
    std::string name;
    std::string unit;
    std::vector<double> values;
  };

  /// A disturbance; value k acted in control step k (at the observation site: on what the policy saw before it).
  struct Push {
    std::string site;
    Trace trace;
  };

  /// A kept episode of n control steps: states have n + 1 values, value 0 is the start; all else has n.
  struct Episode {
    std::string title;
    std::size_t policy = 0;
    std::size_t sweep = kNone;
    double level = kUnknown;
    std::size_t start = 0;
    std::string command;
    std::string plant;                                     // "cartpole" and "quadrotor" are drawn, others plotted
    std::vector<std::pair<std::string, double>> geometry;  // pole_length (half) [m], x_limit [m], action_limit [N]
    double rate = 50.0;                                    // control steps a second
    std::vector<Trace> states;                             // the true ones; cart-pole: x, x_dot, theta, theta_dot
    bool observed = false;                                 // nobody knows them: these are what the policy saw
    std::vector<Trace> reference;                          // what a moving reference asked for; like states, or empty
    std::vector<Trace> commanded;                          // actions of the policy, physical units
    std::vector<Trace> applied;                            // after disturbance and saturation
    std::vector<Push> disturbances;
    std::vector<Trace> memory = {};  // what the policy keeps from step to step
    std::vector<double> reward;
    std::size_t failed_step = kNone;  // index of the first state that is out of bounds
    std::string failure;              // "|x| > 2.4 m"
    bool touched_ground = false;
  };

  std::string name;
  std::string question;
  std::string plant;                    // "cartpole, scg-2022"
  std::vector<std::string> answer;      // sentences of the study's own, before the ones that the margins give
  std::vector<std::string> confidence;  // the same for "how sure we are"
  std::vector<std::string> warnings;    // what the reader must know first: trials that failed

  std::vector<Policy> policies;
  std::vector<Metric> metrics;  // the first is shown first
  std::vector<Start> starts;    // the first is shown first
  std::size_t survival_metric = kNone;
  std::size_t saturation_metric = kNone;  // share of saturated steps

  std::vector<Sweep> sweeps;
  std::vector<Curve> curves;
  std::vector<Grid> grids;
  std::vector<Learning> learning;
  std::vector<std::string> learning_scores = {"return / horizon"};  // as on an axis; the first is shown first

  std::size_t margin_metric = 0;
  double margin_share = 0.9;  // of the nominal score; below it the margin is spent
  std::vector<Margin> margins;
  std::vector<Comparison> comparisons;  // those of one pair stand together
  std::vector<Claim> claims;
  std::vector<Episode> episodes;

  std::string interval = "95 % bootstrap over training seeds";  // what the intervals are
  std::string run_command;                                      // "gust run study.toml"
  std::string export_command;                                   // "gust export study.gust --csv study.csv"
  std::vector<std::pair<std::string, std::string>> provenance;  // versions, seeds, machine, time; in order
  std::string study_text;

  /// The figures' data may take this many bytes; what does not fit is left out, and the page says so.
  std::size_t data_limit = 8'000'000;
};

/// One HTML file that needs nothing else: data, charts, replay and licences are inside. Throws Bug where an index
/// points outside its list or lengths contradict each other.
std::string render_page(const Page& page);

}  // namespace gust
