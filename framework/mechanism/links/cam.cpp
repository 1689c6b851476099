// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/couplings.h>

#include <cmath>
#include <limits>

#include <lockstep/author/params.h>
#include <lockstep/detail/phi_function.h>
#include "framework/mechanism/links/cam_functions.h"
#include "framework/mechanism/links/checks.h"

namespace lockstep {
namespace {

constexpr double kNoContact = std::numeric_limits<double>::quiet_NaN();

// Newton's method for f(u) = 0 near u: steps of at most 0.3 rad, and of 0.1 rad where f' has the wrong sign.
template <class F>
double root(double u, F&& f) {
  double last = 1;
  for (int i = 0; i < 60; ++i) {
    const auto [value, slope] = f(u);  // slope < 0 at the root sought
    const double step = slope < 0 ? -value / slope : std::copysign(0.1, value);
    if (!std::isfinite(step)) return kNoContact;
    u += std::clamp(step, -0.3, 0.3);
    if (std::abs(step) < 1e-15 || (std::abs(step) < 1e-12 && std::abs(step) >= std::abs(last))) return u;
    last = step;
  }
  return std::abs(last) < 1e-11 ? u : kNoContact;
}

Key radius_key() {
  Key key{"radius", Form::law, Unit::length, kRequired, "radius of the cam over its angle, from 0 to 2 pi rad"};
  key.of_time = false;
  return key;
}

CamProfile profile_of(const std::string& link, LawPtr<MotionLaw> radius) {
  return CamProfile(given(link, std::move(radius), "law for its radius"));
}

}  // namespace

CamProfile::Point CamProfile::at(double u) const {
  const LawValue r = radius_->at(u - kTwoPi * std::floor(u / kTwoPi));
  const Vec2 out(std::cos(u), std::sin(u)), on(-out[1], out[0]);
  Point p;
  p.c = r.y * out;
  p.c1 = r.yd * out + r.y * on;
  p.c2 = (r.ydd - r.y) * out + 2 * r.yd * on;
  const double speed = p.c1.norm();
  p.t = p.c1 / speed;
  p.n = Vec2(p.t[1], -p.t[0]);
  p.curvature = (p.c1[0] * p.c2[1] - p.c1[1] * p.c2[0]) / (speed * speed * speed);
  return p;
}

double CamProfile::foot(const Vec2& p, double u) const {
  return root(u, [&](double at_u) {
    const Point at_it = at(at_u);
    return std::pair{at_it.c1.dot(p - at_it.c), at_it.c2.dot(p - at_it.c) - at_it.c1.squaredNorm()};
  });
}

double CamProfile::facing(double alpha, double u) const {
  const Vec2 n(std::cos(alpha), std::sin(alpha));
  return root(u, [&](double at_u) {
    const Point at_it = at(at_u);
    return std::pair{at_it.c1.dot(n), at_it.c2.dot(n)};
  });
}

void CamProfile::check(const std::string& link, double roller) const {
  const std::string who = "joint '" + link + "': ";
  constexpr int kPoints = 720;
  for (int i = 0; i <= kPoints; ++i) {
    const double u = kTwoPi * i / kPoints;
    const double r = radius_->at(std::min(u, kTwoPi)).y;
    const std::string where = " at " + text::brief(360.0 * i / kPoints) + " deg";
    if (!(r > 0) || !std::isfinite(r))
      throw ModelError(who + "the radius of its cam is " + text::brief(r) + " m" + where + "; it must be above zero");
    const double k = at(u).curvature;
    if (std::isinf(roller) ? !(k > 0) : !(1 + k * roller > 0))
      throw ModelError(who + "its cam has a curvature of " + text::brief(k) + " 1/m" + where +
                       (std::isinf(roller)
                            ? "; a flat face needs a convex profile: use cam_roller"
                            : "; a roller of " + text::brief(roller) + " m does not fit into that hollow"));
  }
  const LawValue first = radius_->at(0), last = radius_->at(kTwoPi);
  if (std::abs(last.y - first.y) > 1e-9 * first.y || std::abs(last.yd - first.yd) > 1e-6 * first.y)
    throw ModelError(who + "the profile of its cam does not close: radius " + text::brief(first.y) + " m and slope " +
                     text::brief(first.yd) + " m/rad at 0, " + text::brief(last.y) + " and " + text::brief(last.yd) +
                     " after a revolution; make the law repeat after 2 pi");
}

void RollerOnCam::reset(std::span<double> z, PhiCoords y) const {
  const CamProfile::Vec2 p(y[0].x.v, y[0].y.v);  // start from the nearest point of the profile
  double best = std::numeric_limits<double>::infinity();
  const double psi = std::atan2(p[1], p[0]);
  for (int i = -180; i < 180; ++i)
    if (const double d = (profile.at(psi + kTwoPi * i / 360).c - p).norm(); d < best) best = d, z[0] = kTwoPi * i / 360;
  z[0] = foot(p, z[0]) - psi;
}

void RollerOnCam::accept_step(std::span<double> z, PhiCoords y) const {
  const CamProfile::Vec2 p(y[0].x.v, y[0].y.v);
  z[0] = foot(p, y[0].memory[0]) - std::atan2(p[1], p[0]);
}

void FaceOnCam::reset(std::span<double> z, PhiCoords y) const {
  const double alpha = angle_of_normal(y[0]).v;
  z[0] = profile.facing(alpha, alpha) - alpha;  // a convex profile has one such point
}

void FaceOnCam::accept_step(std::span<double> z, PhiCoords y) const {
  const double alpha = angle_of_normal(y[0]).v;
  z[0] = profile.facing(alpha, alpha + y[0].memory[0]) - alpha;
}

CamRoller::CamRoller(std::string name, Marker& p, Marker& s, LawPtr<MotionLaw> radius, double roller)
    : FunctionLock(name, p, s, Mask::none,
                   rows_of(RollerOnCam(profile_of(name, std::move(radius)),
                                       checked(name, "roller", roller, roller >= 0, " m; it must not be negative")))) {}

TypeInfo CamRoller::info() {
  return {"cam_roller",
          "roller with centre P on a disc cam about z of S; degrees of freedom left: all but one",
          {radius_key(), {"roller", Form::number, Unit::length, 0, "radius of the roller; 0: a knife edge"}}};
}

std::unique_ptr<Lock> CamRoller::make(const Attachment& attachment, const Params& p) {
  return std::make_unique<CamRoller>(attachment.name, attachment.p(), attachment.s(), p.law("radius"),
                                     p.number("roller"));
}

CamFlat::CamFlat(std::string name, Marker& p, Marker& s, LawPtr<MotionLaw> radius)
    : FunctionLock(name, p, s, Mask::none, rows_of(FaceOnCam(profile_of(name, std::move(radius))))) {}

TypeInfo CamFlat::info() {
  return {"cam_flat",
          "flat face at P, normal y of P, on a convex disc cam about z of S; degrees of freedom left: all but one",
          {radius_key()}};
}

std::unique_ptr<Lock> CamFlat::make(const Attachment& attachment, const Params& p) {
  return std::make_unique<CamFlat>(attachment.name, attachment.p(), attachment.s(), p.law("radius"));
}

}  // namespace lockstep
