// SPDX-License-Identifier: BSD-3-Clause
// Three ways to the same motion: 6 velocities a body, the paper's 7 coordinates in the library (Jh G with Qhat), and
// the paper's equations, literally, solved densely here (raw Cq, raw Qc, unit-length rows). All pairs of (2.13), never
// mixed.
#include <cmath>
#include <memory>

#include <Eigen/LU>

#include <lockstep/dynamics.h>
#include <lockstep/solvers.h>
#include "tests/support/catch.h"
#include "tests/support/constraint.h"
#include "tests/support/mechanism.h"

namespace formulations_test {

using namespace lockstep;
using namespace lockstep::inputs;

namespace {

constexpr double kTolerance = 1e-10;

struct Answer {
  VecX a, lambda;
};

/// By the library. Link rows come in the order of the table; they are put back into the order of the links.
Answer by_library(RandomMechanism& m, const State& state, Formulation formulation, Stabilization stabilization = {}) {
  Dynamics dynamics(m.system, std::make_unique<DenseSolver>(), {formulation, stabilization});
  const Evaluated& values = dynamics.evaluate(state);
  Answer s{values.a, VecX(values.lambda.size())};
  int row = 0;
  for (const auto& link : m.system.links()) {
    const RowEntry& e = values.rows.entries[values.rows.entry_of_link[link->number()]];
    s.lambda.segment(row, e.m) = values.lambda.segment(e.first_row, e.m);
    row += e.m;
  }
  return s;
}

/// By the paper's equations: (2.1) with (2.3)-(2.7), rows (3.6), (4.8), right sides (3.7), (4.6). A particle's rotation
/// is held.
Answer by_paper(RandomMechanism& m, const State& state) {
  const int n = static_cast<int>(m.bodies.size());
  int n_rows = 0;
  for (const LinkSpec& l : m.links) n_rows += count_rows(l.rows);
  int n_more = 0;
  for (const Body* b : m.bodies) n_more += b->freedoms == Freedoms::particle ? 4 : 1;
  const int size = 7 * n + n_rows + n_more;
  MatX K = MatX::Zero(size, size);
  VecX right = VecX::Zero(size);
  const auto row_to = [&](int row, int column, const MatX& J) {
    K.block(row, column, J.rows(), J.cols()) += J;
    K.block(column, row, J.cols(), J.rows()) += J.transpose();
  };

  int row = 7 * n + n_rows;
  for (int k = 0; k < n; ++k) {
    const Body& b = *m.bodies[k];
    const int at = 7 * k;
    K.block(at, at, 3, 3) = b.mass.mass * Mat3::Identity();
    right.segment(at, 3) = b.mass.mass * m.system.gravity();
    if (b.freedoms == Freedoms::particle) {
      row_to(row, at + 3, MatX::Identity(4, 4));
      row += 4;
      continue;
    }
    const Vec4 q = state.q.segment<4>(7 * b.slot + 3);
    const Vec3 w = state.v.segment<3>(6 * b.slot + 3);
    Vec4 qd, qdd;
    oracle::set_rates(q, w, Vec3::Zero(), qd, qdd);
    const auto G = oracle::paper::G(q);
    K.block(at + 3, at + 3, 4, 4) = G.transpose() * b.mass.J * G;
    right.segment(at + 3, 4) = -2.0 * oracle::paper::G(qd).transpose() * (b.mass.J * w);
    row_to(row, at + 3, q.transpose());
    right[row++] = -qd.squaredNorm();
  }
  row = 7 * n;
  for (const LinkSpec& l : m.links) {
    const oracle::Configuration c = m.configuration(l, state);
    const oracle::PaperLock lock = oracle::paper_lock(c);
    for (int k = 0; k < 6; ++k) {
      if (!includes(l.rows, row_bit(k))) continue;
      const int j = k < 3 ? k : k + 1;  // the paper's fourth row is the scalar one
      if (l.body1 >= 0) row_to(row, 7 * l.body1, lock.Cq.row(j).head<7>());
      if (l.body2 >= 0) row_to(row, 7 * l.body2, lock.Cq.row(j).tail<7>());
      right[row++] = lock.Qc[j];
    }
  }
  // Rows in metres beside inertias and quaternions: the unscaled matrix is ill-conditioned, and solved with more digits.
  using Long = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Long more = K.cast<long double>().fullPivLu().solve(right.cast<long double>());
  const VecX x = more.cast<double>();
  Answer s{VecX::Zero(6 * n), x.segment(7 * n, n_rows)};
  for (int k = 0; k < n; ++k) {
    const Body& b = *m.bodies[k];
    s.a.segment<3>(6 * b.slot) = x.segment<3>(7 * k);
    if (b.freedoms == Freedoms::spatial)
      s.a.segment<3>(6 * b.slot + 3) = oracle::paper::G(state.q.segment<4>(7 * b.slot + 3)) * x.segment<4>(7 * k + 3);
  }
  return s;
}

/// Largest difference, against the size of the whole.
double apart(const VecX& a, const VecX& b) {
  if (a.size() != b.size() || !a.allFinite() || !b.allFinite()) return HUGE_VAL;
  return a.size() == 0 ? 0.0 : (a - b).lpNorm<Eigen::Infinity>() / std::max(1.0, b.lpNorm<Eigen::Infinity>());
}

void check_three_ways(RandomMechanism& m) {
  m.system.setup();
  const State state = m.system.start();
  const Answer omega = by_library(m, state, Formulation::omega),
                 quaternion = by_library(m, state, Formulation::quaternion), paper = by_paper(m, state);
  CHECK(apart(quaternion.a, omega.a) < kTolerance);
  CHECK(apart(quaternion.lambda, omega.lambda) < kTolerance);
  CHECK(apart(paper.a, omega.a) < kTolerance);
  CHECK(apart(paper.lambda, omega.lambda) < kTolerance);
}

const char* const kMasks[] = {"x y z e1 e2", "x y z",        "x y e1 e2", "x y z e3", "e1 e2 e3",
                              "z e1 e2",     "x y e1 e2 e3", "e3",        "y",        "x e2"};

}  // namespace

TEST_CASE("chains of mixed joints: three formulations, one motion", "[verification][dynamics]") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    RandomMechanism m(seed);
    const int n = 2 + static_cast<int>(seed % 4);
    for (int k = 0; k < n; ++k) {
      m.add_body();
      m.link(k, k - 1, mask_from(kMasks[(seed * 3 + static_cast<std::uint64_t>(k)) % 10]),
             static_cast<unsigned>(seed * 7) % 16u);
    }
    check_three_ways(m);
  }
}

