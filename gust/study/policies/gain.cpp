#include <algorithm>
#include <charconv>
#include <cmath>

#include "gust/control/lqr.h"
#include "gust/control/policy_interface.h"
#include "gust/control/tracking.h"
#include "gust/study/policies/policy_entry.h"

namespace gust {
namespace {

/// A row of K as it is written, and where.
struct Row {
  std::vector<double> numbers;
  Place place;
};

/// The cells of a line, with the column at which each begins.
std::vector<std::pair<std::string, std::size_t>> cells_of(std::string_view line) {
  std::vector<std::pair<std::string, std::size_t>> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    std::string_view cell = line.substr(begin, end - begin);
    const std::size_t lead = std::min(cell.find_first_not_of(" \t"), cell.size());
    cell.remove_prefix(lead);
    cell.remove_suffix(cell.size() - std::min(cell.find_last_not_of(" \t\r") + 1, cell.size()));
    cells.emplace_back(cell, begin + lead + 1);
    begin = end + 1;
  }
  return cells;
}

bool reads_number(const std::string& text, double& number) {
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, failure] = std::from_chars(begin, text.data() + text.size(), number);
  return failure == std::errc{} && end == text.data() + text.size();
}

/// Whether a cell may be the name of a state with its sign: "theta", "-theta".
bool begins_name(std::string_view cell) {
  if (cell.starts_with('-')) cell.remove_prefix(1);
  return !cell.empty() && ((cell[0] >= 'a' && cell[0] <= 'z') || (cell[0] >= 'A' && cell[0] <= 'Z'));
}

/// u = u0 - K (x - reference), with K and u0 in units of the user's choice.
struct Gain final : PolicySource {
  Written k{"required, or 'file'", "list of lists of numbers"};
  Written file{"none", "text"};
  Written observe{"the states, in the plant's order", "list"};
  Written units{"SI units", "table or text"};
  Written u0{"what holds the goal", "list of numbers"};

  static constexpr std::tuple kFields = {
      field("k", &Gain::k, "the matrix K, a list for each action, with a number for each state that is observed"),
      field("file", &Gain::file,
            "a CSV file with K instead, a line for each action; the first line may name the states"),
      field("observe", &Gain::observe,
            "the states in the order of K's columns, with sign and unit if they differ: [\"theta=deg\", \"-x\"]"),
      field("units", &Gain::units,
            "units by name of state and action, { theta = \"deg\", theta_dot = \"deg/s\", force = \"%\" }, or one unit "
            "of "
            "all actions; K is in units of the action per unit of the state"),
      field("u0", &Gain::u0, "the action at the reference, in the unit of the actions; by default what holds the goal"),
  };

  void prepare(const PolicyContext& context) override {
    const PlantSpec& spec = context.equations("gain").spec();
    if (k && file) throw error_at(file->place, "'k' and 'file' say the same; give one of them");
    if (!k && !file) throw error_at(context.place, "a gain policy needs a 'k', such as [[-1, -2, 20, 4]], or a 'file'");
    if (observe) columns_ = *observe;
    const std::vector<Row> matrix = file ? read_file(context) : read_matrix();
    const NamedUnits named = read_units(units ? &*units : nullptr, spec);
    scale_columns(observed(spec), matrix, named, spec);
    set_rest(named, spec);
  }

  std::string canonical(const PolicyMember&) const override {
    std::vector<std::string> rows;
    for (Eigen::Index i = 0; i < gain_.rows(); ++i) {
      const Eigen::VectorXd row = gain_.row(i).transpose();
      rows.push_back(canonical_text(std::vector<double>(row.begin(), row.end())));
    }
    return cat("gain k [", join(rows, ", "), "] u0 ", canonical_text(rest_), "\n");
  }

  std::unique_ptr<Policy> make(const Setup& setup, const PolicyMember&) const override {
    const Plant& plant = setup.equations("gain", {});
    std::vector<FeedbackKnot> knots = reference_knots(plant, gain_);
    for (FeedbackKnot& knot : knots) {
      for (std::size_t i = 0; i < rest_.size(); ++i) knot.action[static_cast<Eigen::Index>(i)] = rest_[i];
    }
    return feedback_policy(plant, std::move(knots));
  }

 private:
  /// One row may stand without the outer brackets.
  std::vector<Row> read_matrix() {
    place_ = k->place;
    std::vector<Row> matrix;
    const Value::List& list = k->as_list("k");
    const bool one = !list.empty() && list.front().is_number();
    if (one) return {{k->as_numbers("k"), k->place}};
    for (const Value& row : list) {
      matrix.push_back({{}, row.place});
      for (const Value& number : row.as_list("k")) matrix.back().numbers.push_back(number.as_number("k"));
    }
    return matrix;
  }

  std::vector<Row> read_file(const PolicyContext& context) {
    const std::string& pattern = file->as_text("file");
    const std::vector<StudyFile> found = context.find(pattern, file->place);
    if (found.empty()) throw error_at(file->place, "no file matches '", pattern, "'");
    if (found.size() > 1) throw error_at(file->place, "'", pattern, "' must be one file, got ", found.size());
    place_ = {found.front().path, 1, 1};
    const std::string_view text = utf8_text(found.front().bytes, found.front().path);
    std::vector<Row> matrix;
    std::uint32_t line = 0;
    for (const std::string& record : split_text(text, '\n')) {
      ++line;
      const std::size_t first = record.find_first_not_of(" \t\r");
      if (first == std::string::npos || record[first] == '#') continue;
      read_line(record, line, matrix);
    }
    return matrix;
  }

