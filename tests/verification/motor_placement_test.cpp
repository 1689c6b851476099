// SPDX-License-Identifier: BSD-3-Clause
// One motor, put into the lock in every place the theory knows: as the imposed law q_D (p), on the marker S, inversely
// on the marker P, as a drive on the free axis of a joint. Same accelerations, same angle, same torque (force) of the
// drive, at several instants of a motion; the drive's torque against Newton and Euler.
#include <cmath>
#include <memory>

#include <lockstep/dynamics.h>
#include <lockstep/solvers.h>
#include <lockstep/joints.h>
#include "tests/support/catch.h"
#include "tests/support/lock_inputs.h"

namespace motor_placement_test {

using namespace lockstep;
using inputs::difference;

namespace {

/// 0.4 t + 0.3 sin 2t, times a sign.
LawValue motion_law(double t, double sign = 1) {
  return {sign * (0.4 * t + 0.3 * std::sin(2 * t)), sign * (0.4 + 0.6 * std::cos(2 * t)),
          sign * -1.2 * std::sin(2 * t)};
}
class Number final : public MotionLaw {
 public:
  LawValue at(double t) const override { return motion_law(t); }
};
class AboutZ final : public RotationLaw {
 public:
  explicit AboutZ(double sign) : sign_(sign) {}
  RotationValue at(double t) const override {
    const LawValue l = motion_law(t, sign_);
    return {axis_angle(Vec3::UnitZ(), l.y), l.yd * Vec3::UnitZ(), l.ydd * Vec3::UnitZ()};
  }

 private:
  double sign_;
};
class AlongZ final : public TranslationLaw {
 public:
  explicit AlongZ(double sign) : sign_(sign) {}
  TranslationValue at(double t) const override {
    const LawValue l = motion_law(t, sign_);
    return {l.y * Vec3::UnitZ(), l.yd * Vec3::UnitZ(), l.ydd * Vec3::UnitZ()};
  }

 private:
  double sign_;
};

enum class Place { imposed, on_S, on_P, drive };
constexpr Place kPlaces[] = {Place::imposed, Place::on_S, Place::on_P, Place::drive};

/// A swinging base, and an arm that the motor moves against it.
struct Machine {
  System system{{Vec3(0.2, -9.81, 0.4)}};
  Body* base;
  Body* arm;
  MarkerLock* motor;
  std::unique_ptr<Dynamics> dynamics;
  bool turns;
  Place place;

  Machine(bool motor_turns, Place law_place) : turns(motor_turns), place(law_place) {
    const Vec3 hinge(0.3, -0.5, 0.1);
    base = &system.add_body("base", {3.0, Vec3(0.02, 0.01, -0.03), Vec3(0.2, 0.3, 0.35).asDiagonal()},
                            {Vec3(0.2, -0.3, 0), axis_angle(Vec3(1, 2, 3), 0.7)});
    arm = &system.add_body("arm", {1.2, Vec3(0.1, 0, 0.05), Vec3(0.05, 0.06, 0.04).asDiagonal()},
                           {Vec3(0.7, -0.6, 0.2), axis_angle(Vec3(-1, 0.4, 0.2), 1.9)});
    base->start.w = Vec3(0.3, -0.8, 0.5);
    system.add<Spherical>("pivot", *base, system.ground(), pose_at(Vec3::Zero()));
    Marker& P = system.add_marker_at("P", *arm, pose_at(hinge, Vec3(0.5, 0.6, -0.7)));
    Marker& S = system.add_marker_at("S", *base, pose_at(hinge, Vec3(0.5, 0.6, -0.7)));
    if (place == Place::on_S)
      turns ? void(S.rotation_law = std::make_shared<AboutZ>(1))
            : void(S.translation_law = std::make_shared<AlongZ>(1));
    if (place == Place::on_P)
      turns ? void(P.rotation_law = std::make_shared<AboutZ>(-1))
            : void(P.translation_law = std::make_shared<AlongZ>(-1));
    const Mask free = turns ? Mask::e3 : Mask::z;
    const Mask mask = place == Place::drive ? Mask(std::uint8_t(Mask::all) & ~std::uint8_t(free)) : Mask::all;
    motor = &system.add<GenericLock>("motor", P, S, mask);
    if (place == Place::drive) motor->drive(turns ? Axis::rz : Axis::z, std::make_shared<Number>());
    if (place == Place::imposed && turns) motor->turn(std::make_shared<AboutZ>(1));
    if (place == Place::imposed && !turns) motor->move(std::make_shared<AlongZ>(1));
    dynamics = std::make_unique<Dynamics>(system, std::make_unique<DenseSolver>());
  }

  /// One step of the classical method of order four, projected.
  void step(State& state, double h) {
    StateRate k1, k2, k3, k4;
    const auto moved = [&](const StateRate& k, double c) {
      State s = state;
      s.t += c, s.q += c * k.q, s.v += c * k.v;
      return s;
    };
    dynamics->rate(state, k1);
    dynamics->rate(moved(k1, h / 2), k2);
    dynamics->rate(moved(k2, h / 2), k3);
    dynamics->rate(moved(k3, h), k4);
    state.t += h;
    state.q += h / 6 * (k1.q + 2 * k2.q + 2 * k3.q + k4.q);
    state.v += h / 6 * (k1.v + 2 * k2.v + 2 * k3.v + k4.v);
    REQUIRE(dynamics->project(state).converged);
  }

