// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/forces/formula_force.h"

#include <array>
#include <cmath>

#include <lockstep/error.h>
#include "framework/mechanism/expression/dimensions.h"
#include "framework/mechanism/expression/evaluate.h"
#include "framework/mechanism/forces/effort.h"

namespace lockstep {

CoordinateForce::CoordinateForce(std::string name, Marker& p, Marker& s, Axis axis, expression::FormulaFunction f)
    : FormulaForce(std::move(name), p, &s), axis_(axis), f_(std::move(f)) {}

const TypeInfo& CoordinateForce::info() {
  static const TypeInfo info{
      "function_force",
      "force or torque by a formula of one coordinate q of P relative to S, its rate qd and time t",
      {{"force", Form::text, Unit::none, kOptional,
        "force on P along an axis of S, N: \"=-800*q - 20*qd + 5*sin(t)\", q in m, all numbers in SI or all with "
        "units"},
       {"torque", Form::text, Unit::none, kOptional,
        "or torque on P about an axis of S, N m; q in rad, revolutions counted"},
       {"coordinate",
        Form::choice,
        Unit::none,
        kOptional,
        "coordinate q of P relative to S; default: z for a force, rz for a torque",
        {"x", "y", "z", "rx", "ry", "rz"}},
       expression::constants_key()}};
  return info;
}

std::unique_ptr<Force> CoordinateForce::make(const Attachment& attachment, const Params& k) {
  const std::vector<expression::Constant> constants = expression::read_constants(k, "parameters");
  if (k.has("force") == k.has("torque"))
    k.refuse(k.has("force") ? "torque" : "",
             k.has("force") ? "\"force\" is given as well; remove one of the two" : "give \"force\" or \"torque\"");
  const bool torque = k.has("torque");
  const char* key = torque ? "torque" : "force";
  const Axis axis = k.has("coordinate") ? axis_from(k.text("coordinate")) : torque ? Axis::rz : Axis::z;
  if (is_rotation(axis) != torque)
    k.refuse("coordinate", torque ? "a torque is about rx, ry or rz" : "a force is along x, y or z");
  expression::FormulaFunction f;
  try {
    f = expression::FormulaFunction(k.text(key), {"q", "qd", "t"}, constants);
    expression::check_dimensions(k.text(key),
                                 {{"q", dimension_of(torque ? Unit::angle : Unit::length)},
                                  {"qd", dimension_of(torque ? Unit::angular_speed : Unit::speed)},
                                  {"t", dimension_of(Unit::time)}},
                                 constants, dimension_of(torque ? Unit::torque : Unit::force));
  } catch (const ModelError& error) {
    k.refuse(key, error.what());
  }
  return std::make_unique<CoordinateForce>(attachment.name, p_of(attachment, k), s_of(attachment, k), axis,
                                           std::move(f));
}

void CoordinateForce::setup() {
  if (is_rotation(axis_)) require_turning(p(), "rotates");
  require_turning(*s(), is_rotation(axis_) ? "rotates" : "has a lever arm on");
  MarkerForce::setup();
}

bool CoordinateForce::stays_in_plane(Plane plane) const {
  const auto fits = [&](const MarkerFrame& frame) { return axis_stays_in_plane(axis_, frame.A0.row(plane.n)); };
  return markers_stay_in(plane, false) && fits(S_) && (is_rotation(axis_) ? fits(P_) : has_no_arms(plane));
}

void CoordinateForce::count_angles(AngleCounter& counter) {
  if (is_rotation(axis_)) angle_ = &counter.count(p(), *s(), axis_index(axis_) % 3);
}

void CoordinateForce::breakpoints(double t0, double t1, std::vector<double>& out) const {
  MarkerForce::breakpoints(t0, t1, out);
  f_.breakpoints(2, t0, t1, out);
}

std::vector<Quantity> CoordinateForce::quantities() const {
  const bool turn = is_rotation(axis_);
  return {{"coordinate", turn ? "rad" : "m", "coordinate q of P relative to S"},
          {"rate", turn ? "rad/s" : "m/s", "its rate qd"},
          {turn ? "torque" : "force", turn ? "N m" : "N", "value of the formula, on P's body"},
          power()};
}

namespace {

// With its rate in time, by which a formula decides where what it compares is equal: t > 0.25 holds at 0.25 s.
Time with_rate(double x, double rate) { return {x, rate, 0.0}; }
double without_rate(const Time& x) { return x.v; }
template <int N>
Jet<N> with_rate(const Jet<N, double, NoMotion>& x, double rate) {
  Jet<N> y(x.v);
  y.d = rate, y.g = x.g;
  return y;
}
template <int N>
Jet<N, double, NoMotion> without_rate(const Jet<N>& x) {
  Jet<N, double, NoMotion> y(x.v);
  y.g = x.g;
  return y;
}

}  // namespace

template <class T, class Load>
void CoordinateForce::act(const Ends<T>& at, Load& load) const {
  using std::atan2;
  const int k = axis_index(axis_) % 3;
  const Vec3T<T> a_S = at.S.axis(k);
  const auto effort = [&](const T& q, const T& rate) {
    if (!f_.has_switches()) {
      const std::array<T, 3> v = {q, rate, T(at.t)};
      return f_(std::span<const T>(v));
    }
    using Moving = decltype(with_rate(q, 0));
    const std::array<Moving, 3> v = {with_rate(q, value_of(rate)), with_rate(rate, 0), with_rate(T(at.t), 1)};
    return T(without_rate(f_(std::span<const Moving>(v))));
  };
  if (!is_rotation(axis_)) {
    const T q = a_S.dot(Vec3T<T>(at.P.x() - at.S.x())), rate = a_S.dot(rate_from_s(Effort::force, at)),
            f = effort(q, rate);
    load.force(Vec3T<T>(f * a_S), at.P.x());
    load.supplies(f * rate);
    load.shows(q, rate, f);
    return;
  }
  const QuatT<T> e = conjugate(at.S.q()) * at.P.q();
  T q = 2.0 * atan2(k == 0 ? e.x : k == 1 ? e.y : e.z, e.w);
  const Vec3T<T> a_P = at.P.axis(k);
  const T sum = 1.0 + a_P.dot(a_S);
  const bool has_angle = value_of(sum) != 0;
  const Vec3T<T> g = has_angle ? Vec3T<T>(T(1.0 / sum) * (a_P + a_S)) : Vec3T<T>(Vec3T<T>::Zero());
  const T rate = g.dot(at.P.w() - at.S.w());
  q += kTwoPi * std::round(((angle_ ? angle_->expected(at.s) : 0.0) - value_of(q)) / kTwoPi);
  const T f = has_angle ? effort(q, rate) : T(0);
  load.torque(Vec3T<T>(f * g));
  load.supplies(f * rate);
  load.shows(q, rate, f);
}

template class FormulaForce<CoordinateForce>;

}  // namespace lockstep
