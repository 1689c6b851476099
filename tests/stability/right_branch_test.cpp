// SPDX-License-Identifier: BSD-3-Clause
// Through flat and folded positions on the branch on which a mechanism comes, with every solver, in any frame of the world:
// parallelograms of two and three cranks, an antiparallelogram, a kite, a slider-crank of equal arms.
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/joints.h>
#include <lockstep/scene.h>
#include <lockstep/step_loop.h>
#include "tests/support/catch.h"
#include "tests/support/worst.h"

namespace right_branch_test {

using namespace lockstep;

namespace {

/// Rods in a plane of a frame, without gravity.
class Flat {
 public:
  explicit Flat(Pose frame) : frame_(std::move(frame)) {}
  Body& rod(const std::string& name, const Vec3& from, const Vec3& to) {
    return system.add_body(name, shapes::rod(1, (frame_ * pose_at(from)).x, (frame_ * pose_at(to)).x));
  }
  void hinge(const std::string& name, Body& p, Body& s, const Vec3& at) {
    system.add<Revolute>(name, p, s, frame_ * pose_at(at));
  }
  /// Where a point that lay at `home` at the start, in the plane, is now.
  Vec3 now(const std::string& body, const Vec3& home, const State& state) const {
    const Body& b = system.body(body);
    return (inverse(frame_) * body_pose(b, state) * inverse(b.home) * frame_ * pose_at(home)).x;
  }
  Pose at(const Vec3& x, const Vec3& axis) const { return frame_ * pose_at(x, axis); }
  double kinetic(const State& s) const {
    double sum = 0;
    for (int k = 0; k < system.n_slots(); ++k) {
      const Vec3 v = s.v.segment<3>(6 * k), w = s.v.segment<3>(6 * k + 3);
      sum += 0.5 * (system.slot(k).mass * v.squaredNorm() + w.dot(system.slot(k).J * w));
    }
    return sum;
  }

  System system;
  std::vector<VelocityTarget> speeds;

