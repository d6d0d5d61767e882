#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "gust/cli/eval.h"
#include "gust/core/text.h"

namespace gust {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kColumns = 80;

std::string json_number(double number) { return std::isfinite(number) ? cat(number) : "null"; }

std::string json_numbers(const std::vector<double>& numbers) {
  std::vector<std::string> parts;
  for (const double number : numbers) parts.push_back(json_number(number));
  return cat("[", join(parts, ", "), "]");
}

std::string json_row(const EvalRow& row, const MetricSet& metrics) {
  std::vector<std::string> parts;
  const auto add = [&](std::string_view name, const std::string& value) {
    parts.push_back(cat("\"", name, "\": ", value));
  };
  if (!row.seed.empty()) add("seed", Json(row.seed).dump(-1, ' ', false, Json::error_handler_t::replace));
  add("episode", cat(row.episode));
  add(metrics.name_of(MetricRole::length), cat(row.length));
  add("failed", cat(row.failed));
  add("finite", cat(row.finite));
  add("return_sum_commanded", json_number(row.return_sum_commanded));
  add("return_sum_disturbed", json_number(row.return_sum_disturbed));
  for (const std::size_t i : metrics.stored()) {
    if (metrics[i].traits().role != MetricRole::length)
      add(metrics.name(i), json_number(row.metrics[i]));  // it is there, as a whole number
  }
  for (const std::string& name : metrics.names_not_applicable()) add(name, "null");
  add("initial_state", json_numbers(row.initial_state));
  add("final_state", json_numbers(row.final_state));
  return cat("  {", join(parts, ", "), "}");
}

template <class NumberOf>
std::string table_line(const std::string& name, std::string_view unit, const std::vector<EvalRow>& rows,
                       NumberOf&& number_of) {
  double sum = 0;
  double least = number_of(rows.front());
  double greatest = least;
  for (const EvalRow& row : rows) {
    const double number = number_of(row);
    sum += number;
    least = std::fmin(least, number);  // of those that are not NaN
    greatest = std::fmax(greatest, number);
  }
  const double mean = sum / static_cast<double>(rows.size());
  const std::string head = unit.empty() ? name : cat(name, " [", unit, "]");
  return format("{:<25}  {:>12.6g}  {:>12.6g}  {:>12.6g}\n", head, mean, least, greatest);
}

/// A quotient of means: that of each seed, and their mean.
std::string quotient_line(const MetricSet& metrics, std::size_t metric, const std::vector<EvalRow>& rows) {
  const std::size_t numerator = metrics.index(metrics[metric].quotient()->numerator, {});
  const std::size_t denominator = metrics.index(metrics[metric].quotient()->denominator, {});
  std::vector<EvalRow> seeds;
  for (const EvalRow& row : rows) {
    if (seeds.empty() || seeds.back().seed != row.seed) {
      seeds.push_back(row);
      continue;
    }
    for (const std::size_t part : {numerator, denominator}) seeds.back().metrics[part] += row.metrics[part];
  }
  return table_line(metrics.name(metric), metrics[metric].traits().unit, seeds,
                    [&](const EvalRow& seed) { return seed.metrics[numerator] / seed.metrics[denominator]; });
}

}  // namespace

std::string eval_json(const EvalResult& result) {
  std::vector<std::string> lines;
  for (const EvalRow& row : result.rows) lines.push_back(json_row(row, result.metrics));
  return cat("[\n", join(lines, ",\n"), "\n]\n");
}

std::string eval_table(const EvalResult& result) {
  const MetricSet& metrics = result.metrics;
  const std::vector<EvalRow>& rows = result.rows;
  const auto failed = std::ranges::count_if(rows, [](const EvalRow& row) { return row.failed; });
  std::string text = cat(rows.size(), rows.size() == 1 ? " episode, " : " episodes, ", failed, " failed\n\n");
  text += fmt::format("{:<25}  {:>12}  {:>12}  {:>12}\n", "", "mean", "least", "greatest");
  if (result.two_efforts) {
    text += table_line("return_sum_commanded", "", rows, [](const EvalRow& row) { return row.return_sum_commanded; });
    text += table_line("return_sum_disturbed", "", rows, [](const EvalRow& row) { return row.return_sum_disturbed; });
  }
  for (std::size_t i = 0; i < metrics.size(); ++i) {
    if (!rows.front().applies[i]) continue;
    if (metrics[i].quotient()) {
      text += quotient_line(metrics, i, rows);
      continue;
    }
    text +=
        table_line(metrics.name(i), metrics[i].traits().unit, rows, [i](const EvalRow& row) { return row.metrics[i]; });
  }
  const std::string missing = metrics.not_applicable();
  return missing.empty() ? text : cat(text, "\n", wrapped(cat("not applicable: ", missing), kColumns), "\n");
}

}  // namespace gust
