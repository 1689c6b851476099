// SPDX-License-Identifier: BSD-3-Clause
#include "motionlaws/register.h"

#include <lockstep/author/registry.h>
#include <lockstep/frame_laws.h>
#include <lockstep/laws.h>
#include <lockstep/splines.h>
#include "motionlaws/formula.h"

namespace lockstep {

void register_motion_laws(Registry& registry) {
  auto& laws = registry.laws;
  laws.add<Constant>();
  laws.add<Ramp>();
  laws.add<Sine>();
  laws.add<Fourier>();
  laws.add<Polynomial>();
  laws.add<Poly345>();
  laws.add<Cycloid>();
  laws.add<HarmonicRise>();
  laws.add<Trapezoid>();
  laws.add<Spline>();
  laws.add<Sequence>();
  laws.add<Repeat>();
  laws.add<SumLaw>();
  laws.add<ProductLaw>();
  laws.add<ScaledLaw>();
  laws.add<ShiftedLaw>();
  laws.add<FormulaLaw>();

  auto& translations = registry.translation_laws;
  translations.add<ConstantTranslation>();
  translations.add<ComponentsLaw>();
  translations.add<AlongLaw>();
  translations.add<PathLaw>();

  auto& rotations = registry.rotation_laws;
  rotations.add<ConstantRotation>();
  rotations.add<AxisRotation>();
  rotations.add<SplineRotation>();
  rotations.add<RotationProduct>();
}

}  // namespace lockstep