 private:
  Pose frame_;
};

Vec3 along(double angle, double length = 1) { return {length * std::cos(angle), length * std::sin(angle), 0}; }
double angle_of(const Vec3& v) { return std::atan2(v[1], v[0]); }

/// How far a mechanism is from its branch at the end, m or rad; HUGE_VAL where it has not passed the position.
using Off = std::function<double(const Flat&, const State& end)>;

constexpr double kRate = 1;  // rad/s of the first crank at the start

// Parallel cranks turn on at one rate.
Off cranks(Flat& m, int n) {
  constexpr double r = 0.3, L = 1.1, start = -0.3;
  Body& coupler = m.rod("coupler", along(start, r), along(start, r) + Vec3((n - 1) * L, 0, 0));
  for (int k = 0; k < n; ++k) {
    const Vec3 foot(k * L, 0, 0), top = foot + along(start, r);
    const std::string name = std::to_string(k);
    Body& crank = m.rod("crank_" + name, foot, top);
    m.hinge("A" + name, crank, m.system.ground(), foot);
    m.hinge("B" + name, coupler, crank, top);
    m.speeds.push_back({"A" + name, Axis::rz, kRate});
  }
  return [n](const Flat& done, const State& end) {
    double off = 0;
    for (int k = 0; k < n; ++k) {
      const Vec3 foot(k * L, 0, 0);
      const Vec3 top = done.now("crank_" + std::to_string(k), foot + along(start, r), end);
      keep_worst(off, (top - foot - along(start + kRate * end.t, r)).norm());
    }
    return off;
  };
}

// tan(phi/2) (L - r) = -tan(theta/2) (L + r)
Off antiparallelogram(Flat& m) {
  constexpr double r = 0.3, L = 1.1, start = -0.5;
  const auto other = [](double theta) { return 2 * std::atan(-(L + r) / (L - r) * std::tan(theta / 2)); };
  const Vec3 foot(L, 0, 0), a = along(start, r), b = foot + along(other(start), r);
  Body &crank = m.rod("crank", Vec3::Zero(), a), &follower = m.rod("follower", foot, b),
       &coupler = m.rod("coupler", a, b);
  m.hinge("A", crank, m.system.ground(), Vec3::Zero()), m.hinge("B", coupler, crank, a);
  m.hinge("C", follower, m.system.ground(), foot), m.hinge("D", coupler, follower, b);
  m.speeds.push_back({"A", Axis::rz, kRate});
  return [=](const Flat& done, const State& end) {
    const double theta = angle_of(done.now("crank", a, end)), phi = angle_of(done.now("follower", b, end) - foot);
    return theta > 0.1 ? std::abs(std::remainder(phi - other(theta), 2 * kPi)) : HUGE_VAL;
  };
}

// Sides 1, 1, 2, 2: C lies on the bisector of the angle at A, 2 from D. Folded, B lies on D and C at (-1, 0).
Off kite(Flat& m) {
  constexpr double start = -0.6;
  const auto tip = [](double theta) {
    const double c = std::cos(theta / 2);
    return along(theta / 2, c - std::sqrt(c * c + 3));
  };
  const Vec3 b = along(start), c = tip(start), d(1, 0, 0);
  Body &small = m.rod("small", Vec3::Zero(), b), &large = m.rod("large", b, c), &other = m.rod("other", c, d);
  m.hinge("A", small, m.system.ground(), Vec3::Zero()), m.hinge("B", large, small, b);
  m.hinge("C", other, large, c), m.hinge("D", other, m.system.ground(), d);
  m.speeds.push_back({"A", Axis::rz, kRate});
  return [=](const Flat& done, const State& end) {
    const double theta = angle_of(done.now("small", b, end));
    return theta > 0.1 ? (done.now("other", c, end) - tip(theta)).norm() : HUGE_VAL;
  };
}

// Crank and rod of one length: x = 2 r cos(theta); the slider passes the crank's axis at a quarter turn.
Off slider_crank(Flat& m) {
  constexpr double r = 0.2, start = 1.1;
  const Vec3 a = along(start, r), x(2 * a[0], 0, 0);
  Body &crank = m.rod("crank", Vec3::Zero(), a), &rod = m.rod("rod", a, x);
  Body& slider = m.system.add_body("slider", {1, Vec3::Zero(), 0.01 * Mat3::Identity()}, m.at(x, Vec3::UnitZ()));
  m.hinge("A", crank, m.system.ground(), Vec3::Zero()), m.hinge("B", rod, crank, a), m.hinge("C", rod, slider, x);
  m.system.add<Prismatic>("G", slider, m.system.ground(), m.at(x, Vec3::UnitX()));
  m.speeds.push_back({"A", Axis::rz, kRate});
  return [=](const Flat& done, const State& end) {
    const double theta = angle_of(done.now("crank", a, end));
    return theta > 1.7 ? (done.now("slider", x, end) - Vec3(2 * r * std::cos(theta), 0, 0)).norm() : HUGE_VAL;
  };
}

struct Passage {
  double off = HUGE_VAL, energy = 0;  ///< from its branch; change of the energy, relative
  long steps = 0;
  std::string error;
};

Passage pass(Flat& m, const Off& off, const std::string& solver, const std::string& method, double tolerance) {
  RunSettings run;
  run.solver = {solver}, run.integrator = {method}, run.tolerance = {tolerance, 1e-2 * tolerance};
  Dynamics dynamics(m.system, make_solver(run, builtin_registry()), {Formulation::omega, {}});
  Passage out;
  try {
    State start = m.system.start();
    assemble(dynamics, start, m.speeds);
    StepLoop loop(dynamics, make_integrator(run, builtin_registry()), {.tolerance = run.tolerance, .max_steps = 3000});
    const double before = m.kinetic(start);
    loop.set_state(start);
    out.steps = loop.run_until(1).steps;
    const State end = loop.state();
    out.energy = std::abs(m.kinetic(end) - before) / before, out.off = off(m, end);
  } catch (const Error& error) {
    out.error = error.what();
  }
  return out;
}

}  // namespace

TEST_CASE("flat and folded positions are passed on the right branch by every solver in any frame",
          "[stability][integrators]") {
  struct Case {
    const char* name;
    std::function<Off(Flat&)> build;
  };
  const std::vector<Case> cases = {{"two cranks", [](Flat& m) { return cranks(m, 2); }},
                                   {"three cranks", [](Flat& m) { return cranks(m, 3); }},
                                   {"antiparallelogram", antiparallelogram},
                                   {"kite", kite},
                                   {"slider-crank", slider_crank}};
  std::minstd_rand random(11);
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<Pose> frames(1);
  for (int k = 0; k < 3; ++k)
    frames.push_back({Vec3(number(random), number(random), number(random)),
                      normalized(Quat{number(random), number(random), number(random), number(random)})});
  for (const Case& c : cases)
    for (const char* solver : {"schur", "block", "sparse", "dense"})
      for (std::size_t frame = 0; frame < frames.size(); ++frame)
        for (const char* method : {"dopri5", "dop853"})
          for (const double tolerance : {1e-6, 1e-9}) {
            Flat m(frames[frame]);
            const Off off = c.build(m);
            const Passage p = pass(m, off, solver, method, tolerance);
            CAPTURE(c.name, solver, frame, method, tolerance, p.error, p.steps, p.off, p.energy);
            CHECK(p.error.empty());
            CHECK(p.off < 100 * tolerance);
            CHECK(p.energy < 100 * tolerance);
            CHECK(p.steps < 1000);
          }
}

}  // namespace right_branch_test
