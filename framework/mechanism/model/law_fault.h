// What is wrong with a law at an instant; asked once something went wrong.
#pragma once

#include <string>

#include "framework/mechanism/model/marker.h"
#include "framework/mechanism/model/motion_law.h"

namespace lockstep {

/// "the law of drive rz ('bump' of plugin bump) gives nan, 0, 0" or "... threw: its words", where `what` is "the law of
/// drive rz"; "" when the law is finite at t, and for no law.
LOCKSTEP_API std::string law_fault(const std::string& what, const LawPtr<MotionLaw>&, double t);
LOCKSTEP_API std::string law_fault(const std::string& what, const LawPtr<TranslationLaw>&, double t);
LOCKSTEP_API std::string law_fault(const std::string& what, const LawPtr<RotationLaw>&, double t);

/// The same of the laws that move a marker: "the sliding law of marker 'tool' ...".
LOCKSTEP_API std::string marker_fault(const Marker&, double t);

}  // namespace lockstep
