#include "gust/stats/formula.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <type_traits>

#include "gust/core/text.h"
#include "gust/stats/formula_functions.h"
#include "gust/stats/formula_parser.h"
#include "gust/stats/sampled_margin.h"

namespace gust {
namespace {

using Node = Formula::Node;

constexpr std::size_t kMostItems = 10'000;  // that the `for`s of a formula make; a claim that a person wrote has dozens
constexpr double kLeast = std::numeric_limits<double>::denorm_min();

/// By how much a > b, or a >= b, holds; equal infinities are equal.
double above(double a, double b, bool strict) {
  const double margin = a == b ? 0.0 : a - b;
  return strict && margin == 0.0 ? -kLeast : margin;
}
Bounds above(const Bounds& a, const Bounds& b, bool strict) {
  return {above(a.low, b.high, strict), above(a.high, b.low, strict)};
}
double negated(double margin) { return margin == 0.0 ? -kLeast : -margin; }
Bounds negated(const Bounds& margin) { return {negated(margin.high), negated(margin.low)}; }

Bounds apart(const Bounds& a, const Bounds& b) {
  if (a.exact() && b.exact()) return a.low == b.low ? 0.0 : std::abs(a.low - b.low);
  return abs(a - b);
}

Sampled minus(const Sampled& left, const Sampled& right) {
  if (std::optional<Sampled> difference = sampled_difference(left, right)) return *std::move(difference);
  return combine(left, right, std::minus<>());
}

Sampled calculated(char sign, const Sampled& left, const Sampled& right) {
  switch (sign) {
    case '+':
      return combine(left, right, std::plus<>());
    case '-':
      return minus(left, right);
    case '*':
      return combine(left, right, std::multiplies<>());
    default:
      if (std::optional<Sampled> ratio = sampled_ratio(left, right)) return *std::move(ratio);
      return combine(left, right, std::divides<>());
  }
}

Truth inverse(const Truth& truth) {
  Truth result(combine(truth.margin, [](const Bounds& margin) { return negated(margin); }));
  result.share_bound = 1.0 - truth.share_bound;
  return result;
}

std::vector<TruthPart> joined(std::vector<TruthPart> first, std::vector<TruthPart> second) {
  std::ranges::move(second, std::back_inserter(first));
  return first;
}

class Evaluator {
 public:
  /// A relation with its two sides.
  struct Related {
    FormulaValue left, right;
    Truth truth;
  };

  Evaluator(std::string_view text, const Place& place, FormulaNames names, const FormulaData& data)
      : text_(text), place_(place), names_(std::move(names)), data_(data) {}

  FormulaValue value(const Node& node) {
    FormulaValue found = plain_value(node);
    auto* truth = std::get_if<Truth>(&found.data);
    if (truth != nullptr && truth->statement.empty() && node.end > node.begin)
      truth->statement = text_.substr(node.begin, node.end - node.begin);
    return found;
  }

  Related related(const Node& node) {
    FormulaValue left = value(node.parts[0]), right = value(node.parts[1]);
    const auto* text = std::get_if<std::string>(&left.data);
    const auto* other = std::get_if<std::string>(&right.data);
    if (text != nullptr && other != nullptr && (node.text == "==" || node.text == "!=")) {
      const double margin = (*text == *other) == (node.text == "==") ? 1.0 : -1.0;
      return {std::move(left), std::move(right), Truth(Sampled::constant(margin))};
    }
    const std::string what = cat("'", node.text, "'");
    Truth truth = placed(node, [&] { return gust::related(node.text, left.as_number(what), right.as_number(what)); });
    return {std::move(left), std::move(right), std::move(truth)};
  }

 private:
  FormulaValue plain_value(const Node& node) {
    switch (node.kind) {
      case Node::Kind::number:
        return {Sampled::constant(node.number)};
      case Node::Kind::text:
        return {filled(node)};
      case Node::Kind::name:
        return named(node, node.text);
      case Node::Kind::call:
        return called(node);
      case Node::Kind::list:
        return {FormulaList{values(node.parts), {}}};
      case Node::Kind::each:
        return {each(node)};
      case Node::Kind::arithmetic:
        return {calculated(node.text.front(), number(node.parts[0], node), number(node.parts[1], node))};
      case Node::Kind::relation:
        return {related(node).truth};
      case Node::Kind::logic:
        break;
    }
    return {logic(node)};
  }

  template <class... Parts>
  Error error(const Node& node, const Parts&... parts) const {
    return formula_error(place_, text_, node.column, parts...);
  }

  /// What get() gives; an Error that it throws is told with the node's column.
  template <class Get>
  std::invoke_result_t<Get> placed(const Node& node, Get get) const {
    try {
      return get();
    } catch (const Error& problem) {
      throw error(node, problem.what());
    }
  }