TEST_CASE("chains with all six laws and drives: three formulations, one motion", "[verification][dynamics]") {
  for (std::uint64_t seed = 21; seed <= 28; ++seed) {
    CAPTURE(seed);
    RandomMechanism m(seed);
    m.add_body(), m.add_body(), m.add_body();
    m.link(0, -1, mask_from("x y z e1 e2"), 63);
    m.driven(1, 0, mask_from("x y z e1 e2"), Axis::rz, 15);
    m.driven(2, 1, mask_from("x y e1 e2 e3"), Axis::z);
    m.driven(-1, 2, Mask::none, Axis::y, 4);
    check_three_ways(m);
  }
}

TEST_CASE("loops: three formulations, one motion", "[verification][dynamics]") {
  for (std::uint64_t seed = 41; seed <= 48; ++seed) {
    CAPTURE(seed);
    RandomMechanism m(seed);
    for (int k = 0; k < 4; ++k) {
      m.add_body();
      m.link(k, k - 1, mask_from(kMasks[static_cast<std::size_t>(k + static_cast<int>(seed)) % 4]));
    }
    m.link(-1, 3, mask_from(seed % 2 ? "x y" : "x e1"));  // ground as body 1
    m.link(0, 2, mask_from("z"), 9);
    check_three_ways(m);
  }
}

TEST_CASE("free bodies and particles: three formulations, one motion", "[verification][dynamics]") {
  RandomMechanism free(61);
  free.add_body(), free.add_body();
  check_three_ways(free);
  // a body by itself: J al = -w x J w, a = g
  const State state = free.system.start();
  const Answer s = by_library(free, state, Formulation::omega);
  for (const Body* b : free.bodies) {
    const Vec3 w = b->start.w, al = s.a.segment<3>(6 * b->slot + 3);
    CHECK(difference(s.a.segment<3>(6 * b->slot), free.system.gravity()) < 1e-14);
    CHECK(difference(b->mass.J * al, -oracle::paper::skew(w) * b->mass.J * w) < 1e-13);
  }

  for (std::uint64_t seed = 71; seed <= 74; ++seed) {
    CAPTURE(seed);
    RandomMechanism m(seed);
    const int b = m.add_body(), p = m.add_particle(), r = m.add_particle();
    m.link(b, -1, mask_from("x y z e1 e2"));
    m.link(p, b, mask_from("x z"), 21);
    m.link(r, p, mask_from("y"));
    check_three_ways(m);
  }
}

TEST_CASE("Baumgarte stabilisation acts alike in both formulations", "[verification][dynamics]") {
  Stabilization s;
  s.kind = Stabilization::Kind::baumgarte, s.alpha = 7, s.beta = 11;
  for (std::uint64_t seed = 81; seed <= 84; ++seed) {
    CAPTURE(seed);
    RandomMechanism m(seed);
    m.add_body(), m.add_body();
    m.link(0, -1, mask_from("x y z e1 e2"), 63);
    m.link(1, 0, mask_from("x y e1 e2"), 16);
    m.system.setup();
    const State state = m.system.start();
    const Answer omega = by_library(m, state, Formulation::omega, s),
                   quaternion = by_library(m, state, Formulation::quaternion, s);
    CHECK(apart(quaternion.a, omega.a) < kTolerance);
    CHECK(apart(quaternion.lambda, omega.lambda) < kTolerance);
    // (2.15): with the exact derivatives of the constraint Cdd + 2 alpha Cd + beta^2 C = 0
    for (const LinkSpec& l : m.links) {
      oracle::Configuration c = m.configuration(l, state);
      const auto accelerate = [&](int body, Vec3& a, Vec3& al) {
        a.setZero(), al.setZero();
        if (body < 0) return;
        const int slot = m.bodies[body]->slot;
        a = omega.a.segment<3>(6 * slot), al = omega.a.segment<3>(6 * slot + 3);
      };
      accelerate(l.body1, c.a1, c.al1), accelerate(l.body2, c.a2, c.al2);
      const oracle::Vector6 held = oracle::six<1>(oracle::exact_Cdd(c)) + 14.0 * oracle::six<1>(oracle::exact_Cd(c)) +
                                   121.0 * oracle::six<1>(oracle::exact_C(c));
      for (int k = 0; k < 6; ++k)
        if (includes(l.rows, row_bit(k))) CHECK(std::abs(held[k]) < 1e-9);
    }
  }
}

