#include <algorithm>

#include "gust/study/text/parse.h"
#include "gust/study/text/reference_curve.h"

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

ReferenceCurve parse_reference(const Table& table, const FindFiles& find, const Study& study) {
  check_keys(table, {"policy", "file", "source", "steps", "score"}, "a learning curve");
  ReferenceCurve curve;
  curve.policy = required_text(table, "policy", "a learning curve");
  const Place& place = table.find("policy")->place;
  if (std::ranges::find(study.policies, curve.policy, &StudyPolicy::name) == study.policies.end()) {
    throw error_at(place, "unknown policy '", curve.policy, "'");
  }
  curve.source = checked_name(table, "source", "a learning curve");
  const std::vector<StudyFile> files = find(required_text(table, "file", "a learning curve"), table.place);
  if (files.size() != 1) throw error_at(table.place, "'file' must name one file, found ", files.size());
  const auto column = [&](const char* key) {
    return table.contains(key) ? required_text(table, key, "a learning curve") : std::string();
  };
  const CurveColumns columns{column("steps"), column("score"), study.setup.plant->spec().steps};
  CurvePoints points = read_reference_curve(files.front().bytes, files.front().path, columns);
  curve.steps = std::move(points.steps);
  curve.score = std::move(points.score);
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
