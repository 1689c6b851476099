// SPDX-License-Identifier: BSD-3-Clause
// Formulas as text to trees: "=A + crank*[cos(phi), sin(phi), 0]".
#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <lockstep/detail/export.h>
#include "framework/mechanism/params/units.h"

namespace lockstep::expression {

inline constexpr int kMostNesting = 256;  ///< brackets, signs and choices within one another

/// What a node of a formula is.
enum class Operation {
  number,
  name,
  negate,
  add,
  subtract,
  multiply,
  divide,
  power,
  negation,  ///< !a
  less,
  less_equal,
  greater,
  greater_equal,
  equal,
  unequal,
  conjunction,  ///< a && b
  disjunction,  ///< a || b
  choose,       ///< a ? b : c
  call,
  vector,    ///< [a, b, c]
  component  ///< a.x, number 0, 1 or 2 in `index`
};

/// What a function takes: numbers of any dimension, or of one; vectors; points and radii.
enum class Takes { any, pure, angle, alike, vectors, places };
/// The dimension of what it gives: any, that of its arguments, their root or product, ...
enum class Gives { number, any, sign, angle, alike, root, product, times_time, by_time };

/// Name, arguments and dimensions of a function.
struct Signature {
  std::string_view name;
  std::size_t least, most;  ///< arguments
  Takes takes = Takes::pure;
  Gives gives = Gives::number;
  bool decides = false;  ///< by the sign of a number
};
inline constexpr std::size_t kMostArguments = 16;
/// All of them. From "mean" on they are of the motion so far, in columns.
inline constexpr Signature kFunctions[] = {{"sin", 1, 1, Takes::angle},
                                           {"cos", 1, 1, Takes::angle},
                                           {"tan", 1, 1, Takes::angle},
                                           {"asin", 1, 1, Takes::pure, Gives::angle},
                                           {"acos", 1, 1, Takes::pure, Gives::angle},
                                           {"atan", 1, 1, Takes::pure, Gives::angle},
                                           {"atan2", 2, 2, Takes::alike, Gives::angle},
                                           {"sinh", 1, 1},
                                           {"cosh", 1, 1},
                                           {"tanh", 1, 1},
                                           {"sqrt", 1, 1, Takes::any, Gives::root},
                                           {"exp", 1, 1},
                                           {"log", 1, 1},
                                           {"abs", 1, 1, Takes::alike, Gives::alike, true},
                                           {"sign", 1, 1, Takes::any, Gives::sign, true},
                                           {"floor", 1, 1, Takes::pure, Gives::number, true},
                                           {"ceil", 1, 1, Takes::pure, Gives::number, true},
                                           {"round", 1, 1, Takes::pure, Gives::number, true},
                                           {"mod", 2, 2, Takes::alike, Gives::alike, true},
                                           {"min", 2, kMostArguments, Takes::alike, Gives::alike, true},
                                           {"max", 2, kMostArguments, Takes::alike, Gives::alike, true},
                                           {"hypot", 2, kMostArguments, Takes::alike, Gives::alike},
                                           {"norm", 1, 1, Takes::vectors, Gives::alike},
                                           {"dot", 2, 2, Takes::vectors, Gives::product},
                                           {"cross", 2, 2, Takes::vectors, Gives::product},
                                           {"table", 2, 2, Takes::any, Gives::any},
                                           {"meet", 4, 6, Takes::places, Gives::alike},
                                           {"mean", 1, 1, Takes::any, Gives::alike},
                                           {"rms", 1, 1, Takes::any, Gives::alike},
                                           {"integral", 1, 1, Takes::any, Gives::times_time},
                                           {"at", 2, 2, Takes::any, Gives::alike},
                                           {"last", 2, 2, Takes::any, Gives::alike},
                                           {"rate", 1, 1, Takes::any, Gives::by_time}};

/// A function of formulas: Function("sin") is that line of the table; of an unknown name it does not compile.
struct Function {
  int line = 0;
  constexpr Function() = default;
  constexpr explicit Function(const Signature& of) : line(static_cast<int>(&of - kFunctions)) {}
  consteval explicit Function(std::string_view name)
      : Function(*std::ranges::find(kFunctions, name, &Signature::name)) {}
  constexpr auto operator<=>(const Function&) const = default;  // NOLINT(modernize-use-nullptr)
  constexpr const Signature& signature() const { return kFunctions[static_cast<std::size_t>(line)]; }
};

/// A node of a formula; `children` are numbers of nodes before it.
struct Node {
  Operation operation = Operation::number;
  std::size_t at = 0;     ///< where it begins in the text
  double value = 0;       ///< of a number, SI
  Dimension dimension{};  ///< of a number
  bool measured = false;  ///< whether a number has a unit
  std::string name{};
  Function function{};
  int index = 0;
  std::vector<int> children{};
};

/// How a formula writes names.
enum class Naming {
  words,    ///< "A", "rod.to"; of a point, "A.x" is a component
  channels  ///< with points: "B.force_on_p_world.x", "P.x@Q"; in quotes with any characters: 'left wheel.rz'
};

/// A formula. Precedence, from the loosest: ? :, ||, &&, one comparison, + -, * /, signs and !, ^ (from the right),
/// components .x .y .z. A unit follows its number directly, as far as symbols of units go: "9.81 m/s^2". A name
/// with ".at", ".from" or ".to" behind it, "rod.to", is one name: a place of a body. Of channels there are functions of the
/// motion too: min and max of one argument, mean, rms, integral, at, last, rate.
class LOCKSTEP_API Expression {
 public:
  /// Reads a formula, with or without "=" before it. `variables`: names that stand for no unit, so that "2 t" is no two
  /// tonnes, and "1 s/t" a second by t. Throws ModelError with the formula, the column and what was expected.
  explicit Expression(std::string text, std::span<const std::string> variables = {}, Naming = Naming::words);

