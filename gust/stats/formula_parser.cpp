#include "gust/stats/formula_parser.h"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>

namespace gust {
namespace {

using Node = Formula::Node;

constexpr std::size_t kDeepest = 64;     // nesting; a claim that a person wrote has less than ten
constexpr std::size_t kLongest = 1'000;  // operators side by side

struct Token {
  enum class Kind { number, text, word, sign, end };
  Kind kind = Kind::end;
  std::string text = {};
  double number = 0;
  std::size_t column = 1;
};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

class Lexer {
 public:
  Lexer(std::string_view text, const Place& place) : text_(text), place_(place) {}

  /// How far it has read.
  std::size_t at() const { return at_; }

  Token next() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n')) ++at_;
    Token token{.column = at_ + 1};
    if (at_ == text_.size()) return token;
    const char first = text_[at_];
    if (is_digit(first) || first == '.') return number(token);
    if (first == '\'' || first == '"') return quoted(token);
    if (is_letter(first)) return word(token);
    return sign(token);
  }

 private:
  Token number(Token token) {
    const char* begin = text_.data() + at_;
    const auto [end, problem] = std::from_chars(begin, text_.data() + text_.size(), token.number);
    if (problem != std::errc() || !std::isfinite(token.number))
      throw formula_error(place_, text_, token.column, "expected a finite number");
    at_ += static_cast<std::size_t>(end - begin);
    token.kind = Token::Kind::number;
    return token;
  }

  Token quoted(Token token) {
    const std::size_t end = text_.find(text_[at_], at_ + 1);
    if (end == std::string_view::npos) throw formula_error(place_, text_, token.column, "the quoted text has no end");
    token.kind = Token::Kind::text;
    token.text = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return token;
  }

  Token word(Token token) {
    const std::size_t begin = at_;
    while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]))) ++at_;
    token.kind = Token::Kind::word;
    token.text = text_.substr(begin, at_ - begin);
    return token;
  }

  Token sign(Token token) {
    // The longer one first where one begins with the other.
    constexpr std::array<std::string_view, 15> kSigns = {">=", "<=", "==", "!=", ">", "<", "+", "-",
                                                         "*",  "/",  "(",  ")",  "[", "]", ","};
    for (const std::string_view sign : kSigns) {
      if (!text_.substr(at_).starts_with(sign)) continue;
      at_ += sign.size();
      token.kind = Token::Kind::sign;
      token.text = sign;
      return token;
    }
    std::size_t length = 1;  // in bytes, of the character
    while (at_ + length < text_.size() && (text_[at_ + length] & 0xC0) == 0x80) ++length;
    throw formula_error(place_, text_, token.column, "'", text_.substr(at_, length), "' means nothing here");
  }

  std::string_view text_;
  const Place& place_;
  std::size_t at_ = 0;
};

/// Recursive descent, one function a level of precedence: or, and, not, relations, sums, products, the rest.
class Parser {
 public:
  Parser(std::string_view text, const Place& place) : text_(text), place_(place), lexer_(text, place) { advance(); }

  Node whole() {
    Node node = either();
    if (token_.kind != Token::Kind::end) throw error("expected nothing more");
    return node;
  }

 private:
  template <class... Parts>
  Error error(const Parts&... parts) const {
    return formula_error(place_, text_, token_.column, parts...);
  }

  void advance() {
    end_ = lexer_.at();
    token_ = lexer_.next();
  }
  /// What rule() reads, with its place in the text.
  template <class Rule>
  Node placed(Rule rule) {
    const std::size_t begin = token_.column - 1;
    Node node = rule();
    if (node.end == 0) {
      node.begin = begin;
      node.end = end_;
    }
    return node;
  }
  bool is_sign(std::string_view sign) const { return token_.kind == Token::Kind::sign && token_.text == sign; }
  bool is_word(std::string_view word) const { return token_.kind == Token::Kind::word && token_.text == word; }
  bool take(std::string_view what) {
    if (!is_sign(what) && !is_word(what)) return false;
    advance();
    return true;
  }
  void expect(std::string_view what) {
    if (!take(what)) throw error("expected '", what, "'");
  }

