// What links of marker pairs ask at setup.
#pragma once

#include <string>

#include "framework/mechanism/lock/marker_frame.h"

namespace lockstep {

/// Throws ModelError when one of the markers is on a particle, whose turn the link would hold by `rows` ("e1", "phi").
LOCKSTEP_API void refuse_particles(const std::string& link, const std::string& rows, const Marker& p, const Marker& s);

/// P seen from S in the reference poses of their bodies, the markers' own laws at t = 0 included. P and S are p and s,
/// folded into their slots.
LOCKSTEP_API Pose pose_at_start(const Marker& p, const Marker& s, const MarkerFrame& P, const MarkerFrame& S);

}  // namespace lockstep
