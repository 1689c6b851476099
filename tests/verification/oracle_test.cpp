// SPDX-License-Identifier: BSD-3-Clause
// The oracles of the lock against each other and against lock-checks.json. No library code takes part.
//
// Equalities tested, each to 1e-12 times max(1, |value|), on the file's entries and on random configurations:
//   C, Ct, Cd, Cdd, Cq, Qc     the paper's literal equations = exact derivatives of the constraint = the file
//   Jh, Qhat, rho, e           exact derivatives of the constraint = the file
//   functions, reactions       exact derivatives, virtual work = the file
//   (2.2)  Cd = Jh v + Ct = Cq qd + Ct,  Cdd = Jh acc - Qhat = Cq qdd - Qc
//   (2.10) Jh = Cq blockdiag(1, G1^T/4, 1, G2^T/4)
//   (2.11) Qhat = Qc + (1/4)(|w1|^2 + |w2|^2) e on the rotational rows, Qhat = Qc on the translational rows
//   (2.12) Cq_q = Jh_w G on the translational rows, Cq_q = Jh_w G + e q^T on the rotational rows

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "tests/support/catch.h"
#include "tests/support/configuration.h"
#include "tests/support/constraint.h"
#include "tests/support/dual.h"
#include "tests/support/lock_checks.h"
#include "tests/support/lock_functions.h"
#include "tests/support/paper_lock.h"
#include "tests/support/paths.h"

namespace oracle_test {

namespace {

using namespace lockstep::oracle;

constexpr double kTolerance = 1e-12;

/// The largest |a - b| / max(1, |b|) of all entries; infinite if sizes differ or a number is not finite.
double difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols() || !a.allFinite() || !b.allFinite()) return INFINITY;
  return ((a - b).array().abs() / b.array().abs().max(1.0)).maxCoeff();
}

/// (a1, qdd1, a2, qdd2) or, for the velocities, (v1, qd1, v2, qd2).
Eigen::Matrix<double, 14, 1> fourteen(const Eigen::Vector3d& x1, const Eigen::Vector4d& q1, const Eigen::Vector3d& x2,
                                      const Eigen::Vector4d& q2) {
  Eigen::Matrix<double, 14, 1> r;
  r << x1, q1, x2, q2;
  return r;
}

Vector12 twelve(const Eigen::Vector3d& x1, const Eigen::Vector3d& w1, const Eigen::Vector3d& x2,
                const Eigen::Vector3d& w2) {
  Vector12 r;
  r << x1, w1, x2, w2;
  return r;
}

void check_paper_against_constraint(const Configuration& c) {
  const PaperLock paper_terms = paper_lock(c);
  CHECK(difference(paper_terms.C, exact_C(c)) < kTolerance);
  CHECK(difference(paper_terms.Ct, exact_Ct(c)) < kTolerance);
  CHECK(difference(paper_terms.Cq, exact_Cq(c)) < kTolerance);
  CHECK(difference(paper_terms.Qc, exact_Qc(c)) < kTolerance);
  CHECK(difference(paper_Cd(c), exact_Cd(c)) < kTolerance);
  CHECK(difference(paper_rotational_Cdd(c), exact_Cdd(c).tail<4>()) < kTolerance);
}

void check_chain_of_derivatives(const Configuration& c) {
  const Matrix7x12 Jh = exact_Jh(c);
  const Matrix7x14 Cq = exact_Cq(c);
  CHECK(difference(Jh * twelve(c.v1, c.w1, c.v2, c.w2) + exact_Ct(c), exact_Cd(c)) < kTolerance);  // (2.2)
  CHECK(difference(Cq * fourteen(c.v1, c.qd1, c.v2, c.qd2) + exact_Ct(c), exact_Cd(c)) < kTolerance);
  CHECK(difference(Jh * twelve(c.a1, c.al1, c.a2, c.al2) - exact_Qhat(c), exact_Cdd(c)) < kTolerance);
  CHECK(difference(Cq * fourteen(c.a1, c.qdd1, c.a2, c.qdd2) - exact_Qc(c), exact_Cdd(c)) < kTolerance);
}

