#include <fmt/format.h>

#include <charconv>
#include <nlohmann/json.hpp>

#include "gust/study/trials/trials.h"

namespace gust {
namespace {

using Json = nlohmann::json;

/// The head of a curve's file; earlier versions left its last column out.
std::string curve_head(bool old) {
  std::string head = "steps";
  for (const CurveColumn& column : kCurveColumns) head += cat(",", column.name);
  return old ? head : cat(head, ",protagonist_steps");
}

Json matrix_json(const Matrix<double>& matrix) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < matrix.rows(); ++i) {
    rows.push_back(std::vector<double>(matrix.row(i).begin(), matrix.row(i).end()));
  }
  return rows;
}

/// JSON has no infinity and no NaN; both come back as NaN.
double number_from(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

Matrix<double> matrix_from(const Json& rows) {
  Matrix<double> matrix(rows.size(), rows.empty() ? 0 : rows.front().size());
  for (std::size_t i = 0; i < matrix.rows(); ++i) {
    if (rows[i].size() != matrix.lanes()) throw Error("rows of unequal length");
    for (std::size_t k = 0; k < matrix.lanes(); ++k) matrix.at(i, k) = number_from(rows[i][k]);
  }
  return matrix;
}

/// What a policy remembered, absent from the episodes of those that remember nothing.
void read_memory(Trace& trace, const Json& list) {
  Json rows = Json::array();
  for (const Json& item : list) {
    trace.memory_of.push_back({item.at("name"), item.at("unit")});
    rows.push_back(item.at("values"));
  }
  trace.memory = matrix_from(rows);
}

Json memory_json(const Trace& trace) {
  Json list = Json::array();
  const Json rows = matrix_json(trace.memory);
  for (std::size_t i = 0; i < rows.size(); ++i)
    list.push_back({{"name", trace.memory_of[i].name}, {"unit", trace.memory_of[i].unit}, {"values", rows[i]}});
  return list;
}

Trace trace_from(const Json& json) {
  Trace trace;
  trace.index = {json.at("cell"), json.at("start"), json.at("episode")};
  trace.state = matrix_from(json.at("state"));
  trace.observation = matrix_from(json.at("observation"));
  trace.commanded = matrix_from(json.at("commanded"));
  trace.disturbed = matrix_from(json.at("disturbed"));
  trace.applied = matrix_from(json.at("applied"));
  trace.force = matrix_from(json.at("force"));
  for (const Json& reward : json.at("reward")) trace.reward.push_back(number_from(reward));
  trace.failed_at = json.at("failed_at");
  if (json.contains("memory")) read_memory(trace, json["memory"]);
  return trace;
}

}  // namespace

double number_from_text(std::string_view text, std::string_view name) {
  double number = 0;
  const char* const end = text.data() + text.size();
  const auto [read, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || read != end) throw Error(cat(name, ": not a number"));
  return number;
}

std::string curve_text(const std::vector<CurvePoint>& curve) {
  std::string text = cat(curve_head(false), "\n");
  for (const CurvePoint& point : curve) {
    text += cat(point.steps);
    for (const CurveColumn& column : kCurveColumns) text += cat(",", point.*column.value);
    text += cat(",", point.protagonist_steps, "\n");
  }
  return text;
}

std::vector<CurvePoint> read_curve(std::string_view text, std::string_view name) {
  std::vector<CurvePoint> curve;
  const std::vector<std::string> lines = split_text(text, '\n');
  const bool old = !lines.empty() && lines.front() == curve_head(true);  // every step was the protagonist's
  if (lines.empty() || (lines.front() != curve_head(false) && !old)) throw Error(cat(name, ":1: no learning curve"));
  for (std::size_t i = 1; i < lines.size(); ++i) {
    double values[std::size(kCurveColumns) + 2] = {};
    const std::size_t columns = std::size(values) - (old ? 1 : 0);
    const std::vector<std::string> cells = split_text(lines[i], ',');
    bool good = cells.size() == columns;
    for (std::size_t c = 0; good && c < cells.size(); ++c) {
      const char* end = cells[c].data() + cells[c].size();
      good = std::from_chars(cells[c].data(), end, values[c]).ptr == end;
    }
    if (!good) throw Error(cat(name, ":", i + 1, ": not ", columns, " numbers"));
    CurvePoint point;
    point.steps = static_cast<std::int64_t>(values[0]);
    for (std::size_t c = 0; c < std::size(kCurveColumns); ++c) point.*kCurveColumns[c].value = values[c + 1];
    point.protagonist_steps = static_cast<std::int64_t>(old ? values[0] : values[columns - 1]);
    curve.push_back(point);
  }
  return curve;
}

std::string traces_text(const std::vector<Trace>& traces) {
  Json list = Json::array();
  for (const Trace& trace : traces) {
    list.push_back({{"cell", trace.index.cell},
                    {"start", trace.index.start},
                    {"episode", trace.index.episode},
                    {"failed_at", trace.failed_at},
                    {"state", matrix_json(trace.state)},
                    {"observation", matrix_json(trace.observation)},
                    {"commanded", matrix_json(trace.commanded)},
                    {"disturbed", matrix_json(trace.disturbed)},
                    {"applied", matrix_json(trace.applied)},
                    {"force", matrix_json(trace.force)},
                    {"reward", trace.reward}});
    if (!trace.memory_of.empty()) list.back()["memory"] = memory_json(trace);
  }
  return list.dump() + "\n";
}

std::vector<Trace> read_traces(std::string_view text, std::string_view name) {
  try {
    std::vector<Trace> traces;
    for (const Json& json : Json::parse(text)) traces.push_back(trace_from(json));
    return traces;
  } catch (const std::exception& error) {
    throw Error(cat(name, ": no kept episodes: ", error.what()));
  }
}

}  // namespace gust
