// SPDX-License-Identifier: BSD-3-Clause
// A formula of variables, such as the time, evaluated on numbers and jets.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <lockstep/author/jet.h>
#include <lockstep/author/law.h>
#include <lockstep/author/params.h>
#include <lockstep/detail/export.h>
#include "framework/mechanism/expression/quantity.h"

namespace lockstep::expression {

/// A step of a formula: an operation on the results of steps before it.
struct Term {
  Operation operation = Operation::number;  ///< no vector, component, greater or unequal one
  Function function{};
  double value = 0;  ///< of a number; the exponent of a power of one part
  int variable = 0;  ///< of a name
  std::array<int, 3> parts{};
  int n_parts = 0;
  bool decides = false;  ///< by the sign of a number: a comparison, a choice, |a|, min, floor, ...
  LawPtr<MotionLaw> table{};  ///< of table(name, x)
};

/// What a name of a formula stands for: an amount, of variables or constant, or a table.
struct Meaning {
  Amount amount{};            ///< of variables its value means nothing
  int variable = -1;          ///< the first of its variables; -1: constant
  LawPtr<MotionLaw> table{};  ///< of a table; null if dimensions alone are asked for
  bool is_table = false;
  std::optional<Exponents> argument{};  ///< of a table, if it has a unit
  bool is_known = true;                 ///< whether its dimension is known
  bool clash = false;         ///< whether it is a variable and a constant

  /// `with_unit`: whether its unit counts as one that is written in the formula. `named`: of a coordinate of the mechanism.
  static Meaning of_variable(int number, const std::optional<Dimension>& d, bool with_unit = false,
                             bool named = false) {
    Meaning m{.variable = number, .is_known = d.has_value()};
    m.amount.dimension = exponents_of(d.value_or(Dimension{})), m.amount.measured = true;
    m.amount.with_unit = with_unit, m.amount.named = named;
    return m;
  }
};
/// The meaning of the name of a node; null, or ModelError, if there is none.
using Meanings = std::function<const Meaning*(const Node&)>;

/// The variable that holds the value of a call of the motion.
using OfMotion = std::function<int(const Node&)>;

/// A formula compiled once. All numbers are SI. Evaluation allocates nothing and never throws; what has no value is NaN.
/// At an instant at which a comparison meets equality, it holds as it does just afterwards: jets with equal values are
/// compared by their rates.
class LOCKSTEP_API FormulaFunction {
 public:
  FormulaFunction() = default;
  /// `variables` in the order of operator(). Throws ModelError with formula, column and problem.
  FormulaFunction(const std::string& text, const std::vector<std::string>& variables,
                  const std::vector<NamedNumbers>& constants = {});

  /// The number that this node of an expression gives. Without `of_motion` functions of the motion are rejected.
  FormulaFunction(const Expression&, int node, const Meanings&, const OfMotion& of_motion = {});

  const std::string& text() const { return text_; }
  /// Whether it reads this variable.
  bool reads(int variable) const;
  bool is_constant() const;

  /// The value; T: double, Time, a jet.
  template <class T>
  LOCKSTEP_API T operator()(std::span<const T> variables) const;
  /// Appends numbers; if one changes its sign, there is a kink, a jump, a pole or an end of its domain.
  void edges(std::span<const double> variables, std::vector<double>& out) const;

  /// Whether a comparison, |a|, min, max, sign, floor, ceil, round or mod is in it.
  bool has_switches() const { return has_switches_; }
  /// Appends the instants in (t0, t1) at which one of these switches, of a formula whose only variable that counts is
  /// number `time`; those that depend on others switch where they will. Warns, once, where some may be missed; throws
  /// ModelError where there are more than a million.
  void breakpoints(int time, double t0, double t1, std::vector<double>& out) const;

 private:
  std::string text_;
  std::vector<Term> terms_;
  bool has_switches_ = false;
  std::shared_ptr<std::atomic<bool>> warned_;  // of switches that were not found; once, copies included
};

extern template LOCKSTEP_API double FormulaFunction::operator()(std::span<const double>) const;
extern template LOCKSTEP_API Time FormulaFunction::operator()(std::span<const Time>) const;
extern template LOCKSTEP_API Jet<4> FormulaFunction::operator()(std::span<const Jet<4>>) const;
extern template LOCKSTEP_API Jet<8> FormulaFunction::operator()(std::span<const Jet<8>>) const;

/// The constants that an object gives as "parameters": {"R": "20 mm", "A": [0, 0, 1], ...}, tables
/// among them. Throws SceneError.
LOCKSTEP_API std::vector<NamedNumbers> read_constants(const Params&, const std::string& key);

/// The same of the object itself, which stands at `place`; tables have no law. The unit of a table is "Pa of m": of its
/// values, and of its arguments if these have one. Throws SceneError if an axis has units of two dimensions.
LOCKSTEP_API std::vector<NamedNumbers> read_constants(const Value& object, const std::string& place);

/// The key "parameters" of a type with formulas.
LOCKSTEP_API Key constants_key();

}  // namespace lockstep::expression
