// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/expression/expression.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/foundation/support/at_end.h"

namespace lockstep::expression {
namespace {

// Those that may be called: of columns, of the motion too.
std::span<const Signature> functions_of(Naming naming) {
  return std::span<const Signature>(kFunctions)
      .first(naming == Naming::channels ? std::size(kFunctions) : Function("mean").line);
}

const Signature* signature(std::string_view name, Naming naming) {
  for (const Signature& s : functions_of(naming))
    if (s.name == name) return &s;
  return nullptr;
}

// "sin", "cos", ..., then "pi".
std::vector<std::string> names_of_functions(Naming naming) {
  std::vector<std::string> names;
  for (const Signature& s : functions_of(naming)) names.emplace_back(s.name);
  names.emplace_back("pi");
  return names;
}

struct Binary {
  std::string_view sign;
  Operation operation;
  int level;  // 1 binds loosest
};
// Longer signs first: "<=" before "<".
constexpr std::array<Binary, 12> kBinary{{{"||", Operation::disjunction, 1},
                                          {"&&", Operation::conjunction, 2},
                                          {"<=", Operation::less_equal, 3},
                                          {">=", Operation::greater_equal, 3},
                                          {"==", Operation::equal, 3},
                                          {"!=", Operation::unequal, 3},
                                          {"<", Operation::less, 3},
                                          {">", Operation::greater, 3},
                                          {"+", Operation::add, 4},
                                          {"-", Operation::subtract, 4},
                                          {"*", Operation::multiply, 5},
                                          {"/", Operation::divide, 5}}};
constexpr int kComparison = 3, kSigns = 6, kChain = 64;
constexpr std::array<std::string_view, 3> kPlacesOfBodies{"at", "from", "to"};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool begins_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || static_cast<unsigned char>(c) >= 0x80;
}
bool in_name(char c) { return begins_name(c) || is_digit(c); }
// Where the name that begins at `from` ends.
std::size_t end_of_name(std::string_view text, std::size_t from) {
  while (from < text.size() && in_name(text[from])) ++from;
  return from;
}

}  // namespace

// Recursive descent; every descent counts against kMostNesting.
class ExpressionParser {
 public:
  ExpressionParser(Expression& e, std::span<const std::string> variables, Naming naming)
      : e_(e), text_(e.text_), variables_(variables), naming_(naming) {
    skip_blanks();
    if (at_ < text_.size() && text_[at_] == '=') ++at_;
  }

  void parse() {
    choice();
    skip_blanks();
    if (at_ == text_.size()) return;
    if (text_[at_] == ')' || text_[at_] == ']') fail(at_, "no bracket is open here; remove it");
    if (text_[at_] == ',') fail(at_, "a comma separates arguments only; the decimal separator is a point");
    fail(at_, "expected an operator or the end of the formula");
  }