void check_two_kinds_of_columns(const Configuration& c) {
  const PaperLock paper_terms = paper_lock(c);
  const Matrix7x12 Jh = exact_Jh(c);
  const Eigen::Matrix<double, 3, 4> G1 = paper::G(c.q1), G2 = paper::G(c.q2);
  const Eigen::Vector4d e = error_quaternion(c);

  Matrix7x12 from_Cq;  // (2.10)
  from_Cq << paper_terms.Cq.middleCols<3>(0), paper_terms.Cq.middleCols<4>(3) * G1.transpose() / 4.0,
      paper_terms.Cq.middleCols<3>(7), paper_terms.Cq.middleCols<4>(10) * G2.transpose() / 4.0;
  CHECK(difference(from_Cq, Jh) < kTolerance);

  Matrix7x14 from_Jh;  // (2.12)
  from_Jh << Jh.middleCols<3>(0), Jh.middleCols<3>(3) * G1, Jh.middleCols<3>(6), Jh.middleCols<3>(9) * G2;
  from_Jh.block<4, 4>(3, 3) += e * c.q1.transpose();
  from_Jh.block<4, 4>(3, 10) += e * c.q2.transpose();
  CHECK(difference(from_Jh, paper_terms.Cq) < kTolerance);

  Vector7 Qhat = paper_terms.Qc;  // (2.11)
  Qhat.tail<4>() += 0.25 * (c.w1.squaredNorm() + c.w2.squaredNorm()) * e;
  CHECK(difference(Qhat, exact_Qhat(c)) < kTolerance);
}

void check_all(const Configuration& c) {
  check_paper_against_constraint(c);
  check_chain_of_derivatives(c);
  check_two_kinds_of_columns(c);
}

LockChecks stored_checks() {
  return load_lock_checks(std::filesystem::path(lockstep::paths::kSource) / "tests/verification/data/lock-checks.json");
}

}  // namespace

TEST_CASE("Dual2 gives the first and second derivative of closed forms", "[verification][oracle]") {
  const double x = 0.7;
  const Dual2 t = Dual2::parameter(x);
  auto check = [](const Dual2& f, double v, double d, double dd) {
    CHECK(std::abs(f.v - v) < 1e-15);
    CHECK(std::abs(f.d - d) < 1e-14);
    CHECK(std::abs(f.dd - dd) < 1e-14);
  };
  check(t * t * t - 2.0 * t + 5.0, x * x * x - 2.0 * x + 5.0, 3.0 * x * x - 2.0, 6.0 * x);
  check(1.0 / t, 1.0 / x, -1.0 / (x * x), 2.0 / (x * x * x));
  check((t + 1.0) / (t * t), (x + 1.0) / (x * x), -1.0 / (x * x) - 2.0 / (x * x * x),
        2.0 / (x * x * x) + 6.0 / (x * x * x * x));
  const double root = std::sqrt(1.0 + x * x);
  check(sqrt(1.0 + t * t), root, x / root, 1.0 / (root * root * root));
  const double s = std::sin(x * x), c = std::cos(x * x);
  check(sin(t * t), s, 2.0 * x * c, 2.0 * c - 4.0 * x * x * s);
  check(-cos(t * t), -c, 2.0 * x * s, 2.0 * s + 4.0 * x * x * c);
  const double n = 1.0 + x * x * x * x;
  check(atan2(t * t, 1.0), std::atan(x * x), 2.0 * x / n, 2.0 / n - 8.0 * x * x * x * x / (n * n));
  check(atan2(-t, -2.0), std::atan2(-x, -2.0), 2.0 / (4.0 + x * x), -4.0 * x / ((4.0 + x * x) * (4.0 + x * x)));

  CHECK(t < Dual2(0.8));
  CHECK(t >= 0.7);
  CHECK(t == Dual2(0.7, 3.0, 4.0));
}

