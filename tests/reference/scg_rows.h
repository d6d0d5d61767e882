#pragma once

#include <map>
#include <string>
#include <vector>

#include "gust/cli/eval.h"

namespace gust {

/// A row of eval_NAME.csv: one episode that safe-control-gym ran with its own policy; see scg_policies/README.md.
using ScgRow = std::map<std::string, std::string>;

/// The rows of a policy, "scg-2022-ppo-s1" or "scg-default-ppo-s1".
std::vector<ScgRow> read_scg_rows(const std::string& name);

/// The bytes of a file below tests/reference/scg_policies.
std::string read_scg_file(const std::string& file);

/// What `gust eval` is asked for the episode of a row.
EvalRequest request_of(const ScgRow& row);

/// Why an episode is not that of the row, by the acceptance of the README; empty if it is.
std::string difference(const ScgRow& row, const EvalRow& got);

}  // namespace gust
