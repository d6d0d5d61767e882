#pragma once

#include "gust/study/text/study.h"

namespace gust {

inline constexpr std::int64_t kMostSeeds = 10'000;  ///< of a training

// The parts of parse_study, one file each.

/// Replaces one value of a parsed text: "path.to.key=value", any part of the path in quotes. A list of tables is
/// entered by the name or id of a table.
void apply_setting(Table& study, const std::string& setting);

/// The value of a setting: TOML if it reads as such, else plain text.
Value setting_value(const std::string& text, const Place& place);

/// [[policy]]; `study` already has its setup.
StudyPolicy parse_policy(const Table& table, const Study& study, const FindFiles& find);

/// [[sweep]]
Sweep parse_sweep(const Table& table, const Study& study);

/// [names]: what claims call things.
FormulaNames parse_names(const Table& table);

/// [[claim]]; `study` already has its policies, sweeps and names.
StudyClaim parse_claim_of(const Table& table, const Study& study);

/// [report]; `study` already has its policies.
void parse_report(const Table& table, const FindFiles& find, Study& study);

/// An injection as read_injection() reads it; one that reaches no channel is an Error, for it disturbs nothing.
Injection parse_injection(const Table& table, const Interface& spec, const std::vector<std::string>& also = {});

/// "disturb = [ … ]": injections that are always on, each with its level.
std::vector<Injection> parse_disturb(const Value& list, const Interface& spec);

/// { from, to, count } or a list, ascending and without repeats; at least one number.
std::vector<double> parse_levels(const Value& value, std::string_view what);

/// The one of a name; an Error at the name's place, with the nearest, if there is none.
template <class Item>
const Item& named(const std::vector<Item>& items, const Value& name, const char* what) {
  std::vector<std::string> names;
  for (const Item& item : items) {
    if (item.name == name.as_text(what)) return item;
    names.push_back(item.name);
  }
  throw error_at(name.place, "unknown ", what, " '", name.as_text(what), "'", did_you_mean(name.as_text(what), names));
}

/// A value of a parameter: a number in its unit, or "x1.5" for a multiple of the nominal one. Greater than 0.
double parameter_value(const Value& value, const Parameter& parameter);

/// The text of a required key.
const std::string& required_text(const Table& table, std::string_view key, std::string_view what);

/// A name that pages, files and messages can carry.
std::string checked_name(const Table& table, std::string_view key, std::string_view what);

/// Reads an optional whole number within bounds.
std::int64_t optional_int(const Table& table, std::string_view key, std::int64_t standard, const Range& range);

}  // namespace gust
