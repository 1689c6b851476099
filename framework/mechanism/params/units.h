// SPDX-License-Identifier: BSD-3-Clause
// Units of measurement in texts: "12 mm", "1200 rpm", "0.3 g/cm^3". (Boost.Units works at compile time and reads no
// text.)
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <lockstep/author/params.h>

namespace lockstep {

/// "length", "angular speed", ...; "number" for Unit::none.
LOCKSTEP_API std::string name_of(Unit);

/// Those of a dimension: all but Unit::none and Unit::any.
LOCKSTEP_API std::vector<Unit> units();

/// "a length", "an angle", ...
LOCKSTEP_API std::string article_name_of(Unit);

/// The SI unit in which a number without a unit is read: "m", "rad/s", ...; "" for Unit::none and Unit::any.
LOCKSTEP_API std::string si_unit(Unit);

/// Why a text with a unit is no value of what is measured in the SI unit `symbol`, "" for a pure number; "" if it is.
LOCKSTEP_API std::string misfit(const std::string& text, std::string_view symbol);

/// A valid text: "12 mm", "1200 rpm", ...; "" for Unit::none.
LOCKSTEP_API std::string example_of(Unit);

/// The quantity in a text: `value` in SI when `problem` is empty, otherwise the reason of the error.
struct Measured {
  double value = 0;
  std::string problem;  ///< `"12 mmm": unknown unit "mmm"; ...`
};

/// Number and unit of `text`, which must be of the dimension `unit`. A unit is a product of powers with at most one run
/// of divisors: "N m/rad", "kg m^2", "m/s/s", "g/cm^3". Symbols: m g s N Nm J W Hz rad Pa bar l with n u m c d h k M G before
/// them; deg, rev, turn, rpm, min, h, t, in, ft, kgf, hp, psi. Independent of the locale. With `per_second`, of that dimension per second, to
/// this power. Of Unit::none is a number with the unit "1", as formulas give it.
LOCKSTEP_API Measured read_quantity(std::string_view text, Unit unit, int per_second = 0);

/// x of this unit, in SI.
LOCKSTEP_API Measured in_si(double x, std::string_view unit);

/// Exponents of metre, kilogram, second and radian. The radian counts: a torque is not a torsional stiffness.
struct Dimension {
  int m = 0, kg = 0, s = 0, rad = 0;
  bool operator==(const Dimension&) const = default;
};

/// The dimension of a unit such as "N/mm"; nothing if `unit` is none.
LOCKSTEP_API std::optional<Dimension> dimension_of(std::string_view unit);

/// The dimension of a unit of scenes; without exponents for Unit::none and Unit::any.
LOCKSTEP_API Dimension dimension_of(Unit);

/// The dimension of a text with a unit, "12 mm"; without exponents where it has none.
LOCKSTEP_API Dimension dimension_of_text(std::string_view text);

/// "a length", "a quantity in m^2"; "a pure number" without exponents.
LOCKSTEP_API std::string article_name_of(const Dimension&);

/// The SI unit, as read_quantity() reads it: "m", "N/m", "kg m^4"; "1" without exponents.
LOCKSTEP_API std::string si_unit(const Dimension&);

}  // namespace lockstep
