// SPDX-License-Identifier: BSD-3-Clause
// The kernel's two halves against lock-checks.json (1e-12) and against exact derivatives of the constraint (1e-11), in
// every instance: all sets of laws, markers parallel to their bodies, with and without the values' rates and the scalar
// row.
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <utility>

#include <lockstep/author/relative.h>
#include "tests/support/catch.h"
#include "tests/support/constraint.h"
#include "tests/support/lock_checks.h"
#include "tests/support/lock_inputs.h"
#include "tests/support/paths.h"
#include "tests/support/worst.h"

namespace kernel_test {

using namespace lockstep;
using namespace lockstep::inputs;
using oracle::Configuration;

namespace {

/// C, Ct, Qhat, yd, J of the rows (translation) or of (scalar, vector) rows (rotation) as the oracles order them.
struct Got {
  VecX C, Ct, Qhat, Cd;
  MatX J;
};

Got got(const TranslationRowsT<double>& r, unsigned bits) {
  Got g{r.C, r.Ct, r.Qhat, {}, MatX(3, 12)};
  g.J << r.Jv, r.Jw1, -r.Jv, r.Jw2;
  if (bits & with::rates) g.Cd = r.yd;
  return g;
}

/// Three rows; with the scalar row four, its value being e0 - 1.
Got got(const RotationRowsT<double>& r, unsigned bits) {
  Got g{r.C, r.Ct, r.Qhat, {}, MatX(3, 12)};
  const Mat3 zero = Mat3::Zero();
  g.J << zero, r.Jw1, zero, r.Jw2;
  if (bits & with::rates) g.Cd = r.yd;
  if (!(bits & with::scalar_row)) return g;
  const auto over = [](double first, const VecX& rest) { return (VecX(4) << first, rest).finished(); };
  MatX J(4, 12);
  J << Eigen::RowVector3d::Zero(), r.Jw1_0.transpose(), Eigen::RowVector3d::Zero(), r.Jw2_0.transpose(), g.J;
  Got with_scalar{over(r.e.w - 1, g.C), over(r.Ct0, g.Ct), over(r.Qhat0, g.Qhat), {}, J};
  if (bits & with::rates) with_scalar.Cd = over(r.yd0, r.yd);
  return with_scalar;
}

template <unsigned kWith>
Got kernel_translation(const KernelInputs& in, Mask rows = Mask::all) {
  TranslationRowsT<double> r;
  r.Jv.setConstant(NAN), r.Jw1.setConstant(NAN), r.Jw2.setConstant(NAN);
  translation<kWith>(in.O1, in.O2, in.P, in.S, in.p, rows, r);
  return got(r, kWith);
}

template <unsigned kWith>
Got kernel_rotation(const KernelInputs& in, Mask rows = Mask::all) {
  RotationRowsT<double> r;
  r.Jw1.setConstant(NAN), r.Jw2.setConstant(NAN);
  rotation<kWith>(in.O1, in.O2, in.P, in.S, in.D, rows, r);
  return got(r, kWith);
}

double worst(const Got& g, const Configuration& c, int first, int n) {
  double w = 0;
  const auto take = [&](const MatX& got, const MatX& expected) { keep_worst(w, difference(got, expected)); };
  take(g.C, oracle::exact_C(c).segment(first, n));
  take(g.Ct, oracle::exact_Ct(c).segment(first, n));
  take(g.Qhat, oracle::exact_Qhat(c).segment(first, n));
  take(g.J, oracle::exact_Jh(c).middleRows(first, n));
  if (g.Cd.size() > 0) take(g.Cd, oracle::exact_Cd(c).segment(first, n));
  return w;
}

/// Bits of with:: and of the oracles are the same numbers for the six laws.
static_assert(unsigned(with::uP) == oracle::kUP && unsigned(with::qP) == oracle::kQP &&
              unsigned(with::uS) == oracle::kUS && unsigned(with::qS) == oracle::kQS &&
              unsigned(with::p) == oracle::kP && unsigned(with::qD) == oracle::kQD);

/// The instances' rows from `first` on against exact derivatives.
using Instance = Got (*)(const KernelInputs&, Mask);
void check_instances(const Configuration& c, unsigned bits, int first, std::initializer_list<Instance> three,
                     Instance with_scalar_row = nullptr) {
  CAPTURE(bits);
  const KernelInputs in(c);
  for (const Instance rows : three) CHECK(worst(rows(in, Mask::all), c, first, 3) < 1e-11);
  if (with_scalar_row) CHECK(worst(with_scalar_row(in, Mask::all), c, first - 1, 4) < 1e-11);
}
template <unsigned kWith>
void check_translation(const Configuration& c) {
  check_instances(c, kWith, 0, {kernel_translation<kWith>, kernel_translation<kWith | with::rates>});
}
template <unsigned kWith>
void check_rotation(const Configuration& c) {
  check_instances(c, kWith, 4, {kernel_rotation<kWith>, kernel_rotation<kWith | with::rates>},
                  kernel_rotation<kWith | with::rates | with::scalar_row>);
}

/// Every set of laws. Laws that a half does not see are left out of its instance: the compiler makes 16 and 8 of them.
template <std::size_t... kLaws>
void check_all_laws(std::index_sequence<kLaws...>) {
  using Check = void (*)(const Configuration&);
  static constexpr Check kTranslation[] = {check_translation<kLaws&(with::uP | with::uS | with::qS | with::p)>...};
  static constexpr Check kRotation[] = {check_rotation<kLaws&(with::qP | with::qS | with::qD)>...};
  for (unsigned laws = 0; laws < sizeof...(kLaws); ++laws)
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      CAPTURE(laws, seed);
      const Configuration c = oracle::random_configuration(seed * 100 + laws, {laws, false, seed % 2 == 0});
      kTranslation[laws](c);
      kRotation[laws](c);
    }
}

oracle::LockChecks stored() {
  return oracle::load_lock_checks(std::filesystem::path(paths::kSource) / "tests/verification/data/lock-checks.json");
}

}  // namespace