TEST_CASE("random configurations have consistent quaternions and only the laws asked for", "[verification][oracle]") {
  for (unsigned laws = 0; laws <= kAllLaws; ++laws) {
    INFO("laws " << laws);
    const bool aligned = laws % 3 == 0;
    const Configuration c = random_configuration(500 + laws, {laws, aligned, false});
    auto check_quaternion = [](const Eigen::Vector4d& q, const Eigen::Vector4d& qd, const Eigen::Vector4d& qdd) {
      CHECK(std::abs(q.norm() - 1.0) < 1e-15);
      CHECK(std::abs(q.dot(qd)) < 1e-15);  // (1.13)
      CHECK(std::abs(q.dot(qdd) + qd.squaredNorm()) < 1e-14);
    };
    check_quaternion(c.q1, c.qd1, c.qdd1);
    check_quaternion(c.q2, c.qd2, c.qdd2);
    check_quaternion(c.qP, c.qPd, c.qPdd);
    check_quaternion(c.qS, c.qSd, c.qSdd);
    check_quaternion(c.qD, c.qDd, c.qDdd);
    CHECK((paper::G(c.q1) * c.qd1 - c.w1).norm() < 1e-14);    // (1.6)
    CHECK((paper::G(c.q1) * c.qdd1 - c.al1).norm() < 1e-14);  // (1.9)

    const Eigen::Vector4d one = Eigen::Vector4d::UnitX();
    auto runs = [](const auto& first, const auto& second) { return !first.isZero(0.0) && !second.isZero(0.0); };
    auto rests = [](const auto& first, const auto& second) { return first.isZero(0.0) && second.isZero(0.0); };
    CHECK(((laws & kUP) ? runs(c.uPd, c.uPdd) : rests(c.uPd, c.uPdd)));
    CHECK(((laws & kQP) ? runs(c.qPd, c.qPdd) : rests(c.qPd, c.qPdd)));
    CHECK(((laws & kUS) ? runs(c.uSd, c.uSdd) : rests(c.uSd, c.uSdd)));
    CHECK(((laws & kQS) ? runs(c.qSd, c.qSdd) : rests(c.qSd, c.qSdd)));
    CHECK(((laws & kP) ? runs(c.pDd, c.pDdd) : rests(c.pDd, c.pDdd) && c.pD.isZero(0.0)));
    CHECK(((laws & kQD) ? runs(c.qDd, c.qDdd) && c.qD != one : rests(c.qDd, c.qDdd) && c.qD == one));
    CHECK((c.qP == one) == aligned);
    CHECK((c.qS == one) == aligned);

    const Configuration again = random_configuration(500 + laws, {laws, aligned, false});
    CHECK(again.x1 == c.x1);
    CHECK(again.qDdd == c.qDdd);
    CHECK(random_configuration(501 + laws, {laws, aligned, false}).x1 != c.x1);

    const Configuration satisfied = random_configuration(500 + laws, {laws, aligned, true});
    CHECK(exact_C(satisfied).norm() < 1e-14);
    check_quaternion(satisfied.q1, satisfied.qd1, satisfied.qdd1);
    CHECK(satisfied.w1 == c.w1);
  }
}

TEST_CASE("the oracles agree with lock-checks.json", "[verification][oracle]") {
  const LockChecks checks = stored_checks();
  REQUIRE(checks.entries.size() == 6);
  for (const LockCheck& check : checks.entries) {
    INFO(check.name);
    const Configuration& c = check.input;
    CHECK(difference(relative_position(c), check.at("rho")) < kTolerance);
    CHECK(difference(error_quaternion(c), check.at("e")) < kTolerance);
    CHECK(difference(exact_C(c), check.at("C7")) < kTolerance);
    CHECK(difference(exact_Ct(c), check.at("Ct7")) < kTolerance);
    CHECK(difference(exact_Cq(c), check.at("Cq")) < kTolerance);
    CHECK(difference(exact_Qc(c), check.at("Qc")) < kTolerance);
    CHECK(difference(six(exact_C(c)), check.at("C")) < kTolerance);
    CHECK(difference(six(exact_Ct(c)), check.at("Ct")) < kTolerance);
    CHECK(difference(six(exact_Cd(c)), check.at("Cdot")) < kTolerance);
    CHECK(difference(six(exact_Jh(c)), check.at("J")) < kTolerance);
    CHECK(difference(six(exact_Qhat(c)), check.at("Qhat")) < kTolerance);
    CHECK(difference(six(exact_Cdd(c)), check.at("Cddot")) < kTolerance);

    const PaperLock paper_terms = paper_lock(c);
    CHECK(difference(paper_terms.C, check.at("C7")) < kTolerance);
    CHECK(difference(paper_terms.Ct, check.at("Ct7")) < kTolerance);
    CHECK(difference(paper_terms.Cq, check.at("Cq")) < kTolerance);
    CHECK(difference(paper_terms.Qc, check.at("Qc")) < kTolerance);
    check_all(c);
  }
}

TEST_CASE("the special entries of lock-checks.json match their names", "[verification][oracle]") {
  for (const LockCheck& check : stored_checks().entries) {
    INFO(check.name);
    const Vector7 C = exact_C(check.input);
    const Eigen::Vector4d e = error_quaternion(check.input);
    if (check.name == "satisfied") {
      CHECK(C.norm() < 1e-14);
    } else if (check.name == "revolute-half-turn") {
      CHECK((e - Eigen::Vector4d(0.0, 0.0, 0.0, 1.0)).norm() < 1e-14);
      CHECK_FALSE(check.has("functions.distance1.value"));
    } else if (check.name == "revolute-full-turn") {
      CHECK((e - Eigen::Vector4d(-1.0, 0.0, 0.0, 0.0)).norm() < 1e-14);
      CHECK_FALSE(check.has("functions.screw.value"));
      CHECK(check.has("functions.screw.J"));
    } else {
      CHECK(C.head<3>().norm() > 0.1);
      CHECK(C.tail<3>().norm() > 0.1);
    }
  }
}