TEST_CASE("redundant constraints: both formulations share one set of multipliers", "[verification][dynamics]") {
  // a plane four-bar of four revolutes at rest: 20 rows, rank 17
  RandomMechanism m(91);
  const Pose p0 = pose_at(Vec3(0, 0, 0)), p1 = pose_at(Vec3(0, 1, 0)), p2 = pose_at(Vec3(1.5, 1.6, 0)), p3 = pose_at(Vec3(2, 0, 0));
  System& s = m.system;
  Body& crank = s.add_body("crank", shapes::rod(1.0, p0.x, p1.x));
  Body& coupler = s.add_body("coupler", shapes::rod(2.0, p1.x, p2.x));
  Body& rocker = s.add_body("rocker", shapes::rod(1.5, p2.x, p3.x));
  s.add<Revolute>("A", crank, s.ground(), p0);
  s.add<Revolute>("B", coupler, crank, p1);
  s.add<Revolute>("C", rocker, coupler, p2);
  s.add<Revolute>("D", s.ground(), rocker, p3);
  s.setup();
  const State state = s.start();
  const Answer omega = by_library(m, state, Formulation::omega),
                 quaternion = by_library(m, state, Formulation::quaternion);
  REQUIRE(omega.lambda.size() == 20);
  CHECK(apart(quaternion.a, omega.a) < kTolerance);
  CHECK(apart(quaternion.lambda, omega.lambda) < kTolerance);
}

TEST_CASE("the 7-column Jacobian of the library is Jh G: the raw one of the paper except for e q'",
          "[verification][dynamics]") {
  for (std::uint64_t seed = 101; seed <= 106; ++seed) {
    CAPTURE(seed);
    RandomMechanism m(seed);
    m.add_body(), m.add_body();
    m.link(0, 1, Mask::all, 63);
    m.system.setup();
    const State state = m.system.start();
    Dynamics dynamics(m.system, std::make_unique<DenseSolver>());
    const Evaluation& at = dynamics.gather(state);
    KktAssembler matrix(m.system, Formulation::quaternion);
    matrix.lay_out(at.rows(), false);
    matrix.update(at.rows(), at.inputs().motions);
    const KktLink& link = matrix.kkt().pattern.links.front();
    REQUIRE(link.m == 6);
    REQUIRE(link.n_slots == 2);
    using Block = Eigen::Map<const Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>;
    MatX J(6, 14);
    J << Block(matrix.kkt().J.data() + link.J), Block(matrix.kkt().J.data() + link.J + 42);
    // (2.12) rotational raw Cq_q = Jh_w G + vec(e) q^T, translational Cq_q = Jh_w G
    const oracle::Configuration c = m.configuration(m.links[0], state);
    const Vec3 e = oracle::error_quaternion(c).tail<3>();
    J.block(3, 3, 3, 4) += e * c.q1.transpose();
    J.block(3, 10, 3, 4) += e * c.q2.transpose();
    CHECK(difference(J, oracle::six<14>(oracle::paper_lock(c).Cq)) < 1e-12);
    // (2.7) the mass blocks: symmetric, inverse to one another, energy (1/2) w'Jw at q' = (1/2) q w
    const KktPattern& p = matrix.kkt().pattern;
    for (int k = 0; k < 2; ++k) {
      using Square = Eigen::Map<const Eigen::Matrix<double, 7, 7, Eigen::RowMajor>>;
      const MatX M = Square(matrix.kkt().M.data() + p.M[k]), Minv = Square(matrix.kkt().Minv.data() + p.M[k]);
      CHECK(difference(M * Minv, MatX::Identity(7, 7)) < 1e-12);
      CHECK(difference(M, M.transpose()) < 1e-13);
      const Body& b = m.system.body_of_slot(k);
      VecX qd(7);
      qd << state.v.segment<3>(6 * k), k == 0 ? c.qd1 : c.qd2;
      const Vec3 v = state.v.segment<3>(6 * k), w = state.v.segment<3>(6 * k + 3);
      CHECK(std::abs(qd.dot(M * qd) - b.mass.mass * v.dot(v) - w.dot(b.mass.J * w)) < 1e-12);
    }
  }
}

}  // namespace formulations_test