TEST_CASE("the kernel with all laws gives lock-checks.json", "[verification][lock]") {
  constexpr double kTolerance = 1e-12;
  constexpr unsigned kT = with::uP | with::uS | with::qS | with::p | with::rates;
  constexpr unsigned kR = with::qP | with::qS | with::qD | with::rates | with::scalar_row;
  const oracle::LockChecks checks = stored();
  REQUIRE(checks.entries.size() > 5);
  for (const oracle::LockCheck& check : checks.entries) {
    CAPTURE(check.name);
    const KernelInputs in(check.input);
    const Got t = kernel_translation<kT>(in), r = kernel_rotation<kR>(in);
    const auto whole = [](const MatX& a, const MatX& b) {
      return (MatX(a.rows() + b.rows(), a.cols()) << a, b).finished();
    };
    CHECK(difference(t.C + in.p.p, check.at("rho")) < kTolerance);
    const VecX e = r.C + VecX::Unit(4, 0);
    CHECK(difference(e, check.at("e")) < kTolerance);
    // Of most things the file gives six rows, of some all seven.
    const auto rows = [&](const MatX& expected, const MatX& top, const MatX& bottom) {
      return difference(whole(top, bottom.bottomRows(expected.rows() - 3)), expected);
    };
    CHECK(rows(check.at("C7"), t.C, r.C) < kTolerance);
    CHECK(rows(check.at("Ct7"), t.Ct, r.Ct) < kTolerance);
    CHECK(rows(check.at("C"), t.C, r.C) < kTolerance);
    CHECK(rows(check.at("Ct"), t.Ct, r.Ct) < kTolerance);
    CHECK(rows(check.at("Cdot"), t.Cd, r.Cd) < kTolerance);
    CHECK(rows(check.at("J"), t.J, r.J) < kTolerance);
    CHECK(rows(check.at("Qhat"), t.Qhat, r.Qhat) < kTolerance);
  }
}

