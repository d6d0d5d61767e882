#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gust/eval/evaluate.h"
#include "gust/eval/metric.h"
#include "gust/study/setup.h"

namespace gust {

/// What `gust eval` is asked, as it was typed.
struct EvalRequest {
  std::string policy;  ///< lqr, zero, pd, or the path of an ONNX file
  std::string plant;
  std::string preset = std::string(kStandardPreset);
  std::string start = "nominal";        ///< or "random", or "x,x_dot,…"
  std::string site, waveform, level;    ///< all or none
  std::vector<std::string> settings;    ///< key=value: of the waveform, the injection, the readings or the plant
  std::vector<std::string> parameters;  ///< name=value or name=xfactor: the plant that the policy meets
  std::string terminate = "yes";        ///< or "no"
  std::optional<std::int64_t> episodes;
  std::int64_t seed = 1;

  /// Whether the policy is a file, whose bytes run_eval takes.
  bool has_file() const { return policy.ends_with(".onnx"); }
};

/// One episode of `gust eval`. With `terminate = no` its steps are those of the whole horizon.
struct EvalRow {
  std::int64_t episode = 0;
  std::int64_t length = 0;
  bool failed = false;
  bool finite = true;
  double return_sum_commanded = 0;
  double return_sum_disturbed = 0;
  std::vector<double> metrics;  ///< in the order of MetricSet; what a part of the episode decides is over its steps
  std::vector<double> initial_state, final_state;
};

/// Runs what was asked; policy_bytes is the content of the policy's file if it has one. Mistakes are Errors before any
/// episode runs. Equal requests give equal bits.
std::vector<EvalRow> run_eval(const EvalRequest& request, std::string_view policy_bytes);

/// The rows as a JSON array of objects; numbers in the shortest form that reads back, what is no finite number as null.
std::string eval_json(const std::vector<EvalRow>& rows);

/// The rows as a table to read: mean, least and greatest of every number over the episodes.
std::string eval_table(const std::vector<EvalRow>& rows);

}  // namespace gust
