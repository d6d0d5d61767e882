#include "tests/reference/scg_rows.h"

#include <cmath>

#include "gust/core/text.h"
#include "gust/store/files.h"

namespace gust {
namespace {

double number(const ScgRow& row, const std::string& column) { return std::stod(row.at(column)); }

/// Fields between commas; unlike split_text it keeps an empty one at the end.
std::vector<std::string> fields_of(const std::string& line) { return split_text(line + ",", ','); }

/// The options that the waveform of a row has; the others are zeros and blanks there.
std::vector<std::string> waveform_columns(const std::string& waveform) {
  if (waveform == "step") return {"offset"};
  if (waveform == "impulse" || waveform == "scg_impulse") return {"offset", "duration", "decay"};
  return {"frequency", "polarity", "phase"};
}

double metric(const EvalRow& row, std::string_view name) {
  static const MetricSet set;
  return row.metrics[set.index(name, {"test"})];
}

}  // namespace

std::string read_scg_file(const std::string& file) {
  return read_file(cat(GUST_TEST_DATA, "/reference/scg_policies/", file));
}

std::vector<ScgRow> read_scg_rows(const std::string& name) {
  const std::vector<std::string> lines = split_text(read_scg_file(cat("eval_", name, ".csv")), '\n');
  const std::vector<std::string> columns = fields_of(lines.front());
  std::vector<ScgRow> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string> fields = fields_of(lines[i]);
    GUST_CHECK(fields.size() == columns.size());
    ScgRow row;
    for (std::size_t c = 0; c < columns.size(); ++c) row[columns[c]] = fields[c];
    rows.push_back(std::move(row));
  }
  return rows;
}

EvalRequest request_of(const ScgRow& row) {
  EvalRequest request;
  request.policy = row.at("policy") + ".onnx";
  request.plant = "cartpole";
  request.preset = row.at("preset");
  if (request.preset == "scg-2022") request.units = "normalised";
  request.start =
      cat(row.at("init_x"), ",", row.at("init_x_dot"), ",", row.at("init_theta"), ",", row.at("init_theta_dot"));
  request.terminate = row.at("terminate") == "1" ? "yes" : "no";
  const std::string& site = row.at("site");
  if (site == "params") {
    for (const char* name : {"pole_length", "pole_mass", "cart_mass"}) {
      request.parameters.push_back(cat(name, "=", row.at(name)));
    }
  } else if (site != "none") {
    request.site = site;
    request.waveform = row.at("waveform");
    request.level = row.at("level");
    request.settings.push_back("mask=" + row.at("mask"));
    for (const std::string& column : waveform_columns(request.waveform)) {
      request.settings.push_back(cat(column, "=", row.at(column)));
    }
  }
  return request;
}

std::string difference(const ScgRow& row, const EvalRow& got) {
  if (cat(got.length) != row.at("length")) return cat("length ", got.length, ", not ", row.at("length"));
  if (got.failed != (row.at("failed") == "1")) return cat("failed ", got.failed);
  std::string found;
  const auto compare = [&](const std::string& column, double value, double tolerance) {
    const double error = std::abs(value - number(row, column));
    if (!(error <= tolerance)) found += cat(column, " is off by ", error, ", more than ", tolerance, "; ");
  };
  const double spread_return = number(row, "spread_return");
  if (spread_return <= 0.01) {
    compare("return_sum_commanded", got.return_sum_commanded, 1e-6 + 10 * spread_return);
    compare("return_sum_disturbed", got.return_sum_disturbed, 1e-6 + 10 * spread_return);
  }
  const double spread_state = number(row, "spread_state");
  if (spread_state > 0.1) return found;
  const double tolerance = 1e-6 + 10 * spread_state;
  static const char* kFinal[] = {"final_x", "final_x_dot", "final_theta", "final_theta_dot"};
  for (std::size_t i = 0; i < std::size(kFinal); ++i) compare(kFinal[i], got.final_state[i], tolerance);
  compare("rmse_paper", metric(got, "rmse_paper"), tolerance);
  compare("rmse_scg", metric(got, "rmse_scg"), tolerance);
  compare("rmse_sum", metric(got, "rmse_sum"), 16 * tolerance);  // sqrt(250 steps)
  return found;
}

}  // namespace gust
