// SPDX-License-Identifier: BSD-3-Clause
// The four derivations of the lock's rows against the 60 digits of lock-checks.json: what the benchmark charts.
#include "tests/support/derivations.h"

#include <lockstep/author/passes.h>
#include "tests/support/catch.h"
#include "tests/support/lock_checks.h"
#include "tests/support/paths.h"

namespace lockstep::derivations {
namespace {

const oracle::LockChecks& checks() {
  static const oracle::LockChecks all =
      oracle::load_lock_checks(std::string(paths::kSource) + "/tests/verification/data/lock-checks.json");
  return all;
}

double worst(const Rows& r, const oracle::LockCheck& check) {
  return std::max({(r.C - check.at("C")).cwiseAbs().maxCoeff(), (r.Ct - check.at("Ct")).cwiseAbs().maxCoeff(),
                   (r.J - check.at("J")).cwiseAbs().maxCoeff(), (r.Qhat - check.at("Qhat")).cwiseAbs().maxCoeff()});
}

}  // namespace

TEST_CASE("three derivations are exact, differences are not", "[unit][derivations]") {
  for (const oracle::LockCheck& check : checks().entries) {
    INFO(check.name);
    const Place in = place(check.input);
    for (const Way way : {Way::compact, Way::products, Way::jets}) CHECK(worst(rows(way, in), check) < 1e-12);
    const double by_differences = worst(rows(Way::differences, in), check);
    CHECK(by_differences < 1e-5);
    CHECK(by_differences > 1e-10);
  }
}

TEST_CASE("the compact form costs the least operations", "[unit][derivations]") {
  const oracle::Configuration& c = checks().entries.front().input;
  const long compact = operations(Way::compact, c);
  CHECK(compact <= 1280);  // theory (5.2): 1219, 5 % allowed
  CHECK(operations(Way::products, c) > 3 * compact);
  CHECK(operations(Way::jets, c) > 3 * compact);
  CHECK(operations(Way::differences, c) > 3 * compact);
}

TEST_CASE("a joint made of derived constraints moves as the library's own", "[unit][derivations]") {
  const oracle::Configuration c = oracle::random_configuration(3, {.laws = 0, .satisfied = true});
  const Place in = place(c);
  const Rows truth = compact(in);
  System sys;
  Body& one = sys.add_body("one", {1.0, Vec3::Zero(), Vec3(0.1, 0.2, 0.2).asDiagonal()}, {c.x1, Quat::from(c.q1)});
  Body& two = sys.add_body("two", {2.0, Vec3::Zero(), Vec3(0.1, 0.2, 0.2).asDiagonal()}, {c.x2, Quat::from(c.q2)});
  one.start = {c.v1, c.w1}, two.start = {c.v2, c.w2};
  Marker& P = sys.add_marker("P", one, {c.uP, Quat::from(c.qP)});
  Marker& S = sys.add_marker("S", two, {c.uS, Quat::from(c.qS)});
  const Mask mask = Mask::x | Mask::z | Mask::e2;
  for (const Way way : kWays) {
    DerivedLock& lock = static_cast<DerivedLock&>(sys.add(std::make_unique<DerivedLock>(name(way), P, S, mask, way)));
    sys.setup();
    CHECK(lock.row_name(2) == "e2");
  }
  RowTable table;
  std::vector<Motion> motions;
  const State state = sys.start();
  passes::lay_out(sys, state.modes, table);
  passes::motions(sys, state, motions);
  Inputs inputs;
  inputs.motions = motions;
  passes::gather_rows(sys, inputs, table);
  constexpr int kRows[] = {0, 2, 4};
  for (const RowEntry& e : table.entries)
    for (int k = 0; k < 3; ++k) {
      INFO("link " << e.link << ", row " << k);
      CHECK(table.block(e).Qhat(k) == Approx(truth.Qhat[kRows[k]]).margin(1e-6));
      for (std::size_t j = 0; j < 6; ++j)
        CHECK(table.block(e).J(1, k)[j] == Approx(truth.J(kRows[k], 6 + j)).margin(1e-8));
    }
}

}  // namespace lockstep::derivations
