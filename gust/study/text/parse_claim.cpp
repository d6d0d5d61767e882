#include <algorithm>
#include <cmath>

#include "gust/study/summary/claim_scores.h"
#include "gust/study/text/parse.h"

namespace gust {
namespace {

/// What stands on an axis: all of it if that is short, else the value nearest to the one that was wanted.
std::string offer(const Sweep::Axis& axis, double wanted) {
  constexpr std::size_t kShort = 12;
  const std::vector<double>& values = axis.values;
  if (values.size() <= kShort) return cat("it has ", canonical_text(values));
  const auto nearest = std::ranges::min_element(values, {}, [&](double v) { return std::abs(v - wanted); });
  return cat("the nearest of its ", values.size(), " is ", *nearest);
}

/// One value per axis of the sweep: `level`, or the parameters by name.
std::vector<double> claim_point(const Table& where, const Sweep& sweep) {
  std::vector<double> at;
  for (const Sweep::Axis& axis : sweep.axes) {
    const std::string key = axis.name();
    const Value* value = where.find(key);
    if (value == nullptr) throw error_at(where.place, "'where' needs '", key, "' for sweep '", sweep.name, "'");
    const double wanted = value->as_number(key);
    const auto nearest = std::ranges::find_if(
        axis.values, [&](double v) { return std::abs(v - wanted) <= 1e-9 * std::max(1.0, std::abs(v)); });
    if (nearest == axis.values.end() && !sweep.automatic) {
      throw error_at(value->place, "sweep '", sweep.name, "' has no ", key, " ", wanted, "; ", offer(axis, wanted));
    }
    if (sweep.automatic && wanted < 0) throw error_at(value->place, "automatic levels begin at 0, got ", wanted);
    at.push_back(nearest == axis.values.end() ? wanted : *nearest);
  }
  return at;
}

/// What a name of [names] stands for: a number, a text, or a list of such.
FormulaValue name_value(const Value& value) {
  if (const auto* list = std::get_if<Value::List>(&value.data)) {
    FormulaList items;
    for (const Value& item : *list) items.items.push_back(name_value(item));
    return {std::move(items)};
  }
  if (value.is_number()) return {Sampled::constant(value.as_number("a name"))};
  return {value.as_text("a name")};
}

std::string claim_start(const Table& table, const Study& study) {
  if (const Value* start = table.find("start")) return named(study.starts, *start, "start").name;
  const auto random = std::ranges::find_if(study.starts, &StartProtocol::random);  // the one that carries intervals
  return random == study.starts.end() ? study.starts.front().name : random->name;
}

/// A formula on one line, as errors and tables show it.
std::string on_one_line(const std::string& text) {
  std::string line;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t blank = std::min(text.find_first_not_of(" \t\r\n", at), text.size());
    const bool breaks = text.substr(at, blank - at).find('\n') != std::string::npos;
    const bool inside = !line.empty() && blank < text.size();
    if (inside) line += breaks ? " " : text.substr(at, blank - at);
    at = std::min(text.find_first_of(" \t\r\n", blank), text.size());
    line += text.substr(blank, at - blank);
  }
  return line;
}

std::vector<std::string> metric_names(const Study& study) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < study.metric_set.size(); ++i) names.push_back(study.metric_set.name(i));
  return names;
}

/// "where" and a metric with its bound.
void parse_where(const Table& table, const Value& where_value, const Study& study, StudyClaim& claim) {
  parse_claim(claim.holds, metric_names(study), table.find("holds")->place);
  const Table& where = where_value.as_table("where");
  const Value* policy = where.find("policy");
  if (policy == nullptr) throw error_at(where.place, "'where' needs a 'policy'");
  claim.policy = named(study.policies, *policy, "policy").name;
  std::vector<std::string> known = {"policy", "sweep", "start"};
  claim.start = claim_start(where, study);
  if (const Value* name = where.find("sweep")) {
    const Sweep& sweep = named(study.sweeps, *name, "sweep");
    claim.sweep = sweep.name;
    claim.at = claim_point(where, sweep);
    for (const Sweep::Axis& axis : sweep.axes) known.push_back(axis.name());
  } else if (const Value* level = where.find("level")) {
    throw error_at(level->place, "a 'level' needs its 'sweep' beside it; without one a claim is about no disturbance");
  }
  check_keys(where, known, "'where'");
}

/// A statement of its own; tried on scores without numbers, so that what is wrong with it is said before any work.
void parse_formula_claim(const Table& table, const Study& study, StudyClaim& claim) {
  for (const std::string& metric : metric_names(study)) {
    const std::string_view after = std::string_view(claim.holds).substr(std::min(metric.size(), claim.holds.size()));
    if (claim.holds.starts_with(metric) && after.find_first_not_of(' ') == after.find_first_of("<>"))
      throw error_at(table.find("holds")->place, "whose ", metric, "? It needs where = { policy = … }, or ", metric,
                     "('POLICY')");
  }
  claim.start = claim_start(table, study);
  claim.metric = study.metric_set.name(margin_metric(study));
  if (const Value* metric = table.find("metric"))
    claim.metric = study.metric_set.name(study.metric_set.index(metric->as_text("metric"), metric->place));
  claim.formula.emplace(claim.holds, table.find("holds")->place);
  const ClaimScores shapes({{.study = &study}}, {claim.metric, claim.start}, Rng(0));
  try {
    claim.formula->judge(study.names, shapes);
  } catch (const BeyondLevels& mistake) {
    throw error_at(table.find("holds")->place, "claim '", claim.holds, "': ", mistake.what());
  } catch (const NotTestable&) {  // a choice among scores that are yet to come
  }
}

}  // namespace

FormulaNames parse_names(const Table& table) {
  FormulaNames names;
  for (const auto& [name, value] : table.items) names.emplace_back(name, name_value(value));
  return names;
}

StudyClaim parse_claim_of(const Table& table, const Study& study) {
  check_keys(table, {"id", "text", "where", "holds", "metric", "start", "required"}, "a claim");
  StudyClaim claim;
  claim.place = table.place;
  claim.id = checked_name(table, "id", "a claim");
  if (table.contains("text")) claim.text = required_text(table, "text", "a claim");
  claim.holds = on_one_line(required_text(table, "holds", "a claim"));
  if (const Value* required = table.find("required")) claim.required = required->as_bool("required");
  if (const Value* where = table.find("where")) {
    for (const char* key : {"metric", "start"}) {
      if (const Value* value = table.find(key))
        throw error_at(value->place, "'", key, "' is for a claim without 'where'");
    }
    parse_where(table, *where, study, claim);
  } else {
    parse_formula_claim(table, study, claim);
  }
  return claim;
}

}  // namespace gust
