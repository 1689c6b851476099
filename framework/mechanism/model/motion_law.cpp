#include "framework/mechanism/model/motion_law.h"

namespace lockstep {

MotionLaw::~MotionLaw() = default;
TranslationLaw::~TranslationLaw() = default;
RotationLaw::~RotationLaw() = default;

void MotionLaw::breakpoints(double, double, std::vector<double>&) const {}
void TranslationLaw::breakpoints(double, double, std::vector<double>&) const {}
void RotationLaw::breakpoints(double, double, std::vector<double>&) const {}

}  // namespace lockstep