 private:
  [[noreturn]] void fail(std::size_t at, const std::string& problem) const { e_.refuse(at, problem); }
  void skip_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  }
  char next() {
    skip_blanks();
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(std::string_view sign) {
    skip_blanks();
    if (!std::string_view(text_).substr(at_).starts_with(sign)) return false;
    at_ += sign.size();
    return true;
  }
  void expect(std::string_view sign, std::size_t opened, const char* what) {
    if (take(sign)) return;
    fail(at_, "expected \"" + std::string(sign) + "\" for the " + what + " at column " + std::to_string(opened + 1));
  }

  // One level deeper, as long as the result lives.
  auto descend() {
    if (++depth_ > kMostNesting)
      fail(at_, "it is nested deeper than " + std::to_string(kMostNesting) + "; define parts as parameters");
    return AtEnd([this] { --depth_; });
  }

  int put(Operation operation, std::size_t at, std::vector<int> children = {}) {
    Node node;
    node.operation = operation, node.at = at, node.children = std::move(children);
    e_.nodes_.push_back(std::move(node));
    return e_.root();
  }
  Node& last() { return e_.nodes_.back(); }

  int choice() {
    const auto deeper = descend();
    const int condition = binary(1);
    skip_blanks();
    const std::size_t at = at_;
    if (!take("?")) return condition;
    const int yes = choice();
    expect(":", at, "\"?\"");
    return put(Operation::choose, at, {condition, yes, choice()});
  }

  const Binary* sign_at(int level) {
    skip_blanks();
    for (const Binary& b : kBinary)
      if (std::string_view(text_).substr(at_).starts_with(b.sign)) return b.level == level ? &b : nullptr;
    return nullptr;
  }

  // A chain of operations from the left. Behind the first kChain it is a tree of as few levels as possible, so that what
  // walks over a long formula does not descend once for each part: a - b + c is a + ((-b) + c), a / b * c is
  // a * ((1 / b) * c).
  int binary(int level) {
    if (level == kSigns) return signs();
    int left = binary(level + 1);
    std::vector<std::pair<int, int>> rest;  // trees and their levels, which fall
    int length = 0;
    for (const Binary* b = sign_at(level); b != nullptr; b = sign_at(level)) {
      const std::size_t at = at_;
      at_ += b->sign.size();
      const int right = binary(level + 1);
      if (++length <= kChain) {
        left = put(b->operation, at, {left, right});
      } else {
        rest.emplace_back(as_part(b->operation, at, right), 0);
        while (rest.size() > 1 && rest[rest.size() - 2].second == rest.back().second) join_last(rest, level, at);
      }
      if (level == kComparison && sign_at(level) != nullptr)
        fail(at_, "one comparison follows another; write \"a < b && b < c\"");
    }
    while (rest.size() > 1) join_last(rest, level, at_);
    return rest.empty() ? left : put(joining(level), at_, {left, rest[0].first});
  }
  static Operation joining(int level) {
    return std::ranges::find(kBinary, level, &Binary::level)->operation;  // ||, &&, ..., +, *
  }
  int as_part(Operation o, std::size_t at, int node) {
    if (o == Operation::subtract) return put(Operation::negate, at, {node});
    if (o != Operation::divide) return node;
    const int one = put(Operation::number, at);
    last().value = 1;
    return put(Operation::divide, at, {one, node});
  }
  void join_last(std::vector<std::pair<int, int>>& trees, int level, std::size_t at) {
    const auto [right, levels] = trees.back();
    trees.pop_back();
    trees.back() = {put(joining(level), at, {trees.back().first, right}), std::max(levels, trees.back().second) + 1};
  }

  int signs() {
    const std::size_t at = (skip_blanks(), at_);
    const bool no = next() == '!', minus = next() == '-';
    if (!no && !minus && next() != '+') return power();
    const auto deeper = descend();
    ++at_;
    const int of = signs();
    return no ? put(Operation::negation, at, {of}) : minus ? put(Operation::negate, at, {of}) : of;
  }

  int power() {
    const int base = components();
    skip_blanks();
    const std::size_t at = at_;
    if (!take("^")) return base;
    if (next() == '*' || next() == '^') fail(at_, "expected an exponent");
    const auto deeper = descend();
    return put(Operation::power, at, {base, signs()});
  }

  int components() {
    int of = primary();
    if (naming_ == Naming::words && e_.node(of).operation == Operation::name && place_of_body()) of = e_.root();
    while (at_ + 1 < text_.size() && text_[at_] == '.') {
      const std::size_t at = at_;
      const std::size_t k = std::string_view("xyz").find(text_[at_ + 1]);
      const bool longer = at_ + 2 < text_.size() && in_name(text_[at_ + 2]);
      if (k == std::string_view::npos || longer)
        fail(at,
             !variables_.empty() && variables_.front() == "t"
                 ? std::string("a channel cannot be read here") + kLawOfTime
                 : "expected \".x\", \".y\" or \".z\", a component of a point" +
                       std::string(e_.node(of).operation == Operation::name
                                       ? "; or \".at\", \".from\", \".to\" of a body. Channels are read by columns, "
                                         "function_force and function joints"
                                       : ""));
      at_ += 2;
      of = put(Operation::component, at, {of});
      last().index = static_cast<int>(k);
    }
    return of;
  }

  // "rod.from" is a name.
  bool place_of_body() {
    for (const std::string_view place : kPlacesOfBodies) {
      const std::size_t end = at_ + 1 + place.size();
      if (at_ >= text_.size() || text_[at_] != '.' || text_.compare(at_ + 1, place.size(), place) != 0) continue;
      if (end < text_.size() && in_name(text_[end])) continue;
      last().name += text_.substr(at_, end - at_);
      at_ = end;
      return true;
    }
    return false;
  }

  int primary() {
    const char c = next();
    const std::size_t at = at_;
    if (is_digit(c) || (c == '.' && at_ + 1 < text_.size() && is_digit(text_[at_ + 1]))) return number();
    if (begins_name(c)) return name();
    if (c == '\'' && naming_ == Naming::channels) return quoted_name();
    if (take("(")) {
      const int inside = choice();
      expect(")", at, "bracket");
      return inside;
    }
    if (take("[")) return vector(at);
    if (c == '\0') fail(at, "it ends where a number, a name or a bracket is expected");
    fail(at, c == '*' && at > 0 && text_[at - 1] == '*' ? "write a power with \"^\""
                                                        : "expected a number, a name or a bracket");
  }

  int vector(std::size_t at) {
    std::vector<int> items = list("]", at, "list");
    if (items.size() != 3) fail(at, "a list of " + std::to_string(items.size()) + "; a vector has 3 components");
    return put(Operation::vector, at, std::move(items));
  }

  std::vector<int> list(std::string_view end, std::size_t opened, const char* what) {
    std::vector<int> items;
    if (take(end)) return items;
    do {
      items.push_back(choice());
    } while (take(","));
    expect(end, opened, what);
    return items;
  }

  std::string_view word() { return std::string_view(text_).substr(at_, end_of_name(text_, at_) - at_); }

  int put_name(std::size_t at, std::string_view called) {
    put(Operation::name, at);
    last().name = called;
    return e_.root();
  }

  // A channel: words with points between them, and with "@" and more of them in a pair's.
  std::string_view path() {
    std::size_t end = at_ + word().size();
    while (end + 1 < text_.size() && (text_[end] == '.' || text_[end] == '@') && in_name(text_[end + 1]))
      end = end_of_name(text_, end + 1);
    return std::string_view(text_).substr(at_, end - at_);
  }

  int quoted_name() {
    const std::size_t at = at_, end = text_.find('\'', at + 1);
    if (end == std::string::npos) fail(at, "the name in quotes does not end");
    at_ = end + 1;
    return put_name(at, std::string_view(text_).substr(at, at_ - at));
  }

  int name() {
    const std::size_t at = at_;
    const std::string called(naming_ == Naming::channels ? path() : word());
    at_ += called.size();
    if (next() != '(') return put_name(at, called);
    const Signature* s = signature(called, naming_);
    if (s == nullptr)
      fail(at, "unknown function \"" + called + "\"" + text::suggestion(called, names_of_functions(naming_)));
    const std::size_t open = at_++;
    std::vector<int> arguments = list(")", open, "bracket");
    const Function f(*s);
    const bool of_motion = naming_ == Naming::channels && (f == Function("min") || f == Function("max"));
    if (arguments.size() < (of_motion ? 1 : s->least) || arguments.size() > s->most)
      fail(at, called + " takes " + std::to_string(s->least) + (s->most > s->least ? " or more" : "") +
                   (s->most == 1 ? " argument" : " arguments") + ", and " + std::to_string(arguments.size()) +
                   (arguments.size() == 1 ? " is given" : " are given"));
    if (f == Function("meet") && arguments.size() > 4) name_side(e_.nodes_[arguments[4]]);
    put(Operation::call, at, std::move(arguments));
    last().function = f;
    return e_.root();
  }
  // left is 1, right -1, as the fifth argument of meet() only.
  static void name_side(Node& n) {
    if (n.operation != Operation::name || (n.name != "left" && n.name != "right")) return;
    n.operation = Operation::number, n.value = n.name == "left" ? 1 : -1;
  }

  bool is_variable(std::string_view word) const {
    return std::find(variables_.begin(), variables_.end(), word) != variables_.end();
  }

  // Length of the unit that begins at `from`: its symbol, power, and what follows by blanks or "/"; 0 where none does.
  // It ends before a variable: "1 s/t" is 1 s by t.
  std::size_t unit_length(std::size_t from) const {
    const std::string_view rest = std::string_view(text_).substr(from);
    std::size_t whole = 0, end = 0;
    for (bool first = true;; first = false) {
      std::size_t begin = whole;
      while (begin < rest.size() && is_blank(rest[begin])) ++begin;
      if (!first && begin < rest.size() && rest[begin] == '/') {
        ++begin;
        while (begin < rest.size() && is_blank(rest[begin])) ++begin;
      } else if (!first && begin == whole) {
        break;
      }
      if (begin == rest.size() || !begins_name(rest[begin])) break;
      end = end_of_name(rest, begin);
      if (is_variable(rest.substr(begin, end - begin))) break;
      if (begin > 0 && rest.substr(begin, end - begin) == "l") break;  // "10 N/l" divides by a length
      const bool power =
          end + 1 < rest.size() && rest[end] == '^' &&
          (is_digit(rest[end + 1]) || (rest[end + 1] == '-' && end + 2 < rest.size() && is_digit(rest[end + 2])));
      if (power)
        for (end += 2; end < rest.size() && is_digit(rest[end]);) ++end;
      if (!lockstep::dimension_of(rest.substr(0, end))) break;
      whole = end;
    }
    return whole;
  }

  int number() {
    const std::size_t at = at_;
    double x = 0;
    const char* begin = text_.data() + at_;
    const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), x);
    if (error == std::errc::result_out_of_range)
      fail(at, "the number is beyond the range of numbers (1e-308 to 1e308)");
    at_ += end - begin;
    put(Operation::number, at);
    const std::size_t node = static_cast<std::size_t>(e_.root()), behind = at_;
    last().value = x;
    if (!begins_name(next())) return at_ = behind, e_.root();
    unit(node);
    return e_.root();
  }

  void unit(std::size_t of) {
    const std::string first(word());
    const bool variable = is_variable(first);
    const std::size_t length = variable ? 0 : unit_length(at_);
    if (length == 0)
      fail(at_, variable ? "\"" + first + "\" follows a number; write a product with \"*\""
                         : "unknown unit \"" + first + "\"; a product is written with \"*\"");
    Node& node = e_.nodes_[of];
    const std::string unit = text_.substr(at_, length);
    const Measured si = in_si(node.value, unit);
    if (!si.problem.empty()) fail(node.at, si.problem);
    node.value = si.value, node.dimension = *lockstep::dimension_of(unit), node.measured = true;
    at_ += length;
    if (next() == '^')
      fail(at_, "the power of a unit follows it directly, as in \"m/s^2\"; for a power of the whole, use brackets");
  }

  Expression& e_;
  const std::string& text_;
  std::span<const std::string> variables_;
  Naming naming_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

