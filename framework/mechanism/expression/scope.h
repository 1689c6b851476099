// SPDX-License-Identifier: BSD-3-Clause
// What the names of a formula stand for, with their dimensions.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/detail/export.h>
#include "framework/mechanism/expression/function.h"
#include "framework/mechanism/expression/quantity.h"

namespace lockstep::expression {

/// The names of formulas: variables, constants and tables, and those that are found if a formula reads them. A vector A
/// has the components "A.x", "A.y" and "A.z".
class LOCKSTEP_API Scope {
 public:
  /// Finds a number by its name. Three of one vector, with "_x", "_y" and "_z" behind it, have variables in a row.
  /// Throws ModelError if there is none.
  using Others = std::function<Meaning(const std::string&)>;

  explicit Scope(Others others = {}) : others_(std::move(others)) {}

  void add(const std::string& name, const Meaning&);
  /// A variable by its number.
  void add(const std::string& name, int variable, const std::optional<Dimension>& dimension) {
    add(name, Meaning::of_variable(variable, dimension));
  }
  void add(const std::vector<NamedNumbers>&);

  /// What a name means; null: it is not known already.
  const Meaning* find(const std::string& name);
  std::vector<std::string> names() const;  ///< those that are known already, for messages
  /// The number that a node gives. Throws ModelError with formula, column and problem.
  FormulaFunction compiled(const Expression&, int node, const OfMotion& = {});
  /// The dimension of a node of a formula that is compiled; nothing if it reads a name of unknown dimension. Of each
  /// choice both sides are looked at, nothing is out of range, and the radian is the number 1 in sums and comparisons, and
  /// before functions of pure numbers. What variables and plain numbers make without a unit is a number in SI; a plain
  /// number times what varies may be of any dimension, as 3 in sin(3 t). The values of the result mean nothing. `strict`: a
  /// plain number times what has a unit has that unit. Throws ModelError as evaluate(), with `hint` behind what is wrong.
  std::optional<Amount> dimension_of(const Expression&, int node, const std::string& hint, bool strict);
  /// Checks a formula that is compiled, if it has a unit, or reads a constant that was given with one; all others are of
  /// numbers in SI. `value`: the dimension of what takes its value, if that is known. The radian counts as 1, a written
  /// 0 is of every dimension, a plain number that is a factor of what varies too (3 in L sin(3 t)), and what variables
  /// and plain numbers make without a unit is in SI. Nothing is checked if a name of unknown dimension is read. Throws
  /// ModelError with the formula, the column and both dimensions.
  void check(const Expression&, const std::optional<Dimension>& value);

 private:
  using Entry = std::pair<std::string, Meaning>;
  const Meaning& of(const Expression&, const Node&);
  void find_vector(const std::string& name);

  Others others_;
  std::deque<Entry> entries_;
};

}  // namespace lockstep::expression
