#include "motionlaws/register.h"

#include "framework/plugin/registry.h"
#include "motionlaws/combine.h"
#include "motionlaws/constant.h"
#include "motionlaws/fourier.h"
#include "motionlaws/polynomial.h"
#include "motionlaws/ramp.h"
#include "motionlaws/repeat.h"
#include "motionlaws/rise.h"
#include "motionlaws/sequence.h"
#include "motionlaws/sine.h"
#include "motionlaws/spline.h"
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
}

}  // namespace lockstep
