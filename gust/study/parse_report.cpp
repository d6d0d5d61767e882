#include <algorithm>
#include <charconv>

#include "gust/study/parse.h"

namespace gust {
namespace {

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string_view::npos ? std::string() : std::string(text.substr(first));
}

/// "worst 1, median 1"
TraceRule parse_keep_traces(const Value& keep) {
  TraceRule rule;
  const std::string& text = keep.as_text("keep_traces");
  for (const std::string& part : split_text(text, ',')) {
    const std::vector<std::string> words = split_text(trimmed(part), ' ');
    const bool known = words.size() == 2 && (words[0] == "worst" || words[0] == "median");
    const Value count = value_from_text(known ? words[1] : "", keep.place);
    if (!known || !std::holds_alternative<std::int64_t>(count.data)) {
      throw error_at(keep.place, "'keep_traces' must read like \"worst 1, median 1\", got '", text, "'");
    }
    const std::int64_t number = std::get<std::int64_t>(count.data);
    if (number < 0 || number > 100) throw error_at(keep.place, "'keep_traces' keeps 0 to 100 episodes, got ", number);
    (words[0] == "worst" ? rule.worst : rule.median) = number;
  }
  return rule;
}

std::size_t column_of(const std::string& head, const std::string& name, const Place& place) {
  const std::vector<std::string> names = split_text(head, ',');
  const auto at = std::ranges::find(names, name);
  if (at == names.end()) throw error_at(place, "the file has no column '", name, "'", did_you_mean(name, names));
  return static_cast<std::size_t>(at - names.begin());
}

double number_in(const std::string& cell, const Place& place, std::size_t line) {
  double number = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
  if (error != std::errc{} || end != cell.data() + cell.size()) {
    throw error_at(place, "line ", line, " of the file: '", cell, "' is no number");
  }
  return number;
}

ReferenceCurve parse_reference(const Table& table, const FindFiles& find, const Study& study) {
  check_keys(table, {"policy", "file", "source", "steps", "score"}, "a learning curve");
  ReferenceCurve curve;
  curve.policy = required_text(table, "policy", "a learning curve");
  const Place& place = table.find("policy")->place;
  if (std::ranges::find(study.policies, curve.policy, &StudyPolicy::name) == study.policies.end()) {
    throw error_at(place, "unknown policy '", curve.policy, "'");
  }
  curve.source = checked_name(table, "source", "a learning curve");
  const std::vector<StudyPolicy::File> files = find(required_text(table, "file", "a learning curve"), table.place);
  if (files.size() != 1) throw error_at(table.place, "'file' must name one file, found ", files.size());
  const std::vector<std::string> lines = split_text(files.front().bytes, '\n');
  if (lines.empty()) throw error_at(table.place, "the file is empty");
  const std::size_t steps = column_of(lines[0], required_text(table, "steps", "a learning curve"), table.place);
  const std::size_t score = column_of(lines[0], required_text(table, "score", "a learning curve"), table.place);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string> cells = split_text(lines[i], ',');
    if (cells.size() <= std::max(steps, score)) throw error_at(table.place, "line ", i + 1, " of the file is short");
    curve.steps.push_back(number_in(cells[steps], table.place, i + 1));
    curve.score.push_back(number_in(cells[score], table.place, i + 1));
  }
  return curve;
}

}  // namespace

void parse_report(const Table& table, const FindFiles& find, Study& study) {
  check_keys(table, {"keep_traces", "learning"}, "[report]");
  if (const Value* keep = table.find("keep_traces")) study.traces = parse_keep_traces(*keep);
  const Value* curves = table.find("learning");
  if (curves == nullptr) return;
  for (const Value& curve : curves->as_list("learning")) {
    study.reference_curves.push_back(parse_reference(curve.as_table("learning"), find, study));
  }
}

}  // namespace gust
