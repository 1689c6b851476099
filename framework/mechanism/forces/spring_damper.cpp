// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/forces.h>

#include <lockstep/author/params.h>
#include <lockstep/text.h>
#include "framework/mechanism/forces/effort.h"

namespace lockstep {

SpringDamper::SpringDamper(std::string name, Marker& p, Marker& s, Options options)
    : FormulaForce(std::move(name), p, &s), options_(std::move(options)) {
  require_finite("stiffness", options_.stiffness);
  require_not_negative("damping", options_.damping);
  require_not_negative("free_length", options_.free_length);
  require_finite("preload", options_.preload);
  add_law(options_.force, "force", "N");
}

TypeInfo SpringDamper::info() {
  return {"spring_damper",
          "spring, damper and linear actuator on the line between the origins of P and S",
          {{"stiffness", Form::number, Unit::stiffness, 0, "force per length"},
           {"damping", Form::number, Unit::damping, 0, "force per rate of extension, not negative"},
           {"free_length", Form::number, Unit::length, 0, "length at which only the preload acts"},
           {"preload", Form::number, Unit::force, 0, "force at the free length, positive pulls P and S together"},
           {"force", Form::law, Unit::force, kOptional, "law added to the force, positive pulls P and S together"}}};
}

std::unique_ptr<Force> SpringDamper::make(const Attachment& attachment, const Params& k) {
  Options o{k.number("stiffness"), k.number("damping"), k.number("free_length"), k.number("preload"), {}};
  if (k.has("force")) o.force = k.law("force");
  return std::make_unique<SpringDamper>(attachment.name, p_of(attachment, k), s_of(attachment, k), std::move(o));
}

bool SpringDamper::stays_in_plane(Plane plane) const { return markers_stay_in(plane); }

void SpringDamper::setup() {
  MarkerForce::setup();
  if (p().translation_law || s()->translation_law) return;  // their laws may separate them at the start
  const double length = ((p().body->home * p().local).x - (s()->body->home * s()->local).x).norm();
  const double T = options_.preload - options_.stiffness * options_.free_length;
  if (length > 1e-9 || (T == 0 && !options_.force)) return;
  throw ModelError("force '" + name() + "': markers '" + p().name + "' and '" + s()->name +
                   "' coincide at the start, so its force (" + text::brief(T) + " N at length 0" +
                   (options_.force ? ", and a law" : "") +
                   ") has no direction; move one of them, or make the free length and the preload 0");
}

std::vector<Quantity> SpringDamper::quantities() const {
  return {{"length", "m", "distance between P and S"},
          {"rate", "m/s", "rate of the length"},
          {"force", "N", "force along the line; positive pulls P and S together"},
          power()};
}

template <class T, class Load>
void SpringDamper::act(const Ends<T>& at, Load& load) const {
  const auto& [k, c, l0, T0, law] = options_;
  const Vec3T<T> x_P = at.P.x(), x_S = at.S.x(), d = x_P - x_S;
  const T length = norm(d);
  const bool apart = value_of(length) != 0;
  const Vec3T<T> n = apart ? Vec3T<T>(T(1.0 / length) * d) : d;
  const T rate = n.dot(at.P.v() - at.S.v()),
          pull = LinearSpring{k, c, l0, T0}.force(length, rate, value(law, at.t), load);
  if (apart)
    load.force(-pull * n, x_P, x_S);
  else if (value_of(pull) == 0)  // no force at d = 0, but a tangent
    load.force(-k * d, x_P, x_S);
  load.shows(length, rate, apart ? pull : T(0));
}

template class FormulaForce<SpringDamper>;

}  // namespace lockstep