  void read_line(const std::string& record, std::uint32_t line, std::vector<Row>& matrix) {
    const auto cells = cells_of(record);
    double number = 0;
    const bool names = !reads_number(cells.front().first, number) && begins_name(cells.front().first);
    if (matrix.empty() && !named_in_file_ && names) return read_header(cells, line);
    matrix.push_back({{}, {place_.name, line, 1}});
    for (const auto& [cell, column] : cells) {
      const Place place{place_.name, line, static_cast<std::uint32_t>(column)};
      if (!reads_number(cell, number)) throw error_at(place, "K must be numbers with commas between, got '", cell, "'");
      if (!std::isfinite(number)) throw error_at(place, "K must be finite numbers, got ", cell);
      matrix.back().numbers.push_back(number);
    }
  }

  void read_header(const std::vector<std::pair<std::string, std::size_t>>& cells, std::uint32_t line) {
    if (observe)
      throw error_at(observe->place, "'observe' and the first line of ", place_.name, " say the same; leave one out");
    named_in_file_ = true;
    Value::List names;
    for (const auto& [cell, column] : cells)
      names.push_back({cell, {place_.name, line, static_cast<std::uint32_t>(column)}});
    columns_ = Value{std::move(names), {place_.name, line, 1}};
  }

  /// Which state each column of K belongs to, with its sign and unit.
  std::vector<ObservedNumber> observed(const Interface& spec) const {
    Table table;
    if (columns_) table.set("observe", *columns_);
    std::vector<ObservedNumber> numbers = read_interface(table, spec).observe;
    const std::size_t all = numbers.empty() ? spec.state.size() : 0;
    for (std::size_t i = 0; i < all; ++i) numbers.push_back({.component = i});
    for (const ObservedNumber& number : numbers) {
      const bool linear = number.component && number.form == ObservedNumber::Form::kPlain && number.offset == 0;
      if (!linear || *number.component >= spec.state.size())
        throw error_at(columns_->place,
                       "'observe' of a gain policy must be states, without sin, cos, offsets and constants");
    }
    return numbers;
  }

  /// K in SI units, a column a state.
  void scale_columns(const std::vector<ObservedNumber>& numbers, const std::vector<Row>& matrix,
                     const NamedUnits& named, const Interface& spec) {
    check_shape(matrix, numbers, spec);
    const auto rows = static_cast<Eigen::Index>(spec.action.size());
    gain_ = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(spec.state.size()));
    for (std::size_t j = 0; j < numbers.size(); ++j) {
      const std::size_t state = *numbers[j].component;
      if (named.state[state] != 1 && std::abs(numbers[j].scale) != 1)
        throw error_at(units->place, "the unit of ", spec.state[state].name,
                       " stands in 'observe' and in 'units'; give one");
      const double scale = numbers[j].scale * named.state[state];
      for (std::size_t i = 0; i < spec.action.size(); ++i)
        gain_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(state)) +=
            named.action[i].scale * matrix[i].numbers[j] * scale;
    }
  }

  void check_shape(const std::vector<Row>& matrix, const std::vector<ObservedNumber>& numbers,
                   const Interface& spec) const {
    std::vector<std::string> names;
    for (const ObservedNumber& number : numbers) names.push_back(spec.state[*number.component].name);
    const std::string wanted = cat("K must be ", spec.action.size(), " x ", numbers.size(),
                                   ", a row for each action and a column for each of ", join(names, ", "));
    if (matrix.size() != spec.action.size())
      throw error_at(place_, wanted, "; got ", matrix.size(), matrix.size() == 1 ? " row" : " rows");
    for (const auto& [row, place] : matrix) {
      if (row.size() != numbers.size())
        throw error_at(place, wanted, "; this row has ", row.size(), row.size() == 1 ? " number" : " numbers");
    }
  }

  void set_rest(const NamedUnits& named, const PlantSpec& spec) {
    std::vector<std::string> names;
    for (const Component& action : spec.action) names.push_back(action.name);
    const std::vector<double> own = numbers_or(u0, "u0", std::vector<double>(names.size()), join(names, ", "));
    rest_ = spec.action_goal;
    for (std::size_t i = 0; u0 && i < own.size(); ++i)
      rest_[i] = named.action[i].scale * own[i] + named.action[i].offset;
  }

  std::optional<Value> columns_;  // what K's columns are, if it is said
  bool named_in_file_ = false;
  Place place_;           // of K
  Eigen::MatrixXd gain_;  // actions x states, physical
  std::vector<double> rest_;
};

}  // namespace

PolicyKind policy_gain() {
  return policy_entry<Gain>(
      {"gain",
       "State feedback, u = u0 - K (x - reference), with a matrix that was designed elsewhere; the reference is the "
       "plant's goal or, where it moves, the one that the next step is judged by.",
       "docs/policies.md 3",
       "[[policy]]\nname  = \"bench\"\nkind  = \"gain\"\nk     = [[-8.8, -9.0, -0.96, -0.25]]  # N per m, m/s, deg, "
       "deg/s\n"
       "units = { theta = \"deg\", theta_dot = \"deg/s\", force = \"N\" }"});
}

}  // namespace gust