Expression::Expression(std::string text, std::span<const std::string> variables, Naming naming)
    : text_(std::move(text)) {
  ExpressionParser(*this, variables, naming).parse();
}

void Expression::refuse(std::size_t at, const std::string& problem) const {
  constexpr std::size_t kMost = 60, kRest = 24;
  const auto plain = [](std::string part) {
    for (char& c : part)
      if (static_cast<unsigned char>(c) < 0x20) c = ' ';
    return part;
  };
  const auto cut = [](std::string_view s, std::size_t most) {  // not inside of a character
    if (s.size() <= most) return std::string(s);
    while (most > 0 && (static_cast<unsigned char>(s[most]) & 0xC0) == 0x80) --most;
    return std::string(s.substr(0, most)) + "...";
  };
  std::size_t column = 1;
  for (std::size_t i = 0; i < std::min(at, text_.size()); ++i)
    column += (static_cast<unsigned char>(text_[i]) & 0xC0) != 0x80 ? 1 : 0;
  const std::string rest = at < text_.size() ? cut(std::string_view(text_).substr(at), kRest) : "";
  throw ModelError("formula \"" + plain(cut(text_, kMost)) + "\", column " + std::to_string(column) +
                   (rest.empty() || at == 0 ? "" : " (\"" + plain(rest) + "\")") + ": " + problem);
}

std::vector<std::string> names_in(const Expression& e) {
  std::vector<std::string> names;
  for (const Node& node : e.nodes())
    if (node.operation == Operation::name && std::find(names.begin(), names.end(), node.name) == names.end())
      names.push_back(node.name);
  return names;
}

std::vector<std::string> channels_in(const std::string& column) {
  if (!column.starts_with('=')) return {column};
  std::vector<std::string> all;
  for (const std::string& name : names_in(Expression(column, {}, Naming::channels)))
    for (const char* axis : {"", "_x", "_y", "_z"}) all.push_back(without_quotes(name) + axis);
  return all;
}

std::string name_fault(std::string_view word) {
  if (signature(word, Naming::words) != nullptr || word == "pi") return "it is a function or constant of formulas";
  const bool plain = !word.empty() && begins_name(word.front()) && end_of_name(word, 0) == word.size();
  return plain ? "" : "a name has letters, digits and '_', and does not begin with a digit";
}

bool is_of_motion(const Node& n) {
  const bool least_or_most = n.function == Function("min") || n.function == Function("max");
  return n.operation == Operation::call &&
         (n.function >= Function("mean") || (least_or_most && n.children.size() == 1));
}

}  // namespace lockstep::expression
