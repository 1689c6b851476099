// What is wrong with a law at an instant; asked when something went wrong already.
#pragma once

#include <string>

#include "framework/mechanism/model/marker.h"
#include "framework/mechanism/model/motion_law.h"

namespace lockstep {

/// "the law of drive rz ('bump' of plugin bump) gives nan, 0, 0" or "... threw: its words", where `what` is "the law of
/// drive rz"; "" when the law is finite at t.
LOCKSTEP_API std::string law_fault(const std::string& what, const MotionLaw&, double t);
LOCKSTEP_API std::string law_fault(const std::string& what, const TranslationLaw&, double t);
LOCKSTEP_API std::string law_fault(const std::string& what, const RotationLaw&, double t);

/// The same of the laws that move a marker: "the sliding law of marker 'tool' ...".
LOCKSTEP_API std::string marker_fault(const Marker&, double t);

/// "" for built-in things and the host's own, " of plugin bump" for others.
LOCKSTEP_API std::string of_plugin(const std::string& origin);

}  // namespace lockstep