TEST_CASE("every instance of the kernel gives the exact derivatives of the constraint", "[verification][lock]") {
  check_all_laws(std::make_index_sequence<64>());
}

TEST_CASE("instances for parallel markers give the same as the general ones", "[verification][lock]") {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    CAPTURE(seed);
    check_translation<with::parallel>(oracle::random_configuration(seed, {0, true}));
    check_rotation<with::parallel>(oracle::random_configuration(seed, {0, true}));
    check_translation<with::parallel | with::p>(oracle::random_configuration(seed, {oracle::kP, true}));
    check_rotation<with::parallel | with::qD>(oracle::random_configuration(seed, {oracle::kQD, true}));
  }
}

TEST_CASE("a law that is absent enters a larger instance as zero", "[verification][lock]") {
  constexpr unsigned kT = with::uP | with::uS | with::qS | with::p, kR = with::qP | with::qS | with::qD;
  for (unsigned laws = 0; laws < 64; ++laws) {
    const Configuration c = oracle::random_configuration(500 + laws, {laws});
    CAPTURE(laws);
    check_translation<kT>(c);
    check_rotation<kR>(c);
  }
}

TEST_CASE("a masked constraint leaves its Jacobian untouched and the others unchanged", "[verification][lock]") {
  const KernelInputs in(oracle::random_configuration(77));
  constexpr unsigned kT = with::uP | with::uS | with::qS | with::p, kR = with::qP | with::qS | with::qD;
  const MatX t = kernel_translation<kT>(in).J, r = kernel_rotation<kR>(in).J;
  for (unsigned m = 0; m < 64; ++m) {
    CAPTURE(m);
    const Mask mask = Mask(std::uint8_t(m));
    const MatX tm = kernel_translation<kT>(in, mask).J, rm = kernel_rotation<kR>(in, mask).J;
    for (int k = 0; k < 3; ++k) {
      CHECK((includes(mask, row_bit(k)) ? tm.row(k) == t.row(k) : tm.row(k).array().isNaN().all()));
      CHECK((includes(mask, row_bit(k + 3)) ? rm.row(k) == r.row(k) : rm.block(k, 3, 1, 3).array().isNaN().all()));
    }
  }
}

TEST_CASE("relative_kinematics gives the relative coordinates without the imposed laws", "[verification][lock]") {
  for (unsigned laws : {0u, unsigned(oracle::kUP), unsigned(oracle::kQS), 15u}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      CAPTURE(laws, seed);
      const Configuration c = oracle::without_imposed_laws(oracle::random_configuration(seed, {laws}));
      const KernelInputs in(c);
      const RelativeKinematics L = relative_kinematics(in.O1, in.O2, in.P, in.S, laws);
      const VecX y = oracle::exact_C(c) + oracle::Vector7::Unit(3);
      MatX J(7, 12);
      J << L.Jv1, L.Jw1, -L.Jv1, L.Jw2;
      CHECK(difference(L.y, y) < 1e-11);
      CHECK(difference(L.yd, oracle::exact_Cd(c)) < 1e-11);
      CHECK(difference(L.Ct, oracle::exact_Ct(c)) < 1e-11);
      CHECK(difference(L.Qhat, oracle::exact_Qhat(c)) < 1e-11);
      CHECK(difference(J, oracle::exact_Jh(c)) < 1e-11);
      const RelativeKinematics half = relative_kinematics(in.O1, in.O2, in.P, in.S, laws, Reads::translation);
      CHECK(half.y.head<3>() == L.y.head<3>());
      CHECK(half.y.tail<4>().isZero(0));
      const RelativeKinematics other = relative_kinematics(in.O1, in.O2, in.P, in.S, laws, Reads::rotation);
      CHECK(other.Jw1.bottomRows<4>() == L.Jw1.bottomRows<4>());
      CHECK(other.y.head<3>().isZero(0));
    }
  }
}

}  // namespace kernel_test