  /// What (8.6) makes of the motor's multipliers, world axes: force on the arm at P, couple; and the same about the
  /// mass centre.
  struct Reaction {
    Vec3 force, couple, about_center, axis;
  };
  VecX a;  // of the last reaction()
  Reaction reaction(const State& state) {
    const Marker *P = &motor->p(), *S = &motor->s();
    const Evaluated& values = dynamics->evaluate(state);
    a = values.a;
    const RowEntry& entry = values.rows.entries[values.rows.entry_of_link[motor->number()]];
    Vec3 lt = Vec3::Zero(), lr = Vec3::Zero();
    int row = entry.first_row;
    for (int k = 0; k < 6; ++k)
      if (includes(motor->rows(), row_bit(k))) (k < 3 ? lt[k] : lr[k - 3]) = values.lambda[row++];

    // (4.2) e = (q_S q_D)' q_2' q_1 q_P; the constraint is met, so its scalar part is +1 or -1
    const Motion &O1 = values.in.slot(arm->slot), &O2 = values.in.slot(base->slot);
    Quat q_P = P->local.q, q_S = S->local.q, q_D;
    if (P->rotation_law) q_P = q_P * P->rotation_law->at(state.t).q;
    if (S->rotation_law) q_S = q_S * S->rotation_law->at(state.t).q;
    if (turns && (place == Place::imposed || place == Place::drive))
      q_D = axis_angle(Vec3::UnitZ(), motion_law(state.t).y);
    const Quat e = conjugate(q_S * q_D) * conjugate(O2.e) * O1.e * q_P;
    CHECK(std::abs(std::abs(e.w) - 1) < 1e-9);

    Reaction r;
    const Mat3 S_to_world = O2.A * rotation(q_S);
    r.force = -(S_to_world * lt);
    r.couple = O1.A * rotation(q_P) * Vec3(-0.5 * (e.w * lr - cross(e.vec(), lr)));
    Vec3 u = (arm->in_slot * P->local).x;
    if (P->translation_law) u += rotation(P->local.q) * P->translation_law->at(state.t).x;
    r.about_center = r.couple + cross(Vec3(O1.A * u), r.force);
    r.axis = S_to_world.col(2);
    return r;
  }
};

void check_places(bool turns) {
  Machine reference(turns, Place::imposed);
  State state = reference.system.start();
  reference.dynamics->project(state);
  for (int instant = 0; instant < 5; ++instant) {
    CAPTURE(instant, state.t);
    const auto expected = reference.reaction(state);
    const VecX a = reference.a;

    // Newton and Euler for the arm alone, which nothing else touches
    const int slot = reference.arm->slot;
    const double m = reference.arm->mass.mass;
    const Mat3 J = reference.arm->mass.J, A = rotation(state.slot_pose(slot).q);
    const Vec3 w = state.slot_twist(slot).w, al = a.segment<3>(6 * slot + 3);
    CHECK(difference(expected.force, m * (a.segment<3>(6 * slot) - reference.system.gravity())) < 1e-10);
    CHECK(difference(expected.about_center, A * (J * al + oracle::paper::skew(w) * (J * w))) < 1e-10);

    for (Place place : kPlaces) {
      CAPTURE(int(place));
      Machine other(turns, place);
      CHECK(other.dynamics->violation(state) < 1e-9);    // the same angle (length) ...
      CHECK(other.dynamics->violation_v(state) < 1e-9);  // ... and speed
      const auto got = other.reaction(state);
      CHECK(difference(other.a, a) < 1e-10);
      CHECK(difference(got.force, expected.force) < 1e-10);
      CHECK(difference(got.about_center, expected.about_center) < 1e-10);
      // the motor's own part: moment about its axis, or force along it
      const double part = turns ? got.couple.dot(got.axis) : got.force.dot(got.axis);
      const double of_expected = turns ? expected.couple.dot(expected.axis) : expected.force.dot(expected.axis);
      CHECK(std::abs(part - of_expected) < 1e-10);
      CHECK(std::abs(of_expected) > 1e-3);
    }
    for (int k = 0; k < 25; ++k) reference.step(state, 0.02);
  }
}

State moved(bool turns, Place place, int n_steps) {
  Machine machine(turns, place);
  State state = machine.system.start();
  machine.dynamics->project(state);
  for (int k = 0; k < n_steps; ++k) machine.step(state, 1.0 / n_steps);
  return state;
}

/// The stages of a step lie off the constraint by the method's own error, and there a marker that turns makes other
/// rows than q_D does (other axes, (4.22)): the motions agree to the method's order, h^4, not to round-off. A drive and
/// a marker that slides make the same rows.
void check_motions(bool turns) {
  const State coarse = moved(turns, Place::imposed, 100), fine = moved(turns, Place::imposed, 200);
  for (Place place : kPlaces) {
    const State other = moved(turns, place, 200);
    const double q = (other.q - fine.q).norm(), v = (other.v - fine.v).norm();
    const double v_coarse = (moved(turns, place, 100).v - coarse.v).norm();
    CAPTURE(turns, int(place), v, v_coarse);
    CHECK(q < 1e-9);
    CHECK(v < 1e-9);
    if (turns && (place == Place::on_S || place == Place::on_P))
      CHECK(v < v_coarse / 8);
    else
      CHECK(v < 1e-12);
  }
}

}  // namespace

TEST_CASE("a rotation law on q_D, on S, on P or as a drive is one motor", "[verification][lock]") {
  check_places(true);
}
TEST_CASE("a translation law on p, on S, on P or as a drive is one motor", "[verification][lock]") {
  check_places(false);
}
TEST_CASE("wherever the motor's law is put, the motion is the same", "[verification][lock]") {
  check_motions(true);
  check_motions(false);
}

}  // namespace motor_placement_test
