// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/detail/newton.h>

#include <lockstep/author/force.h>
#include <lockstep/dynamics.h>
#include <lockstep/forces.h>
#include <lockstep/joints.h>
#include <lockstep/solvers.h>
#include "framework/mechanism/rows/loads.h"
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/configuration.h"
#include "tests/support/mechanism.h"
#include "tests/support/messages.h"

namespace implicit_test {

using namespace lockstep;

namespace {

/// Three bodies and a particle in a loop, ground to ground, redundant, with springs; any state, off the constraints.
struct Loop {
  inputs::RandomMechanism mechanism{5};
  std::unique_ptr<Dynamics> dynamics;
  State state;
  VecX lambda;

  Loop() {
    System& sys = mechanism.system;
    for (int k = 0; k < 3; ++k) mechanism.add_body();
    const int ball = mechanism.add_particle();
    mechanism.link(0, -1, Mask::xyz | Mask::e1 | Mask::e2);
    mechanism.link(1, 0, Mask::xyz);
    mechanism.link(2, 1, Mask::e123 | Mask::x);
    mechanism.link(2, -1, Mask::xyz | Mask::e1);
    mechanism.link(ball, 2, Mask::x | Mask::y);
    spring(sys, "near", 0, 1, 40, 3);
    spring(sys, "far", 2, ball, 500, 1);
    dynamics = std::make_unique<Dynamics>(sys, std::make_unique<DenseSolver>());
    state = sys.start();
    lambda = VecX::LinSpaced(dynamics->gather(state).rows().n_rows, -2, 3);
  }
  void spring(System& sys, const std::string& name, int p, int s, double stiffness, double damping) {
    const auto at = [&](int k) -> Body& { return *mechanism.bodies[k]; };
    Marker& P = sys.add_marker(name + ".P", at(p), {Vec3(0.1, 0.2, 0.3), {}});
    Marker& S = sys.add_marker(name + ".S", at(s));
    if (at(p).freedoms == Freedoms::particle) P.local = {};
    sys.add<SpringDamper>(name, P, S, {.stiffness = stiffness, .damping = damping, .free_length = 0.3});
  }
};

template <class V>
void clear_particles(const System& sys, V& x) {
  for (int k = 0; k < sys.n_slots(); ++k)
    if (sys.body_of_slot(k).freedoms == Freedoms::particle) x.template segment<3>(6 * k + 3).setZero();
}

VecX rows_times(const RowTable& rows, const VecX& x) {
  VecX y = VecX::Zero(rows.n_rows);
  for_each_jacobian(rows, [&](int row, int slot, const auto& J) { y[row] += J.dot(x.segment<6>(6 * slot)); });
  return y;
}

/// |f - (a M + b D + c K) x - J^T l| and |r - J x| by the products, against the right sides.
double residual(const NewtonMatrix& N, const Evaluation& e, double a, double b, double c, const VecX& f, const VecX& r,
                const VecX& x, const VecX& l) {
  VecX y = VecX::Zero(x.size());
  subtract_reactions(e.rows(), -l, y);
  N.add_M_times(VecX(a * x), y);
  N.add_D_times(VecX(b * x), y);
  N.add_K_times(VecX(c * x), y);
  y -= f;
  clear_particles(e.system(), y);
  return std::max(y.lpNorm<Eigen::Infinity>() / f.lpNorm<Eigen::Infinity>(),
                  (rows_times(e.rows(), x) - r).lpNorm<Eigen::Infinity>() / r.lpNorm<Eigen::Infinity>());
}

/// Vectors of other sizes than f, r are refused, by both numbers.
template <class V>
void check_sizes(NewtonMatrix& N, const V& f, const V& r) {
  const auto said = [&](const V& of_slots, const V& of_rows) {
    V x, l;
    return lockstep::testing::message_of<ModelError>([&] { N.solve(of_slots, of_rows, x, l); });
  };
  const std::string m = "but " + std::to_string(r.size()) + " are", n = "but " + std::to_string(f.size()) + " are";
  CHECK(lockstep::testing::says(said(f, V::Zero(1)), {"a vector of the constraints has 1 numbers", m.c_str()}));
  CHECK(lockstep::testing::says(said(V::Zero(5), r), {"a vector of the bodies has 5 numbers", n.c_str()}));
}

}  // namespace

TEST_CASE("NewtonMatrix solves its gathered equations, with redundant constraints", "[unit][dynamics]") {
  Loop loop;
  const System& sys = loop.mechanism.system;
  const Evaluation& e = loop.dynamics->gather(loop.state);
  NewtonMatrix N;
  N.gather(e, loop.lambda);
  const VecX f = VecX::LinSpaced(6 * sys.n_slots(), -1, 2);
  VecX some = VecX::LinSpaced(6 * sys.n_slots(), 1, -3), x, l;
  clear_particles(sys, some);
  const VecX r = rows_times(e.rows(), some);
  for (const double h : {1e-4, 1e-2, 0.1}) {
    CAPTURE(h);
    N.factor(1.0, h, h * h);
    const SolveReport report = N.solve(f, r, x, l);
    CHECK(report.residual <= 1e-12);
    CHECK(residual(N, e, 1.0, h, h * h, f, r, x, l) <= 1e-10);
  }
  check_sizes(N, f, r);
}

TEST_CASE("NewtonMatrix: a complex system is two real ones", "[unit][dynamics]") {
  Loop loop;
  const System& sys = loop.mechanism.system;
  const Evaluation& e = loop.dynamics->gather(loop.state);
  NewtonMatrix N;
  N.gather(e, loop.lambda);
  using C = NewtonMatrix::Complex;
  const C a(2.0, 0.7), b(0.01, -0.02), c(1e-4, 3e-4);
  const VecXc f = VecXc::LinSpaced(6 * sys.n_slots(), C(-1, 0.5), C(2, 1));
  VecX some = VecX::LinSpaced(6 * sys.n_slots(), 1, -3);
  clear_particles(sys, some);
  const VecXc r = C(0.3, -1) * rows_times(e.rows(), some);
  VecXc x, l;
  N.factor(a, b, c);
  CHECK(N.solve(f, r, x, l).residual <= 1e-12);
  VecX Re = VecX::Zero(f.size()), Im = Re, Dr = Re, Di = Re, Kr = Re, Ki = Re, Tr = Re, Ti = Re;
  N.add_M_times(x.real(), Re), N.add_M_times(x.imag(), Im);
  N.add_D_times(x.real(), Dr), N.add_D_times(x.imag(), Di);
  N.add_K_times(x.real(), Kr), N.add_K_times(x.imag(), Ki);
  subtract_reactions(e.rows(), -l.real(), Tr), subtract_reactions(e.rows(), -l.imag(), Ti);
  const C i(0, 1);
  VecXc y = a * (Re + i * Im) + b * (Dr + i * Di) + c * (Kr + i * Ki) + (Tr + i * Ti) - f;
  clear_particles(sys, y);
  CHECK(y.cwiseAbs().maxCoeff() <= 1e-10);
  check_sizes(N, f, r);
}

TEST_CASE("NewtonMatrix without tangents gives the accelerations", "[unit][dynamics]") {
  Loop loop;
  const System& sys = loop.mechanism.system;
  const Solution& values = loop.dynamics->evaluate(loop.state);
  VecX f = values.evaluation.force(), qhat(values.lambda.size()), x, l;
  for (const RowEntry& e : values.rows.entries)
    for (int k = 0; k < e.m; ++k) qhat[e.first_row + k] = values.rows.block(e).Qhat(k);
  NewtonMatrix N;
  N.gather(values.evaluation, values.lambda);
  N.factor(1.0, 0.0, 0.0);
  N.solve(f, qhat, x, l);
  VecX a = values.a;
  clear_particles(sys, a);
  CHECK((x - a).lpNorm<Eigen::Infinity>() <= 1e-9 * a.lpNorm<Eigen::Infinity>());
}

TEST_CASE("NewtonMatrix allocates nothing from the second step on", "[unit][dynamics]") {
  if (!allocations_are_counted()) return;
  Loop loop;
  const System& sys = loop.mechanism.system;
  // a force that brings no tangent is differenced; that too
  const auto& marker = sys.marker("near.P");
  loop.mechanism.system.add(function_force("drag", {&marker}, [&marker](const Inputs& in, WrenchSum& out) {
    const MarkerInWorld M = in_world(MarkerFrame(marker), in);
    out.force(marker.body->slot, -0.3 * M.v.norm() * M.v, M.x);
  }));
  NewtonMatrix N;
  VecX x, l;
  VecXc xc, lc;
  const auto step = [&](const VecX& f, const VecX& r, const VecXc& fc, const VecXc& rc) {
    N.gather(loop.dynamics->gather(loop.state), loop.lambda);
    N.factor(1.0, 0.1, 0.01);
    N.solve(f, r, x, l);
    N.factor(NewtonMatrix::Complex(2, 1), 0.1, 0.01);
    N.solve(fc, rc, xc, lc);
  };
  loop.dynamics->gather(loop.state);
  const VecX f = VecX::Ones(6 * sys.n_slots()), r = VecX::Ones(loop.lambda.size());
  const VecXc fc = f.cast<NewtonMatrix::Complex>(), rc = r.cast<NewtonMatrix::Complex>();
  step(f, r, fc, rc);
  CHECK(allocations_of([&] { step(f, r, fc, rc); }) == 0);
}

TEST_CASE("NewtonMatrix without mass is statics: pivots are looked for elsewhere", "[unit][dynamics]") {
  // A pendulum pushed sideways by F leans by F / (m g), its centre moves by d F / (m g).
  System sys({.gravity = {0, -9.81, 0}});
  const double m = 2, d = 0.7, F = 0.01;
  Body& bob = sys.add_body("bob", {m, Vec3::Zero(), Vec3(0.2, 0.25, 0.3).asDiagonal()}, {Vec3(0, -d, 0), {}});
  sys.add<Revolute>("hinge", bob, sys.ground(), pose_at(Vec3::Zero()));
  Dynamics dynamics(sys, std::make_unique<DenseSolver>());
  const Solution& values = dynamics.evaluate(sys.start());
  NewtonMatrix N;
  N.gather(values.evaluation, values.lambda);
  N.factor(0.0, 0.0, 1.0);
  VecX f = VecX::Zero(6), x, l;
  f[0] = F;
  CHECK(N.solve(f, VecX::Zero(5), x, l).residual <= 1e-12);
  CHECK(x[5] == Approx(F / (m * 9.81)).epsilon(1e-12));
  CHECK(x[0] == Approx(d * F / (m * 9.81)).epsilon(1e-12));
  CHECK(l[0] == Approx(F).epsilon(1e-12));
  // A stiffness times a complex number takes the displacement by it, and holds the same load.
  const NewtonMatrix::Complex c(1, 0.3);
  N.factor(NewtonMatrix::Complex(0), NewtonMatrix::Complex(0), c);
  VecXc xc, lc;
  CHECK(N.solve(f, VecXc::Zero(5), xc, lc).residual <= 1e-12);
  CHECK((c * xc - x).norm() <= 1e-12 * x.norm());
  CHECK((lc - l).norm() <= 1e-12 * l.norm());
}

TEST_CASE("NewtonMatrix names a constraint that contradicts another", "[unit][dynamics]") {
  System sys;
  Body& bob = sys.add_body("bob", {2, Vec3::Zero(), Vec3(0.2, 0.25, 0.3).asDiagonal()}, {Vec3(0, -0.7, 0), {}});
  for (const char* name : {"hinge", "twin"}) sys.add<Revolute>(name, bob, sys.ground(), pose_at(Vec3::Zero()));
  Dynamics dynamics(sys, std::make_unique<DenseSolver>());
  NewtonMatrix N;
  N.gather(dynamics.gather(sys.start()), VecX::Zero(10));
  N.factor(1.0, 0.0, 0.0);
  VecX r = VecX::Zero(10), x, l;
  r[2] = 1, r[7] = 2;  // both rows along the axis get 1.5
  const SolveReport report = N.solve(VecX::Zero(6), r, x, l);
  CHECK(report.contradictory);
  CHECK(report.worst_row == 2);
}

TEST_CASE("NewtonMatrix follows a switch between joints with equally many constraints", "[unit][dynamics]") {
  Loop loop;
  const auto without = [&](std::size_t link, NewtonMatrix& N) {
    State state = loop.state;
    state.modes[link] = false;
    const Evaluation& e = loop.dynamics->gather(state);
    const VecX r = VecX::Ones(e.rows().n_rows);
    VecX x, l;
    N.gather(e, r);
    N.factor(1.0, 0.1, 0.01);
    N.solve(VecX::Ones(e.force().size()), r, x, l);
    return x;
  };
  NewtonMatrix N, other;
  without(3, N);
  CHECK(without(2, N) == without(2, other));
}

TEST_CASE("NewtonMatrix in a plane solves what it solves in space", "[unit][dynamics]") {
  // a particle and two rods in the xz plane, a spring between them; the normal is y
  VecX x[2], l[2];
  for (const bool planar : {false, true}) {
    System sys({.gravity = {0, 0, -9.81}});
    const auto rod = [&](const std::string& name, const Vec3& at, double angle) -> Body& {
      Body& b = sys.add_body(name, {1.5, Vec3::Zero(), Vec3(0.01, 0.2, 0.2).asDiagonal()},
                             {at, axis_angle(Vec3::UnitY(), angle)});
      b.start = {Vec3(0.3, 0, -0.2), Vec3(0, 1.1, 0)};
      return b;
    };
    Body& one = rod("one", Vec3(0.5, 0, 0), 0.0);
    Body& two = rod("two", Vec3(1.2, 0, -0.4), 0.6);
    Body& ball = sys.add_particle("ball", 0.7, Vec3(2, 0, 0.3));
    sys.add<Revolute>("A", one, sys.ground(), pose_at(Vec3::Zero(), Vec3(0, 1, 0)));
    sys.add<Revolute>("B", two, one, pose_at(Vec3(1, 0, 0), Vec3(0, 1, 0)));
    Marker& P = sys.add_marker("P", ball);
    Marker& S = sys.add_marker("S", two, {Vec3(0.3, 0, 0), {}});
    sys.add<SpringDamper>("spring", P, S, {.stiffness = 300, .damping = 2, .free_length = 0.3});
    sys.add<Distance>("string", P, S);
    if (planar) sys.set_planar(Plane{1});
    Dynamics dynamics(sys, std::make_unique<DenseSolver>());
    const Solution& values = dynamics.evaluate(sys.start());
    NewtonMatrix N;
    N.gather(values.evaluation, values.lambda);
    N.factor(1.0, 0.05, 0.01);
    VecX f = VecX::Zero(18), some = f;
    for (int k = 0; k < 3; ++k) {
      f[6 * k] = 1 + k, f[6 * k + 2] = 3 - k, some[6 * k] = 0.3 * k, some[6 * k + 2] = 1 - k;
      if (k < 2) f[6 * k + 4] = 0.2 * k - 1, some[6 * k + 4] = 0.7;
    }
    const VecX r = rows_times(values.rows, some);
    const std::size_t i = planar ? 1 : 0;
    CHECK(N.solve(f, r, x[i], l[i]).residual <= 1e-12);
    CHECK(r.size() == (planar ? 5 : 11));
  }
  CHECK((x[0] - x[1]).lpNorm<Eigen::Infinity>() <= 1e-12 * x[0].lpNorm<Eigen::Infinity>());
  CHECK(x[1].lpNorm<Eigen::Infinity>() > 0.1);
}

TEST_CASE("A hanging pendulum has its frequency: the geometric stiffness of the hinge", "[unit][dynamics]") {
  // (9.27) w = sqrt(m g d / (I + m d^2)): with w^2 = shift, [w^2 M - K] is singular along the hinge
  System sys({.gravity = {0, -9.81, 0}});
  const double m = 2, d = 0.7, I = 0.3;
  Body& bob = sys.add_body("bob", {m, Vec3::Zero(), Vec3(0.2, 0.25, I).asDiagonal()}, {Vec3(0, -d, 0), {}});
  sys.add<Revolute>("hinge", bob, sys.ground(), pose_at(Vec3::Zero()));
  Dynamics dynamics(sys, std::make_unique<DenseSolver>());
  const Solution& values = dynamics.evaluate(sys.start());
  NewtonMatrix N;
  N.gather(values.evaluation, values.lambda);
  // swing by dth about z: dx = d dth along x (the pivot stays)
  VecX swing(6), K_swing = VecX::Zero(6), M_swing = VecX::Zero(6);
  swing << d, 0, 0, 0, 0, 1;
  N.add_K_times(swing, K_swing);
  N.add_M_times(swing, M_swing);
  const double w2 = swing.dot(K_swing) / swing.dot(M_swing);
  CHECK(std::sqrt(w2) == Approx(3.2756201702883685).epsilon(1e-13));
  CHECK(std::sqrt(w2) == Approx(std::sqrt(m * 9.81 * d / (I + m * d * d))).epsilon(1e-13));
}

TEST_CASE("MarkerLock's geometric stiffness agrees with differences of its constraints", "[unit][lock]") {
  for (int seed = 1; seed <= 4; ++seed)
    for (const bool grounded : {false, true}) {
      CAPTURE(seed, grounded);
      inputs::RandomMechanism mechanism(static_cast<std::uint64_t>(seed));
      mechanism.add_body(), mechanism.add_body();
      if (seed % 2 == 0)
        mechanism.link(0, grounded ? -1 : 1, Mask::all, oracle::kAllLaws);
      else
        mechanism.driven(grounded ? -1 : 0, 1, Mask::xyz | Mask::e1 | Mask::e2, Axis::rz);
      const Lock& lock = *mechanism.system.links().front();
      Dynamics dynamics(mechanism.system, std::make_unique<DenseSolver>());
      const Evaluation& gathered = dynamics.gather(mechanism.system.start());
      const std::vector<double> lambda{1.3, -0.4, 0.8, -2.0, 0.7, 1.9};
      TangentSum exact, differenced;
      exact.lay_out(2), differenced.lay_out(2);
      add_tangent(lock, gathered.inputs(), lambda, exact);
      difference_tangent(lock, gathered.inputs(), lambda, differenced);
      REQUIRE(exact.pairs().size() == differenced.pairs().size());
      for (std::size_t p = 0; p < exact.pairs().size(); ++p)
        for (std::size_t q = 0; q < exact.pairs().size(); ++q)
          if (exact.pairs()[p].row == differenced.pairs()[q].row &&
              exact.pairs()[p].column == differenced.pairs()[q].column)
            CHECK((exact.K(p) - differenced.K(q)).cwiseAbs().maxCoeff() <= 1e-8);
    }
}

}  // namespace implicit_test
