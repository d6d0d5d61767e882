#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gust/eval/evaluate.h"
#include "gust/eval/metric.h"
#include "gust/study/policies/policy_source.h"

namespace gust {

/// What `gust eval` is asked, as it was typed.
struct EvalRequest {
  std::string policy;  ///< a kind of policy, or the path of a file; with a study one of its policies
  std::string output;  ///< of the ONNX file; empty: read_onnx finds it
  std::string study;   ///< result folder; the plant and all that follows but start, level and episodes are then its own
  std::string sweep;   ///< of the study; empty: undisturbed
  std::string plant;
  std::string preset = std::string(kStandardPreset);
  std::string start;                    ///< "nominal", "random", or "x,x_dot,…"; of a study one of its starts
  std::string site, waveform, level;    ///< all or none; of a study's grid two levels, "0.5,0.1"
  std::string effect = {};              ///< in place of a waveform
  std::vector<std::string> settings;    ///< key=value: of the waveform, the injection, the readings, plant or policy
  std::vector<std::string> parameters;  ///< name=value or name=xfactor: the plant that the policy meets
  std::string observe, act, units;      ///< how a file's policy sees and acts: TOML, or names with commas between
  std::string terminate = "yes";        ///< or "no"
  std::optional<std::int64_t> episodes;
  std::int64_t seed = 1;

  /// The kind of the policy, which is named or is that of the file's ending. Throws Error if there is none.
  const PolicyKind& kind() const;
  /// Whether the policy is a file, whose bytes run_eval takes.
  bool has_file() const;

  /// The kind of the disturbance, be it a waveform or an effect.
  const std::string& shape() const { return effect.empty() ? waveform : effect; }
};

/// One episode of `gust eval`. With `terminate = no` its steps are those of the whole horizon.
struct EvalRow {
  std::string seed;  ///< of a study's policy that is trained, or the file it comes from
  std::int64_t episode = 0;
  std::int64_t length = 0;
  bool failed = false;
  bool finite = true;
  double return_sum_commanded = 0;
  double return_sum_disturbed = 0;
  std::vector<double>
      metrics;                ///< in the order of the metric set; what a part of the episode decides is over its steps
  std::vector<bool> applies;  ///< which of them the plant has
  std::vector<double> initial_state, final_state;
  std::string not_finite;  ///< of the first action that was NaN or infinite: step and state; empty if there was none
};

/// The episodes, and what the user should know of the policy.
struct EvalResult {
  MetricSet metrics;        ///< those of the loop
  bool two_efforts = true;  ///< whether rewards are told under both efforts
  std::vector<EvalRow> rows = {};
  std::vector<std::string> notes = {};
};

/// Runs what was asked; policy_bytes is the content of the policy's file if it has one, and `data` the files that hold
/// its weights. Mistakes are Errors before any episode runs. Equal requests give equal bits.
EvalResult run_eval(const EvalRequest& request, std::string_view policy_bytes, const OnnxData& data = {});

/// Runs one cell of a study again, with every seed or file of the policy; a trained one is read from the study's store.
/// The metrics are the numbers that the study has or would have there.
EvalResult run_cell(const EvalRequest& request);

/// The row of an episode, without its metrics and which of them apply.
EvalRow eval_row(const Evaluation& evaluation, const EpisodeIndex& index, const Episode& episode, bool terminate);

/// How many episodes were asked for, else the standard.
std::int64_t checked_episodes(const EvalRequest& request, std::int64_t standard);

/// The rows as a JSON array of objects, quotients of means left out; numbers in the shortest form that reads back, what
/// is not finite or not applicable as null.
std::string eval_json(const EvalResult& result);

/// The rows as a table to read: mean, least and greatest of every number over the episodes, with its unit; of quotients
/// of means over the seeds. What the plant does not have is left out; what it cannot tell is said to be not applicable.
std::string eval_table(const EvalResult& result);

}  // namespace gust