  Sampled number(const Node& part, const Node& of) {
    const FormulaValue found = value(part);
    return placed(of, [&] { return found.as_number(cat("'", of.text, "'")); });
  }
  Truth truth(const Node& part, const Node& of) {
    const FormulaValue found = value(part);
    return placed(of, [&] { return found.as_truth(cat("'", of.text, "'")); });
  }

  std::vector<FormulaValue> values(const std::vector<Node>& parts) {
    std::vector<FormulaValue> values;
    for (const Node& part : parts) values.push_back(value(part));
    return values;
  }

  FormulaValue named(const Node& node, const std::string& name) const {
    std::vector<std::string> known;
    for (std::size_t i = names_.size(); i-- > 0;) {
      if (names_[i].first == name) return names_[i].second;
      known.push_back(names_[i].first);
    }
    throw error(node, "unknown name '", name, "'", did_you_mean(name, known));
  }

  /// The text with every {name} replaced by what it stands for.
  std::string filled(const Node& node) const {
    std::string result;
    std::string_view rest = node.text;
    while (true) {
      const std::size_t open = rest.find('{');
      const std::size_t close = open == std::string_view::npos ? open : rest.find('}', open);
      if (close == std::string_view::npos) return result.append(rest);
      result.append(rest.substr(0, open));
      const std::string name(rest.substr(open + 1, close - open - 1));
      const FormulaValue found = named(node, name);
      const auto* text = std::get_if<std::string>(&found.data);
      result += text ? *text : cat(placed(node, [&] { return found.as_number(cat("'{", name, "}'")); }).estimate());
      rest.remove_prefix(close + 1);
    }
  }

  FormulaValue called(const Node& node) {
    const std::vector<FormulaValue> arguments = values(node.parts);
    std::vector<std::string> known = data_.functions();
    if (std::ranges::find(known, node.text) != known.end())
      return placed(node, [&] { return data_.call(node.text, arguments); });
    for (const FormulaFunction& function : formula_functions()) {
      known.emplace_back(function.name);
      if (function.name != node.text) continue;
      if (arguments.size() < function.least || arguments.size() > function.most)
        throw error(node, "'", node.text, "' is called as ", node.text, "(", function.arguments, ")");
      return placed(node, [&] { return function.call(arguments); });
    }
    throw error(node, "unknown function '", node.text, "'", did_you_mean(node.text, known));
  }

  Truth logic(const Node& node) {
    const Truth first = truth(node.parts[0], node);
    if (node.text == "not") return inverse(first);
    const Truth second = truth(node.parts[1], node);
    const bool both = node.text == "and";
    Sampled margin = combine_rising(std::array{first.margin, second.margin}, [both](std::span<const double> margins) {
      return both ? std::ranges::min(margins) : std::ranges::max(margins);
    });
    Truth whole(std::move(margin));
    if (both) whole.parts = joined(first.all_parts(), second.all_parts());
    if (!both && first.share_bound == second.share_bound) whole.share_bound = first.share_bound;
    return whole;
  }

  /// The items that a `for` makes. A list over numbers that ascend is a curve along them.
  FormulaList each(const Node& node) {
    const FormulaValue over = value(node.parts[0]);
    const FormulaList list = placed(node, [&] { return over.as_list("'for'"); });
    FormulaList result;
    for (const FormulaValue& item : list.items) {
      names_.emplace_back(node.text, item);
      add(node, item, result);
      names_.pop_back();
    }
    if (result.axis.size() != result.items.size()) result.axis.clear();
    return result;
  }

  /// Whether the filter of an `each` lets its item pass.
  bool chosen(const Node& node) {
    const Sampled margin = truth(node.parts[2], node).margin;
    const Bounds known = margin.bounds(0);
    if (std::isnan(known.low)) throw NotTestable("what 'if' asks for is NaN");
    if (known.low < 0 && known.high >= 0) throw NotTestable(cat("what 'if' asks for is not known: ", margin.limit));
    return known.low >= 0;
  }

  /// A statement that was made of an item, with the item's name.
  static FormulaValue bound(const Node& node, const FormulaValue& item, FormulaValue made) {
    auto* truth = std::get_if<Truth>(&made.data);
    const auto* text = std::get_if<std::string>(&item.data);
    const auto* number = std::get_if<Sampled>(&item.data);
    if (truth != nullptr && (text != nullptr || number != nullptr))
      truth->name(cat(node.text, " = ", text != nullptr ? *text : cat(number->estimate())));
    return made;
  }

  void add(const Node& node, const FormulaValue& item, FormulaList& result) {
    const Node& inner = node.parts[1];
    if (inner.kind == Node::Kind::each) {
      for (FormulaValue& made : each(inner).items) result.items.push_back(bound(node, item, std::move(made)));
      return;
    }
    if (node.parts.size() == 3 && !chosen(node)) return;
    if (++items_ > kMostItems) throw error(node, "makes too many items; at most ", kMostItems, " in a formula");
    result.items.push_back(bound(node, item, value(inner)));
    const auto* number = std::get_if<Sampled>(&item.data);
    if (number == nullptr || !number->is_constant()) return;
    const double place = number->estimate();
    if (result.axis.size() + 1 == result.items.size() && (result.axis.empty() || result.axis.back() < place))
      result.axis.push_back(place);
  }