TEST_CASE("the paper's equations are the exact derivatives for every set of laws", "[verification][oracle]") {
  for (unsigned i = 0; i < 200; ++i) {
    const ConfigurationOptions options{i % 64, i % 3 == 1, i % 5 == 2};
    INFO("seed " << i << " laws " << options.laws << " aligned " << options.aligned << " satisfied "
                 << options.satisfied);
    check_all(random_configuration(i, options));
  }
}

TEST_CASE("the oracles agree at half and full revolutions with every set of laws", "[verification][oracle]") {
  const Eigen::Vector4d half(0.0, 0.0, 0.0, 1.0), full(-1.0, 0.0, 0.0, 0.0);
  for (unsigned laws = 0; laws <= kAllLaws; ++laws) {
    INFO("laws " << laws);
    Configuration c = random_configuration(1000 + laws, {laws, false, false});
    place_body_1(c, half, Eigen::Vector3d(0.1, -0.2, 0.3));
    CHECK((error_quaternion(c) - half).norm() < 1e-14);
    CHECK((exact_C(c).head<3>() - Eigen::Vector3d(0.1, -0.2, 0.3)).norm() < 1e-14);
    check_all(c);
    place_body_1(c, full);
    CHECK((error_quaternion(c) - full).norm() < 1e-14);
    check_all(c);
  }
}

TEST_CASE("functions of relative coordinates agree with lock-checks.json", "[verification][oracle]") {
  const LockChecks checks = stored_checks();
  for (const LockCheck& check : checks.entries) {
    unsigned n_compared = 0;
    auto compare = [&](const std::string& name, const auto& phi) {
      const std::string path = "functions." + name + ".";
      INFO(check.name << " " << name);
      const FunctionTerms terms = function_terms(phi, check.input, check.function_law);
      auto number = [&](const char* key, double value) {
        if (!check.has(path + key)) return;
        CHECK(difference(Eigen::MatrixXd::Constant(1, 1, value), check.at(path + key)) < kTolerance);
        ++n_compared;
      };
      number("value", terms.C);
      number("Ct", terms.Ct);
      number("Cdot", terms.Cd);
      number("Qhat", terms.Qhat);
      if (!check.has(path + "J")) return;
      CHECK(difference(terms.Jh, check.at(path + "J")) < kTolerance);
      ++n_compared;
    };
    compare("screw", Screw{checks.screw_pitch});
    compare("rack", Rack{checks.rack_radius});
    compare("universal", Universal{});
    compare("distance2", Distance2{});
    compare("distance1", Distance1{});
    const auto n_stored = std::count_if(check.expected.begin(), check.expected.end(),
                                        [](const auto& item) { return item.first.rfind("functions.", 0) == 0; });
    CHECK(n_compared == static_cast<unsigned>(n_stored));
    CHECK(n_compared >= 18);
  }
}

TEST_CASE("reactions by virtual work agree with lock-checks.json", "[verification][oracle]") {
  for (const LockCheck& check : stored_checks().entries) {
    INFO(check.name);
    const Vector6 lam = check.at("reaction.lam");
    const Reaction r = reaction(check.input, lam);
    CHECK(difference(r.force_on_1, check.at("reaction.force_on_1_at_P_world")) < kTolerance);
    CHECK(difference(r.torque_on_1, check.at("reaction.torque_on_1_world")) < kTolerance);
    CHECK(difference(r.torque_on_1_P_axes, check.at("reaction.torque_on_1_P_axes")) < kTolerance);
    CHECK(difference(r.torque_on_1_D_axes, check.at("reaction.torque_on_1_D_axes")) < kTolerance);
    CHECK(difference(r.torque_on_2_at_S, check.at("reaction.torque_on_2_at_S_world")) < kTolerance);
    CHECK(difference(Eigen::MatrixXd::Constant(1, 1, power_of_laws(check.input, lam)),
                     check.at("reaction.power_of_laws")) < kTolerance);
  }
}

}  // namespace oracle_test
