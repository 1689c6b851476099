// Heights of markers along the normal of a plane, in which slots have the world's axes at the start. Laws that stay in the
// plane keep them.
#pragma once

#include <cmath>

#include <lockstep/body.h>
#include <lockstep/force.h>
#include <lockstep/math.h>
#include <lockstep/relative.h>

namespace lockstep {

/// Of a marker, and of the mass centre of its slot, m; of a fixed body, the world's origin.
struct Heights {
  Heights(const Marker& m, const MarkerFrame& frame, Plane plane) {
    const Vec3 x = (m.body->home * m.local).x;
    center = x[plane.n] - frame.u0[plane.n];
    marker = center + frame.at(0).u[plane.n];
    rounding = kParallel * x.norm() + 1e-15;
  }
  double marker, center, rounding;
};

/// Whether a force at P has no lever arm along the normal on the slot of another marker, S or P itself.
inline bool has_no_arm(const Heights& P, const Heights& other, const MarkerFrame& frame) {
  return frame.slot == kGround || std::abs(P.marker - other.center) <= P.rounding + other.rounding;
}

/// Whether a force at P has no lever arm on the bodies of P and S.
inline bool has_no_arms(const MarkerForce& force, const MarkerFrame& P, const MarkerFrame& S, Plane plane) {
  const Heights p(force.p(), P, plane);
  return has_no_arm(p, p, P) && (!force.s() || has_no_arm(p, Heights(*force.s(), S, plane), S));
}

}  // namespace lockstep
