// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/detail/counted_angle.h>

#include <algorithm>

#include <lockstep/author/relative.h>
#include "framework/foundation/math/limits.h"

namespace lockstep {

namespace {

// Whole turns beyond (-pi, pi].
double turns_of(double angle) { return std::ceil(angle / kTwoPi - 0.5); }
double nearest(double angle, double about) { return angle - kTwoPi * turns_of(angle - about); }

}  // namespace

CountedAngle::~CountedAngle() = default;

double CountedAngle::of_pose(const Inputs& in) const {
  const double known = in.angles.empty() ? NAN : in.angles[number_];
  return std::isnan(known) ? angle(in) : known;
}

double CountedAngle::value(const Inputs& in) const { return nearest(of_pose(in), rest(in.s)) + kTwoPi * turns(in.s); }

double CountedAngle::rate(const Inputs& in) const {
  const double known = in.angle_rates.empty() ? NAN : in.angle_rates[number_];
  return std::isnan(known) ? rate_of_pose(in) : known;
}

void CountedAngle::accept(const Inputs& in, VecX& s) const {
  double *own = s.data() + first(), &phi = own[0], &n = own[1], &doubt = own[2];
  const double pose = nearest(of_pose(in), phi), turns = turns_of(pose);
  doubt = std::max(doubt, std::abs(pose - phi));
  phi = pose - kTwoPi * turns, n += turns;
}

void CountedAngle::set(const Inputs& in, double about, VecX& s) const {
  double *own = s.data() + first(), &phi = own[0], &n = own[1];
  const double pose = nearest(of_pose(in), about);
  n = turns_of(pose), phi = pose - kTwoPi * n;
}

TurnAngle::TurnAngle(const Marker& p, const Marker& s, int axis)
    : CountedAngle(name_of(p, s, axis)), p_(p), s_(s), axis_(axis) {}

std::string TurnAngle::name_of(const Marker& p, const Marker& s, int axis) {
  return "turn of '" + p.name + "' about " + "xyz"[axis] + " of '" + s.name + "'";
}

void TurnAngle::setup() { P_ = MarkerFrame(p_), S_ = MarkerFrame(s_); }

std::optional<CountedAngle::Turn> TurnAngle::turn() const {
  if (P_.rotation_law || S_.rotation_law) return {};
  return Turn{P_.slot, S_.slot, rotation(S_.at(0).q).col(axis_)};
}

Quat TurnAngle::relative(const Inputs& in) const {
  return conjugate(in.slot(S_.slot).e * S_.at(in.t).q) * (in.slot(P_.slot).e * P_.at(in.t).q);
}

double TurnAngle::angle(const Inputs& in) const {
  const Quat e = relative(in);
  return 2.0 * std::atan2(e.vec()[axis_], e.w);
}

double TurnAngle::rate_of_pose(const Inputs& in) const {
  const MarkerOn<double> P = marker_on(P_, in), S = marker_on(S_, in);
  const Quat e = relative(in);
  const Vec3 ev = e.vec(), w = S.A().transpose() * Vec3(P.w() - S.w());
  const double e0 = e.w, ek = ev[axis_], n = e0 * e0 + ek * ek;
  return n > kRoundOff ? (e0 * e0 * w[axis_] + e0 * cross(w, ev)[axis_] + ek * w.dot(ev)) / n : 0.0;
}

const CountedAngle& AngleCounter::count(const Marker& p, const Marker& s, int axis, bool coupled) {
  CountedAngle& angle = count(std::make_unique<TurnAngle>(p, s, axis));
  if (coupled) angle.couple();
  return angle;
}

}  // namespace lockstep
