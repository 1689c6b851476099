// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/forces.h>

#include <cmath>

#include <lockstep/author/params.h>
#include <lockstep/detail/counted_angle.h>
#include "framework/mechanism/forces/effort.h"

namespace lockstep {

TorsionSpringDamper::TorsionSpringDamper(std::string name, Marker& p, Marker& s, Options options)
    : FormulaForce(std::move(name), p, &s), options_(std::move(options)) {
  require_finite("stiffness", options_.stiffness);
  require_not_negative("damping", options_.damping);
  require_finite("free_angle", options_.free_angle);
  require_finite("preload", options_.preload);
  add_law(options_.torque, "torque", "N m");
}

TypeInfo TorsionSpringDamper::info() {
  return {"torsion_spring_damper",
          "spring, damper and rotary actuator about the common z axis of P and S, revolutions counted",
          {{"stiffness", Form::number, Unit::torsion_stiffness, 0, "torque per angle"},
           {"damping", Form::number, Unit::torsion_damping, 0, "torque per angular speed, not negative"},
           {"free_angle", Form::number, Unit::angle, 0, "angle of P relative to S at which only the preload acts"},
           {"preload", Form::number, Unit::torque, 0, "torque at the free angle, positive rotates P back about z"},
           {"torque", Form::law, Unit::torque, kOptional, "law added to the torque, positive rotates P back about z"}}};
}

std::unique_ptr<Force> TorsionSpringDamper::make(const Attachment& attachment, const Params& k) {
  Options o{k.number("stiffness"), k.number("damping"), k.number("free_angle"), k.number("preload"), {}};
  if (k.has("torque")) o.torque = k.law("torque");
  return std::make_unique<TorsionSpringDamper>(attachment.name, p_of(attachment, k), s_of(attachment, k), std::move(o));
}

void TorsionSpringDamper::count_angles(AngleCounter& counter) { angle_ = &counter.count(p(), *MarkerForce::s(), 2); }

bool TorsionSpringDamper::stays_in_plane(Plane plane) const {
  return markers_stay_in(plane, false) && axis_stays_in_plane(Axis::rz, S_.A0.row(plane.n)) &&
         axis_stays_in_plane(Axis::rz, P_.A0.row(plane.n));
}

void TorsionSpringDamper::setup() {
  require_turning(p(), "rotates");
  require_turning(*s(), "rotates");
  MarkerForce::setup();
  const Vec3 zP = rotation((p().body->home * p().local).q).col(2),
             zS = rotation((s()->body->home * s()->local).q).col(2);
  if (p().rotation_law || s()->rotation_law || 1 + zP.dot(zS) > 1e-9) return;
  throw ModelError(
      "force '" + name() + "': the z axes of markers '" + p().name + "' and '" + s()->name +
      "' are opposed at the start, so the angle about them is undefined; rotate one marker by 180 deg about x");
}

std::vector<Quantity> TorsionSpringDamper::quantities() const {
  return {{"angle", "rad", "rotation of P about S's z, with its revolutions"},
          {"rate", "rad/s", "rate of the angle"},
          {"torque", "N m", "torque about z; positive rotates P back, about -z of S"},
          power()};
}

template <class T, class Load>
void TorsionSpringDamper::act(const Ends<T>& at, Load& load) const {
  using std::atan2;
  const auto& [k, c, th0, T0, law] = options_;
  const QuatT<T> e = conjugate(at.S.q()) * at.P.q();
  const Vec3T<T> z_P = at.P.axis(2), z_S = at.S.axis(2);
  const T sum = 1.0 + z_P.dot(z_S);
  const bool has_angle = value_of(sum) != 0;
  const Vec3T<T> g = has_angle ? Vec3T<T>(T(1.0 / sum) * (z_P + z_S)) : Vec3T<T>(Vec3T<T>::Zero());
  const T rate = g.dot(at.P.w() - at.S.w());
  T angle = 2.0 * atan2(e.z, e.w);
  angle += kTwoPi * std::round(((angle_ ? angle_->expected(at.s) : 0.0) - value_of(angle)) / kTwoPi);
  const T torque = LinearSpring{k, c, th0, T0}.force(angle, rate, value(law, at.t), load);
  load.torque(-torque * g);
  load.shows(angle, rate, has_angle ? torque : T(0));
}

template class FormulaForce<TorsionSpringDamper>;

}  // namespace lockstep
