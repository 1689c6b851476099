// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/forces.h>

#include <lockstep/author/params.h>
#include "framework/mechanism/forces/effort.h"

namespace lockstep {

Motor::Motor(std::string name, Marker& p, Marker& s, Effort effort, LawPtr<MotionLaw> law)
    : FormulaForce(std::move(name), p, &s), effort_(effort), law_(std::move(law)) {
  require(law_ != nullptr, word(effort_), "is missing; give a law");
  add_law(law_, word(effort_), effort_ == Effort::torque ? "N m" : "N");
}
Motor::~Motor() = default;

void Motor::setup() {
  if (effort_ == Effort::torque) require_turning(p(), "rotates");
  require_turning(*s(), effort_ == Effort::torque ? "rotates" : "has a lever arm on");
  MarkerForce::setup();
}

bool Motor::stays_in_plane(Plane plane) const {
  const bool torque = effort_ == Effort::torque;
  return markers_stay_in(plane, false) && axis_stays_in_plane(torque ? Axis::rz : Axis::z, S_.A0.row(plane.n)) &&
         (torque || has_no_arms(plane));
}

std::vector<Quantity> Motor::quantities() const {
  const bool turns = effort_ == Effort::torque;
  return {
      {word(effort_), unit(effort_), turns ? "torque on P's body about +z of S" : "force on P's body along +z of S"},
      {"rate", turns ? "rad/s" : "m/s", "rate of P relative to S, in the same direction"},
      power()};
}

template <class T, class Load>
void Motor::act(const Ends<T>& at, Load& load) const {
  const double f = value(law_, at.t);
  const Vec3T<T> z = at.S.axis(2);
  const T rate = z.dot(rate_from_s(effort_, at));
  exert(effort_, Vec3T<T>(f * z), at, load);
  load.supplies(f * rate);
  load.shows(T(f), rate);
}

ForceMotor::ForceMotor(std::string name, Marker& p, Marker& s, Options options)
    : Motor(std::move(name), p, s, Effort::force, std::move(options.force)) {}

TypeInfo ForceMotor::info() {
  return {"force_motor",
          "force by a law along z of S on P's body at P, the opposite on S's body at the same point",
          {{"force", Form::law, Unit::force, kRequired, "force on p's body along z of s, a law of time"}}};
}

std::unique_ptr<Force> ForceMotor::make(const Attachment& attachment, const Params& k) {
  return std::make_unique<ForceMotor>(attachment.name, p_of(attachment, k), s_of(attachment, k),
                                      Options{k.law("force")});
}

TorqueMotor::TorqueMotor(std::string name, Marker& p, Marker& s, Options options)
    : Motor(std::move(name), p, s, Effort::torque, std::move(options.torque)) {}

TypeInfo TorqueMotor::info() {
  return {"torque_motor",
          "torque by a law about z of S on P's body, the opposite on S's body",
          {{"torque", Form::law, Unit::torque, kRequired, "torque on p's body about z of s, a law of time"}}};
}

std::unique_ptr<Force> TorqueMotor::make(const Attachment& attachment, const Params& k) {
  return std::make_unique<TorqueMotor>(attachment.name, p_of(attachment, k), s_of(attachment, k),
                                       Options{k.law("torque")});
}

template class FormulaForce<Motor>;

}  // namespace lockstep
