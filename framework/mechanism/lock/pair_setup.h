// SPDX-License-Identifier: BSD-3-Clause
// What joints of pairs of markers check and measure at setup.
#pragma once

#include <string>

#include <lockstep/author/relative.h>

namespace lockstep {

/// Throws ModelError if one of the markers is on a particle, whose rotation the rows `rows` ("e1", "phi") hold.
void refuse_particles(const std::string& link, const std::string& rows, const Marker& p, const Marker& s);

/// Pose of p seen from s with their bodies at home, including the markers' own laws at t = 0. P and S are p and s as
/// frames of their slots.
Pose pose_at_start(const Marker& p, const Marker& s, const MarkerFrame& P, const MarkerFrame& S);

}  // namespace lockstep
