// SPDX-License-Identifier: BSD-3-Clause
// Formulas of numbers with units, given in a scene in place of a number or a vector.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include <lockstep/author/params.h>
#include <lockstep/detail/export.h>
#include <lockstep/math.h>
#include "framework/mechanism/expression/expression.h"

namespace lockstep::expression {

/// Exponents of metre, kilogram, second and radian; a root may leave halves.
struct Exponents {
  double m = 0, kg = 0, s = 0, rad = 0;
  bool operator==(const Exponents&) const = default;
};

/// The same as that of a unit.
inline Exponents exponents_of(const Dimension& d) { return {double(d.m), double(d.kg), double(d.s), double(d.rad)}; }

/// An angle times a length is an arc: without the radian.
Exponents settled(Exponents);
/// The dimension of these exponents; nothing if a unit has none of them, fractional or high ones.
std::optional<Dimension> whole(const Exponents&);

/// Between the units of the values and arguments of a table.
inline constexpr std::string_view kOf = " of ";

/// A number or a vector with its dimension.
struct Amount {
  Vec3 v = Vec3::Zero();  ///< SI
  bool is_vector = false;
  Exponents dimension{};
  bool measured = false;   ///< whether units took part; numbers without any are those of their place, in SI
  bool is_zero = false;    ///< a written 0, which is of every dimension
  bool with_unit = false,  ///< in dimension_of(): whether a unit was written, not only variables read
      named = false,       ///< likewise: whether it reads a coordinate of the mechanism by its name
      any = false;         ///< likewise: a plain number times a variable, of unknown dimension

  static Amount number(double x) {
    Amount q;
    q.v[0] = x;
    return q;
  }
};

/// The quantity of a name. Throws ModelError; nullptr for a name that is not known.
using Names = std::function<const Amount*(const std::string&)>;

/// All names that are known.
using Known = std::function<std::vector<std::string>()>;

/// The value of a formula. Lengths and masses are not added, sines are of angles or pure numbers, a product of an angle
/// and a length is an arc, a length. `known`: names for "did you mean". Throws ModelError with formula, column and what
/// is wrong.
LOCKSTEP_API Amount evaluate(const Expression&, const Names&, const Known& known = {});

/// As a scene holds it: a number where no unit took part, else a text such as "0.12 m", of a vector a list of three.
/// Throws ModelError for a dimension that has no unit, and for what is not finite.
LOCKSTEP_API Value value_of(const Amount&);

/// "m", "N m"; "" of a pure number, and of a dimension without a unit.
LOCKSTEP_API std::string unit_of(const Amount&);

/// "0.12 m", "[0, 1, 0] m"; for messages and lists.
LOCKSTEP_API std::string words_of(const Amount&);
/// "a length", "a pure number", "a vector of lengths", ...
LOCKSTEP_API std::string article_name_of(const Amount&);

}  // namespace lockstep::expression
