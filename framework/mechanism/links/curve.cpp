// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/couplings.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <lockstep/author/params.h>
#include <lockstep/detail/phi_function.h>
#include "framework/mechanism/links/checks.h"
#include "framework/mechanism/links/curve_functions.h"

namespace lockstep {
namespace {

constexpr double kNoPoint = std::numeric_limits<double>::quiet_NaN();

// No units: the parameter of the user's curve may be anything.
std::vector<Quantity> of_curve() { return {{"s", "", "parameter of the curve at P"}, {"rate", "1/s", "rate of s"}}; }

double seen_on(const CurvePoint& curve, const LockCoords<Time>& y, int k) {
  TranslationValue at;
  const Time s = curve.parameter(y, curve.frame(y.memory), at);
  return k == 0 ? s.v : s.d;
}

Key path_key() {
  Key key{"path", Form::translation_law, Unit::length, kRequired,
          "the curve c(s), S axes: a translation law with s in place of time"};
  key.of_time = false;
  return key;
}
Key near_key() { return {"near", Form::number, Unit::none, 0, "a value of s near the start of P"}; }

}  // namespace

// `like` made normal to the tangent; where that leaves little, a normal from the axis furthest from the tangent.
Vec3 CurvePoint::normal(double s, const Vec3& like) const {
  const Vec3 t = path_->at(s).v.normalized(), n = like - t.dot(like) * t;
  if (n.norm() > 0.1) return n.normalized();
  int least = 0;
  t.cwiseAbs().minCoeff(&least);
  return cross(t, Vec3(Vec3::Unit(least))).normalized();
}

CurvePoint::Frame CurvePoint::frame(const double* memory) const {
  const Vec3 t = path_->at(memory[0]).v.normalized(), n1(memory[3], memory[4], memory[5]);
  return {t, n1, cross(t, n1)};
}

double CurvePoint::in_plane(const Vec3& t, const Vec3& rho, double s) const {
  double last = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 50; ++i) {
    const TranslationValue c = path_->at(s);
    const double step = t.dot(rho - c.x) / t.dot(c.v);
    if (!std::isfinite(step)) return kNoPoint;
    s += step;
    const double small = 4 * std::numeric_limits<double>::epsilon() * std::max(1.0, std::abs(s));
    if (std::abs(step) <= small || (std::abs(step) < 1e-10 * std::max(1.0, std::abs(s)) && std::abs(step) >= last))
      return s;
    last = std::abs(step);
  }
  return kNoPoint;
}

double CurvePoint::nearest(const Vec3& rho, double s) const {
  for (int i = 0; i < 200; ++i) {  // Newton on (1/2)|rho - c|^2; Gauss-Newton where its curvature is not positive
    const TranslationValue c = path_->at(s);
    const Vec3 g = rho - c.x;
    const double full = c.v.squaredNorm() - c.a.dot(g), slope = full > 0 ? full : c.v.squaredNorm();
    double step = c.v.dot(g) / slope;
    if (!std::isfinite(step)) return kNoPoint;
    for (int half = 0; half < 40 && (rho - path_->at(s + step).x).norm() > g.norm() * (1 + 1e-15); ++half) step *= 0.5;
    s += step;
    if (std::abs(step) <= 1e-14 * std::max(1.0, std::abs(s))) return s;
  }
  return kNoPoint;
}

void CurvePoint::initialise(const std::string& link, const LockCoords<Time>& y) const {
  const std::string who = "joint '" + link + "': ";
  double s = kNoPoint;
  try {
    s = nearest(Vec3(y.x.v, y.y.v, y.z.v), near_);
  } catch (const ModelError& end) {
    throw ModelError(who + "no nearest point on its path at the start, searched from s = " + text::brief(near_) + ": " +
                     end.what());
  }
  if (!std::isfinite(s))
    throw ModelError(who + "no point of its path near s = " + text::brief(near_) +
                     " is nearest to P at the start; set \"near\" to a value of s near the start of P");
}

void CurvePoint::reset(std::span<double> z, const LockCoords<Time>& y) const {
  z[0] = nearest(Vec3(y.x.v, y.y.v, y.z.v), near_), z[1] = z[2] = 0;
  Eigen::Map<Vec3>(z.data() + 3) = normal(z[0], Vec3::Zero());
}

// The nearest point, not the one in the plane of the last tangent: off the curve the latter would move with every call.
void CurvePoint::accept_step(std::span<double> z, const LockCoords<Time>& y) const {
  const Vec3 rho(y.x.v, y.y.v, y.z.v), rate(y.x.d, y.y.d, y.z.d);
  const double s = nearest(rho, expected(y));
  const TranslationValue c = path_->at(s);
  z[0] = s, z[1] = c.v.dot(rate) / (c.v.squaredNorm() - c.a.dot(rho - c.x)), z[2] = y.t.v;
  Eigen::Map<Vec3>(z.data() + 3) = normal(s, Vec3(y.memory[3], y.memory[4], y.memory[5]));
}

PointOnCurve::PointOnCurve(std::string name, Marker& p, Marker& s, LawPtr<TranslationLaw> path, double near)
    : FunctionLock(name, p, s, Mask::none, rows_of(OnCurve(CurvePoint(given(name, std::move(path), "path"), near)))) {}

std::vector<Quantity> PointOnCurve::quantities() const { return of_curve(); }
double PointOnCurve::quantity(int k, const Inputs& in) const {
  return seen_on(phi_of<OnCurve>(function()).curve, function().along_motion(in, memory(in))[0], k);
}

TypeInfo PointOnCurve::info() {
  return {"point_on_curve",
          "origin of P on a space curve c(s) fixed to S; degrees of freedom left: motion along it, all rotations",
          {path_key(), near_key()}};
}

std::unique_ptr<Lock> PointOnCurve::make(const Attachment& attachment, const Params& p) {
  return std::make_unique<PointOnCurve>(attachment.name, attachment.p(), attachment.s(), p.translation_law("path"),
                                        p.number("near"));
}

PathFollower::PathFollower(std::string name, Marker& p, Marker& s, Options options)
    : FunctionLock(name, p, s, Mask::none,
                   rows_of(OnPath{CurvePoint(given(name, std::move(options.path), "path"), options.near),
                                  given(name, std::move(options.turn), "law for the axes along its path")})) {}

std::vector<Quantity> PathFollower::quantities() const { return of_curve(); }
double PathFollower::quantity(int k, const Inputs& in) const {
  return seen_on(phi_of<OnPath>(function()).curve, function().along_motion(in, memory(in))[0], k);
}

TypeInfo PathFollower::info() {
  Key turning{"turning", Form::rotation_law, Unit::angle, kRequired,
              "the axes q(s), S axes: a rotation law with s in place of time"};
  turning.of_time = false;
  return {"path_follower",
          "P follows a path c(s) with axes q(s), both fixed to S; degrees of freedom left: motion along it",
          {path_key(), std::move(turning), near_key()}};
}

std::unique_ptr<Lock> PathFollower::make(const Attachment& attachment, const Params& p) {
  return std::make_unique<PathFollower>(
      attachment.name, attachment.p(), attachment.s(),
      Options{.path = p.translation_law("path"), .turn = p.rotation_law("turning"), .near = p.number("near")});
}

}  // namespace lockstep
