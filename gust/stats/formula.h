#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "gust/core/value.h"
#include "gust/stats/sampled.h"

namespace gust {

/// One of the statements that must all be true.
struct TruthPart {
  std::string statement;  ///< as it is written
  std::string label;      ///< "a = sac, s = action": what the names that `for` gave it stand for
  Sampled margin;
  double share_bound = std::numeric_limits<double>::quiet_NaN();  ///< as Truth has it
};

/// How true a statement is in each resample: by how much it holds. It is true where the margin is not negative; a
/// strict relation between equals falls short by the least number there is.
struct Truth {
  Sampled margin;
  std::vector<TruthPart> parts = {};  ///< what `and` and `all` put together; none of a statement that is one alone
  std::string statement = {};         ///< as TruthPart has it
  std::string label = {};
  /// Of a statement about a share of successes: the share from which on it is true, where fewer successes make it true
  /// that of the failures. So the share is this bound plus the margin. Else NaN.
  double share_bound = std::numeric_limits<double>::quiet_NaN();

  explicit Truth(Sampled by) : margin(std::move(by)) {}

  /// The parts, of one alone itself.
  std::vector<TruthPart> all_parts() const;
  /// Names what one of its names stands for, in front of those within.
  void name(const std::string& binding);
};

/// Whether `left sign right` is true, of the signs < <= > >= == !=.
Truth related(std::string_view sign, const Sampled& left, const Sampled& right);

struct FormulaValue;

/// Values in a row; of a curve, `axis` says where each one stands (a level, a step), else it is empty. A curve along
/// the levels of a disturbance may have more values, at levels that its margin asked for: these are for margin() alone,
/// as all else is about the levels that somebody chose. margin() and half() fall from the undisturbed score, where
/// there is one, else from the first value.
struct FormulaList {
  std::vector<FormulaValue> items;
  std::vector<double> axis;
  std::vector<FormulaValue> added;
  std::vector<double> added_axis;
  std::optional<Sampled> undisturbed = {};
  std::string no_margin = {};  ///< why margin() cannot be told whatever the values are
  /// Reads what the table's margin is measured from, so that margin() has its interval; null where it is not there.
  std::function<std::shared_ptr<const MarginData>()> margin_data = {};
};

/// What a part of a formula comes to.
struct FormulaValue {
  std::variant<Sampled, Truth, std::string, FormulaList> data;

  /// "a number", "a statement", "text" or "a list", for messages.
  std::string_view type() const;

  // Each throws an Error that names the function or operator if the value is of another type.
  const Sampled& as_number(std::string_view what) const;
  const Truth& as_truth(std::string_view what) const;
  const std::string& as_text(std::string_view what) const;
  const FormulaList& as_list(std::string_view what) const;
  /// All items of a list as numbers.
  std::vector<Sampled> as_numbers(std::string_view what) const;
};

/// A question that the data cannot answer, with the datum that is missing.
class NotTestable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A place outside a curve, or a margin of levels that have none: of data that are yet to come an Error, for the levels
/// are known before.
class BeyondLevels : public NotTestable {
 public:
  using NotTestable::NotTestable;
};

/// The functions of a formula that speak of data: scores, learning curves, tables.
class FormulaData {
 public:
  virtual ~FormulaData() = default;
  virtual std::vector<std::string> functions() const = 0;
  /// Throws Error if the arguments make no sense, NotTestable if what they ask for is not there.
  virtual FormulaValue call(std::string_view function, const std::vector<FormulaValue>& arguments) const = 0;
  /// The fewest seeds of any policy with seeds that was asked for since the last question; none if there was none.
  virtual std::optional<std::size_t> fewest_seeds() const { return std::nullopt; }
};

/// Names that stand for values, such as agents = ["ppo", "sac"].
using FormulaNames = std::vector<std::pair<std::string, FormulaValue>>;

/// A statement about data as text, such as
///     min(area(score(a, "action {w}")) for a in agents for w in waves) > 0.5
/// with numbers, 'text' with {names} filled in, lists [a, b] and [x for a in list if y], + - * /, relations,
/// and / or / not, functions of lists (formula_functions.cpp) and of data. A filter looks at the estimate alone.
class Formula {
 public:
  /// Throws Error with the place of the text and the column within it.
  Formula(std::string_view text, const Place& place);

  const std::string& text() const { return text_; }
  /// Whether it calls this function anywhere.
  bool calls(std::string_view function) const;

  /// Throws Error where names, types or arguments are wrong, NotTestable where data are missing.
  FormulaValue evaluate(const FormulaNames& names, const FormulaData& data) const;

  /// What the statement measures and how true it is: of `x > 3` x, of a relation between two measured numbers their
  /// difference, of anything else the margin itself.
  struct Judged {
    Sampled measured;
    Truth truth;
  };
  Judged judge(const FormulaNames& names, const FormulaData& data) const;

  /// A part of a formula.
  struct Node {
    enum class Kind { number, text, name, call, list, each, arithmetic, relation, logic };
    Kind kind = Kind::number;
    std::string text = {};  ///< the operator, name or text; of `each` the variable
    double number = 0;
    std::vector<Node> parts = {};  ///< of `each`: the list, what is made of each item, and perhaps a filter
    std::size_t column = 1;
    std::size_t begin = 0, end = 0;  ///< of a statement: where it stands in the text
  };

 private:
  std::string text_;
  Place place_;
  Node root_;
};

}  // namespace gust
