// SPDX-License-Identifier: BSD-3-Clause
// Private to the room: types of laws, as the registry takes them.
#pragma once

#include <functional>
#include <initializer_list>
#include <utility>
#include <vector>

#include <lockstep/author/law_checks.h>
#include <lockstep/author/params.h>

namespace lockstep {

/// Types of laws of a kind L: name and keys, and what makes a law from parameters checked against them.
template <class L>
struct TypesOf {
  using Maker = std::function<LawPtr<L>(const Params&)>;
  std::vector<std::pair<TypeInfo, Maker>> all;
  void add(TypeInfo info, Maker make) { all.emplace_back(std::move(info), std::move(make)); }
};

struct LawTypes {
  TypesOf<MotionLaw> laws;
  TypesOf<TranslationLaw> translation_laws;
  TypesOf<RotationLaw> rotation_laws;
};

/// A key in the dimension of the law that it is of, or of a rate of that: numbers, inner laws, a formula.
inline Key value_key(const char* name, Form form, Default fallback, const char* help,
                     LawQuantity quantity = LawQuantity::value) {
  const bool numbers = form == Form::number || form == Form::numbers || form == Form::points;
  return {name, form, numbers ? Unit::any : Unit::none, std::move(fallback), help, {}, quantity};
}

/// Throws ParameterError for the first of these keys of a law that is not finite.
inline void require_finite(const char* law, std::initializer_list<std::pair<const char*, double>> keys) {
  for (const auto& [key, value] : keys) require_finite(law, key, value);
}

/// The circular frequency, rad/s, from the one of the keys "omega" and "frequency" that is given.
double omega_of(const Params&);

/// Of each file of the room: adds its types.
using AddTypes = void(LawTypes&);
AddTypes add_constant, add_input, add_ramp, add_sine, add_fourier, add_polynomial, add_rise, add_trapezoid, add_spline,
    add_sequence, add_repeat, add_combine, add_formula, add_translations, add_path, add_rotations, add_spline_rotation;

}  // namespace lockstep
