#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gust/core/error.h"
#include "gust/onnx/operators.h"

// Sums of products that an equation over letters describes, such as "bi,ij->bj". A letter is an axis.

namespace gust {
namespace {

/// A value and the letter of each of its axes.
struct Term {
  OnnxValue value;
  std::string letters;
};

struct Equation {
  std::vector<std::string> terms;
  std::string result;
};

bool holds(std::string_view letters, char letter) { return letters.find(letter) != std::string_view::npos; }

/// Where the equation names no result, it is the letters that occur once, in the order of the alphabet.
std::string letters_once(std::string letters) {
  std::sort(letters.begin(), letters.end());
  std::string once;
  for (const char letter : letters) {
    if (std::count(letters.begin(), letters.end(), letter) == 1) once += letter;
  }
  return once;
}

void check_letters(const OnnxLowering& at, std::string_view letters) {
  for (const char letter : letters) {
    const bool plain = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z');
    if (!plain) at.fail("has an equation with more than letters, commas and '->'; write a letter for every axis");
    if (std::count(letters.begin(), letters.end(), letter) > 1) at.fail("has an equation that takes a diagonal");
  }
}

Equation read_equation(const OnnxLowering& at) {
  std::string text = at.attribute("equation", std::string());
  std::erase(text, ' ');
  const std::size_t arrow = text.find("->");
  Equation equation{.terms = {""}, .result = {}};
  std::string all;
  for (const char c : text.substr(0, arrow)) {
    if (c == ',') {
      equation.terms.emplace_back();
    } else {
      equation.terms.back() += c;
      all += c;
    }
  }
  equation.result = arrow == std::string::npos ? letters_once(all) : text.substr(arrow + 2);
  for (const std::string& term : equation.terms) check_letters(at, term);
  check_letters(at, equation.result);
  const bool known = std::all_of(equation.result.begin(), equation.result.end(), [&](char c) { return holds(all, c); });
  if (!known || equation.terms.size() != at.inputs()) at.fail("has an equation that does not fit its inputs");
  return equation;
}

std::vector<std::size_t> places(std::string_view letters, std::string_view among) {
  std::vector<std::size_t> found;
  for (const char letter : letters) found.push_back(among.find(letter));
  return found;
}

/// The same term with its axes in the order of some letters, which are all of its own.
Term ordered(OnnxLowering& at, const Term& term, const std::string& letters) {
  return {at.transposed(term.value, places(letters, term.letters)), letters};
}

/// What is left where letters that are not needed have been summed over.
Term summed(OnnxLowering& at, const Term& term, std::string_view needed) {
  std::vector<std::size_t> axes;
  Term left{.value = {}, .letters = {}};
  OnnxDims dims;
  for (std::size_t i = 0; i < term.letters.size(); ++i) {
    if (!holds(needed, term.letters[i])) {
      axes.push_back(i);
    } else {
      left.letters += term.letters[i];
      dims.push_back(term.value.dims[i]);
    }
  }
  left.value = axes.empty() ? term.value : at.reshaped(at.reduce(OnnxReduction::kSum, term.value, axes), dims);
  return left;
}

std::string chosen(std::string_view letters, auto keep) {
  std::string kept;
  for (const char letter : letters) {
    if (keep(letter)) kept += letter;
  }
  return kept;
}

OnnxDims sizes(const Term& term, std::string_view letters) {
  OnnxDims dims;
  for (const char letter : letters) dims.push_back(term.value.dims[term.letters.find(letter)]);
  return dims;
}

OnnxDims joined(OnnxDims first, const OnnxDims& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

/// The product of two terms, summed over the letters that both have and the result has not.
class Product {
 public:
  Product(const Term& left, const Term& right, std::string_view result)
      : left_(left),
        right_(right),
        shared_(chosen(left.letters, [&](char c) { return holds(right.letters, c) && holds(result, c); })),
        summed_(chosen(left.letters, [&](char c) { return holds(right.letters, c) && !holds(result, c); })),
        left_only_(chosen(left.letters, [&](char c) { return !holds(right.letters, c); })),
        right_only_(chosen(right.letters, [&](char c) { return !holds(left.letters, c); })) {}

  /// Its letters are those of left and right that the result has, in an order of its own.
  Term make(OnnxLowering& at) const {
    const OnnxDims inner = sizes(left_, summed_);
    if (std::find(inner.begin(), inner.end(), kOnnxBatch) != inner.end()) {
      at.fail("multiplies across the batch; every lane must stay by itself");
    }
    const auto count = static_cast<std::int64_t>(at.elements(inner));
    const bool layer = shared_.empty() && !summed_.empty() && right_.value.constant != nullptr;
    return layer ? as_layer(at, count) : as_sums(at, count);
  }

 private:
  /// Where the right term are weights.
  Term as_layer(OnnxLowering& at, std::int64_t count) const {
    const OnnxDims outer = sizes(left_, left_only_);
    const OnnxDims outputs = sizes(right_, right_only_);
    const OnnxValue weights = at.as_floats(ordered(at, right_, summed_ + right_only_).value);
    const std::vector<float>& numbers = weights.constant->floats;
    const OnnxValue from = at.reshaped(ordered(at, left_, left_only_ + summed_).value, joined(outer, {count}));
    const OnnxValue product =
        at.dense(from, Buffer<float>(numbers.begin(), numbers.end()), std::vector<float>(at.elements(outputs), 0.0f));
    return {at.reshaped(product, joined(outer, outputs)), left_only_ + right_only_};
  }

  Term as_sums(OnnxLowering& at, std::int64_t count) const {
    const OnnxDims both = sizes(left_, shared_);
    const OnnxDims outer = sizes(left_, left_only_);
    const OnnxDims outputs = sizes(right_, right_only_);
    const auto ones = [](const OnnxDims& dims) { return OnnxDims(dims.size(), 1); };
    const OnnxDims rows = joined(joined(joined(both, outer), ones(outputs)), {count});
    const OnnxDims columns = joined(joined(joined(both, ones(outer)), outputs), {count});
    const OnnxValue left = at.reshaped(ordered(at, left_, shared_ + left_only_ + summed_).value, rows);
    const OnnxValue right = at.reshaped(ordered(at, right_, shared_ + right_only_ + summed_).value, columns);
    const OnnxValue pairs = at.combine(OnnxArithmetic::kMul, left, right);
    const OnnxValue sums = at.reduce(OnnxReduction::kSum, pairs, {pairs.dims.size() - 1});
    return {at.reshaped(sums, joined(joined(both, outer), outputs)), shared_ + left_only_ + right_only_};
  }

  const Term& left_;
  const Term& right_;
  std::string shared_;
  std::string summed_;
  std::string left_only_;
  std::string right_only_;
};

void check_sizes(const OnnxLowering& at, const std::vector<Term>& terms) {
  std::map<char, std::int64_t> known;
  for (const Term& term : terms) {
    if (term.letters.size() != term.value.dims.size()) at.fail("has an equation that does not fit its inputs");
    if (term.value.integral()) at.fail("multiplies integers; cast them to float32 first");
    for (std::size_t i = 0; i < term.letters.size(); ++i) {
      const std::int64_t size = term.value.dims[i];
      if (known.emplace(term.letters[i], size).first->second == size) continue;
      at.fail(cat("has inputs of different sizes along '", term.letters[i], "'"));
    }
  }
}

void lower_einsum(OnnxLowering& at) {
  const Equation equation = read_equation(at);
  std::vector<Term> terms;
  for (std::size_t i = 0; i < at.inputs(); ++i) terms.push_back({at.input(i), equation.terms[i]});
  check_sizes(at, terms);
  Term product = summed(at, terms[0], equation.result + (terms.size() > 1 ? terms[1].letters : ""));
  if (terms.size() > 1) {
    const Term second = summed(at, terms[1], equation.result + product.letters);
    const bool weights_first = product.value.constant != nullptr;
    product = weights_first ? Product(second, product, equation.result).make(at)
                            : Product(product, second, equation.result).make(at);
  }
  at.set_output(0, ordered(at, product, equation.result).value);
}

constexpr OnnxOperator kEinsum[] = {{"Einsum", 1, 2, lower_einsum}};

}  // namespace

std::span<const OnnxOperator> onnx_einsum_operators() { return kEinsum; }

}  // namespace gust