  std::string_view text_;
  const Place& place_;
  FormulaNames names_;
  const FormulaData& data_;
  std::size_t items_ = 0;  ///< that `for` made so far
};

Error wrong_type(std::string_view what, std::string_view expected, const FormulaValue& value) {
  return Error(cat(what, " needs ", expected, ", got ", value.type()));
}

}  // namespace

std::vector<TruthPart> Truth::all_parts() const {
  return parts.empty() ? std::vector{TruthPart{statement, label, margin, share_bound}} : parts;
}

void Truth::name(const std::string& binding) {
  const auto prepend = [&](std::string& to) { to = cat(binding, to.empty() ? "" : ", ", to); };
  prepend(label);
  for (TruthPart& part : parts) prepend(part.label);
}

Truth related(std::string_view sign, const Sampled& left, const Sampled& right) {
  if (const std::optional<Sampled> difference = sampled_difference(left, right))
    return related(sign, *difference, Sampled::constant(0.0));
  if (sign == "==" || sign == "!=") {
    const Sampled equal = combine(left, right, [](const Bounds& a, const Bounds& b) { return -apart(a, b); });
    return Truth(sign == "==" ? equal : combine(equal, [](const Bounds& margin) { return negated(margin); }));
  }
  const bool strict = sign.size() == 1;
  const bool greater = sign.front() == '>';
  const Sampled &more = greater ? left : right, &less = greater ? right : left;
  Truth truth(combine(more, less, [strict](const Bounds& a, const Bounds& b) { return above(a, b, strict); }));
  if (more.is_share && less.is_constant()) truth.share_bound = less.estimate();
  if (less.is_share && more.is_constant()) truth.share_bound = 1.0 - more.estimate();
  return truth;
}

std::string_view FormulaValue::type() const {
  constexpr std::string_view kTypes[] = {"a number", "a statement", "text", "a list"};
  return kTypes[data.index()];
}

const Sampled& FormulaValue::as_number(std::string_view what) const {
  if (const auto* number = std::get_if<Sampled>(&data)) return *number;
  throw wrong_type(what, "a number", *this);
}

const Truth& FormulaValue::as_truth(std::string_view what) const {
  if (const auto* truth = std::get_if<Truth>(&data)) return *truth;
  throw wrong_type(what, "a statement such as a > b", *this);
}

const std::string& FormulaValue::as_text(std::string_view what) const {
  if (const auto* text = std::get_if<std::string>(&data)) return *text;
  throw wrong_type(what, "a name in quotes", *this);
}

const FormulaList& FormulaValue::as_list(std::string_view what) const {
  if (const auto* list = std::get_if<FormulaList>(&data)) return *list;
  throw wrong_type(what, "a list", *this);
}

std::vector<Sampled> FormulaValue::as_numbers(std::string_view what) const {
  std::vector<Sampled> numbers;
  for (const FormulaValue& item : as_list(what).items) numbers.push_back(item.as_number(what));
  return numbers;
}

Formula::Formula(std::string_view text, const Place& place)
    : text_(text), place_(place), root_(parse_formula(text, place)) {}

bool Formula::calls(std::string_view function) const {
  const auto in = [&](const auto& self, const Node& node) -> bool {
    return (node.kind == Node::Kind::call && node.text == function) ||
           std::ranges::any_of(node.parts, [&](const Node& part) { return self(self, part); });
  };
  return in(in, root_);
}

FormulaValue Formula::evaluate(const FormulaNames& names, const FormulaData& data) const {
  return Evaluator(text_, place_, names, data).value(root_);
}

Formula::Judged Formula::judge(const FormulaNames& names, const FormulaData& data) const {
  Evaluator evaluator(text_, place_, names, data);
  if (root_.kind != Node::Kind::relation) {
    const FormulaValue found = evaluator.value(root_);
    if (!std::holds_alternative<Truth>(found.data))
      throw formula_error(place_, text_, 1, "a claim is a statement such as a > b, this is ", found.type());
    const Truth& truth = std::get<Truth>(found.data);
    return {truth.margin, truth};
  }
  const auto [left, right, truth] = evaluator.related(root_);
  if (!std::holds_alternative<Sampled>(left.data)) return {truth.margin, truth};
  const Sampled& value = std::get<Sampled>(left.data);
  const Sampled& bound = std::get<Sampled>(right.data);
  if (bound.is_constant()) return {value, truth};
  return {minus(value, bound), truth};
}

}  // namespace gust