  /// parts joined by any of the operators, the left one first.
  template <class Part>
  Node chain(Node::Kind kind, std::initializer_list<std::string_view> operators, Part part) {
    Node node = part();
    for (std::size_t length = 1;; ++length) {
      const Token token = token_;
      bool found = false;
      for (const std::string_view sign : operators) found = found || take(sign);
      if (!found) return node;
      if (length > kLongest) throw error("too long; at most ", kLongest, " operators side by side");
      std::vector<Node> parts;
      parts.push_back(std::move(node));
      parts.push_back(part());
      node = {kind, token.text, 0, std::move(parts), token.column};
    }
  }

  void deeper() {
    if (++depth_ > kDeepest) throw error("nested too deep; at most ", kDeepest, " levels");
  }

  Node either() {
    deeper();
    Node node = placed([this] { return chain(Node::Kind::logic, {"or"}, [this] { return both(); }); });
    --depth_;
    return node;
  }
  Node both() {
    return chain(Node::Kind::logic, {"and"}, [this] { return placed([this] { return negation(); }); });
  }
  Node negation() {
    bool negated = false;
    const std::size_t column = token_.column;
    while (take("not")) negated = !negated;
    Node node = relation();
    return negated ? Node{Node::Kind::logic, "not", 0, {std::move(node)}, column} : node;
  }
  Node relation() {
    Node left = sum();
    const Token token = token_;
    for (const std::string_view sign : {">=", ">", "<=", "<", "==", "!="}) {
      if (!take(sign)) continue;
      std::vector<Node> parts;
      parts.push_back(std::move(left));
      parts.push_back(sum());
      return {Node::Kind::relation, token.text, 0, std::move(parts), token.column};
    }
    return left;
  }
  Node sum() {
    return chain(Node::Kind::arithmetic, {"+", "-"}, [this] { return product(); });
  }
  Node product() {
    return chain(Node::Kind::arithmetic, {"*", "/"}, [this] { return signed_one(); });
  }
  Node signed_one() {
    bool negative = false;
    const std::size_t column = token_.column;
    while (take("-")) negative = !negative;
    Node node = primary();
    if (!negative) return node;
    std::vector<Node> parts(1);  // the number 0
    parts.push_back(std::move(node));
    return {Node::Kind::arithmetic, "-", 0, std::move(parts), column};
  }

  Node primary() {
    const Token token = token_;
    if (token.kind == Token::Kind::number || token.kind == Token::Kind::text) {
      advance();
      const bool number = token.kind == Token::Kind::number;
      return {number ? Node::Kind::number : Node::Kind::text, token.text, token.number, {}, token.column};
    }
    if (take("(")) {
      Node node = either();
      expect(")");
      return node;
    }
    if (take("[")) return items("]", {Node::Kind::list, "", 0, {}, token.column});
    if (token.kind != Token::Kind::word) throw error("expected a number, a 'text', a name or a function");
    advance();
    if (take("(")) return items(")", {Node::Kind::call, token.text, 0, {}, token.column});
    return {Node::Kind::name, token.text, 0, {}, token.column};
  }

  /// The items of a list or the arguments of a function, up to the bracket that closes them.
  Node items(std::string_view close, Node of) {
    if (take(close)) return of;
    Node first = either();
    if (is_word("for")) {
      Node each = clauses(std::move(first));
      expect(close);
      if (of.kind == Node::Kind::list) return each;
      of.parts.push_back(std::move(each));
      return of;
    }
    of.parts.push_back(std::move(first));
    while (take(",")) of.parts.push_back(either());
    expect(close);
    return of;
  }

  /// What follows an item: for NAME in LIST [for …] [if FILTER]. The last variable changes fastest.
  Node clauses(Node item) {
    deeper();
    const std::size_t column = token_.column;
    expect("for");
    if (token_.kind != Token::Kind::word) throw error("expected a name after 'for'");
    Node each{Node::Kind::each, token_.text, 0, {}, column};
    advance();
    expect("in");
    each.parts.push_back(sum());
    if (is_word("for")) {
      each.parts.push_back(clauses(std::move(item)));
      return each;
    }
    each.parts.push_back(std::move(item));
    if (take("if")) each.parts.push_back(either());
    return each;
  }

  std::string_view text_;
  const Place& place_;
  Lexer lexer_;
  Token token_;
  std::size_t end_ = 0;  ///< of the token before the one at hand
  std::size_t depth_ = 0;
};

}  // namespace

Formula::Node parse_formula(std::string_view text, const Place& place) { return Parser(text, place).whole(); }

}  // namespace gust
