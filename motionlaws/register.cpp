#include "motionlaws/register.h"

#include "framework/description/registry/registry.h"
#include "motionlaws/combine.h"
#include "motionlaws/constant.h"
#include "motionlaws/fourier.h"
#include "motionlaws/path.h"
#include "motionlaws/polynomial.h"
#include "motionlaws/ramp.h"
#include "motionlaws/repeat.h"
#include "motionlaws/rise.h"
#include "motionlaws/rotations.h"
#include "motionlaws/sequence.h"
#include "motionlaws/sine.h"
#include "motionlaws/spline.h"
#include "motionlaws/spline_rotation.h"
#include "motionlaws/translations.h"
#include "motionlaws/trapezoid.h"

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
