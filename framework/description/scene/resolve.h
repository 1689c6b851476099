// SPDX-License-Identifier: BSD-3-Clause
// Parameters, points and formulas of a scene.
#pragma once

#include <lockstep/error.h>
#include <lockstep/scene.h>
#include "framework/description/scene/reading.h"

namespace lockstep {

/// Puts the values of parameters, points and formulas into their places: "=2*crank" becomes "0.2 m", "at": "A" the
/// numbers of point A. Notes them in the scene; without any, the scene stays as it is. Formulas of time and coordinates
/// stay texts and are given the parameters. Throws SceneError with place, key, formula and column.
/// "repeat" and "include" are expanded; the files of the reading are those that include this scene, itself last.
void resolve_formulas(Scene&, SceneReading&);

/// The error with the formula behind each of its lines that is at the place of one.
SceneError told_with_formulas(const Scene&, const SceneError&);

/// Calls f(); a SceneError at the place of a formula gets the formula behind its sentence.
template <class F>
decltype(auto) with_formulas(const Scene& scene, F&& f) {
  if (scene.formulas.empty()) return std::forward<F>(f)();
  try {
    return std::forward<F>(f)();
  } catch (const SceneError& error) {
    throw told_with_formulas(scene, error);
  }
}

}  // namespace lockstep