  const std::string& text() const { return text_; }
  const Node& node(int i) const { return nodes_[i]; }
  int root() const { return static_cast<int>(nodes_.size()) - 1; }
  const std::vector<Node>& nodes() const { return nodes_; }

  /// Throws ModelError: problem at this place of the formula.
  [[noreturn]] void refuse(std::size_t at, const std::string& problem) const;
  [[noreturn]] void refuse(const Node& node, const std::string& problem) const { refuse(node.at, problem); }

 private:
  friend class ExpressionParser;
  std::string text_;
  std::vector<Node> nodes_;
};

/// The names that a formula reads, each once; "rod.to" is one of them, "A" is that of "A.x".
LOCKSTEP_API std::vector<std::string> names_in(const Expression&);

/// The channels that a column reads: the column itself, or the names of its formula "=..."; one without a last part stands
/// for three, with "_x", "_y", "_z". Throws ModelError as Expression.
LOCKSTEP_API std::vector<std::string> channels_in(const std::string& column);

/// What is wrong with a channel in the formula of a law.
inline constexpr const char* kLawOfTime =
    "; a law is a function of t: forces of function_force and joints of formulas read channels";

/// A name without its quotes, which a formula of channels keeps: 'P.x' is a channel even if a point is called P.
inline std::string without_quotes(const std::string& name) {
  return name.starts_with('\'') ? name.substr(1, name.size() - 2) : name;
}

/// Why it may not name a parameter, which is a letter or '_', then letters, digits and '_', and no function or constant;
/// "" if it may.
LOCKSTEP_API std::string name_fault(std::string_view word);

/// Whether a call is of the motion so far, not of an instant: min(x), mean(x), ...
LOCKSTEP_API bool is_of_motion(const Node&);

/// Whether it is true or false.
constexpr bool is_condition(Operation o) { return o >= Operation::negation && o <= Operation::disjunction; }

}  // namespace lockstep::expression
