#include "framework/links/curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/support/error.h"
#include "framework/support/text.h"

namespace lockstep {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// What the user's parameter measures is unknown; these names say no unit.
std::vector<Quantity> of_curve() { return {{"s", ""}, {"rate", "1/s"}}; }

template <class Function, class Memory>
double seen_on(const Function& function, const Inputs& in, Memory memory, int k) {
  const Time s = function.seen(in, memory, [](const auto& phi, const LockCoords<Time>& y) {
    TranslationValue at;
    return phi.curve.parameter(y, phi.curve.frame(y.memory[0]), at);
  });
  return k == 0 ? s.v : s.d;
}

}  // namespace

CurvePoint::Frame CurvePoint::frame(double s_last) const {
  Frame f;
  f.t = path_->at(s_last).v.normalized();
  int least = 0;  // the axis that is most nearly normal to t
  f.t.cwiseAbs().minCoeff(&least);
  f.n1 = cross(f.t, Vec3(Vec3::Unit(least))).normalized();
  f.n2 = cross(f.t, f.n1);
  return f;
}

double CurvePoint::in_plane(const Vec3& t, const Vec3& rho, double s) const {
  double last = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 50; ++i) {
    const TranslationValue c = path_->at(s);
    const double step = t.dot(rho - c.x) / t.dot(c.v);
    if (!std::isfinite(step)) return kNaN;
    s += step;
    const double small = 4 * std::numeric_limits<double>::epsilon() * std::max(1.0, std::abs(s));
    if (std::abs(step) <= small || (std::abs(step) < 1e-10 * std::max(1.0, std::abs(s)) && std::abs(step) >= last))
      return s;
    last = std::abs(step);
  }
  return kNaN;
}

double CurvePoint::nearest(const Vec3& rho) const {
  double s = near_;
  for (int i = 0; i < 200; ++i) {  // (1/2)|rho - c|^2 falls; Gauss-Newton where its second derivative is none
    const TranslationValue c = path_->at(s);
    const Vec3 g = rho - c.x;
    const double full = c.v.squaredNorm() - c.a.dot(g), slope = full > 0 ? full : c.v.squaredNorm();
    double step = c.v.dot(g) / slope;
    if (!std::isfinite(step)) return kNaN;
    for (int half = 0; half < 40 && (rho - path_->at(s + step).x).norm() > g.norm() * (1 + 1e-15); ++half) step *= 0.5;
    s += step;
    if (std::abs(step) <= 1e-14 * std::max(1.0, std::abs(s))) return s;
  }
  return kNaN;
}

void CurvePoint::at_home(const std::string& link, const LockCoords<Time>& y) const {
  const double s = nearest(Vec3(y.x.v, y.y.v, y.z.v));
  if (std::isfinite(s)) return;
  throw ModelError("link '" + link + "': no point of its path near s = " + brief(near_) +
                   " is nearest to P at the start; let \"near\" say where on the path P begins");
}

void CurvePoint::begin(std::span<double> z, const LockCoords<Time>& y) const {
  z[0] = nearest(Vec3(y.x.v, y.y.v, y.z.v)), z[1] = z[2] = 0;
}

void CurvePoint::remember(std::span<double> z, const LockCoords<Time>& y) const {
  TranslationValue at;
  const Time s = parameter(y, frame(y.memory[0]), at);
  z[0] = s.v, z[1] = s.d, z[2] = y.t.v;
}

PointOnCurve::PointOnCurve(std::string name, Marker& p, Marker& s, LawPtr<TranslationLaw> path, double near)
    : PhiLock(std::move(name), p, s, Mask::none, OnCurve{CurvePoint(std::move(path), near)}) {
  if (!phi().curve.path()) throw ModelError("link '" + this->name() + "': no path was given");
}

std::vector<Quantity> PointOnCurve::quantities() const { return of_curve(); }
double PointOnCurve::quantity(int k, const Inputs& in) const { return seen_on(function(), in, memory(in), k); }

TypeInfo PointOnCurve::info() {
  return {"point_on_curve",
          "origin of P on a space curve c(s) fixed to S; free: moving along it, all turns",
          {{"path", Form::translation_law, Unit::length, "", "c(s), m, S axes: a translation law whose time is s"},
           {"near", Form::number, Unit::none, "0", "an s near which P begins"}}};
}

std::unique_ptr<Lock> PointOnCurve::make(const Site& site, const Params& p) {
  return std::make_unique<PointOnCurve>(site.name, site.p(), site.s(), p.translation_law("path"), p.number("near"));
}

PathFollower::PathFollower(std::string name, Marker& p, Marker& s, LawPtr<TranslationLaw> path,
                           LawPtr<RotationLaw> turn, double near)
    : PhiLock(std::move(name), p, s, Mask::none, OnPath{CurvePoint(std::move(path), near), std::move(turn)}) {
  if (!phi().curve.path()) throw ModelError("link '" + this->name() + "': no path was given");
  if (!phi().turn) throw ModelError("link '" + this->name() + "': no turn of the axes along its path was given");
}

std::vector<Quantity> PathFollower::quantities() const { return of_curve(); }
double PathFollower::quantity(int k, const Inputs& in) const { return seen_on(function(), in, memory(in), k); }

TypeInfo PathFollower::info() {
  return {"path_follower",
          "P follows a path c(s) with axes q(s), both fixed to S; free: moving along it",
          {{"path", Form::translation_law, Unit::length, "", "c(s), m, S axes: a translation law whose time is s"},
           {"turning", Form::rotation_law, Unit::angle, "", "q(s), S axes: a rotation law whose time is s"},
           {"near", Form::number, Unit::none, "0", "an s near which P begins"}}};
}

std::unique_ptr<Lock> PathFollower::make(const Site& site, const Params& p) {
  return std::make_unique<PathFollower>(site.name, site.p(), site.s(), p.translation_law("path"),
                                        p.rotation_law("turning"), p.number("near"));
}

}  // namespace lockstep
