// SPDX-License-Identifier: BSD-3-Clause
// A feature that a scene does not use costs nothing: unknowns, rows, operations and evaluations, absent and present.
#include "tests/support/economies.h"

#include <lockstep/step_loop.h>
#include <lockstep/recorder.h>
#include <lockstep/integrators.h>
#include "tests/support/catch.h"

namespace lockstep::economies {
namespace {

void check_size(const std::string& name, Size absent, Size present) {
  for (const Economy& e : all()) {
    if (e.name != name) continue;
    INFO(name);
    const Size a = size(e.absent()), p = size(e.present());
    CHECK(a.unknowns == absent.unknowns);
    CHECK(a.rows == absent.rows);
    CHECK(p.unknowns == present.unknowns);
    CHECK(p.rows == present.rows);
    return;
  }
  FAIL("no economy is called " + name);
}

/// Evaluations of 20 steps of rk4 with these columns recorded at 5 outputs.
long evaluations(const std::vector<Request>& columns) {
  Chain chain = plain();
  Recorder recorder(*chain.sys, columns);
  Dynamics dynamics(*chain.sys, std::make_unique<SchurSolver>());
  StepLoop run(dynamics, std::make_unique<Rk4>(), {.step = 0.001, .tolerance = {}, .output = 0.005});
  run.add_observer(recorder);
  run.run_until(0.02);
  CHECK(recorder.table().n_rows() == 5);
  return dynamics.work().evaluations;
}

}  // namespace

TEST_CASE("unknowns and constraints of absent parts do not exist", "[unit][economies]") {
  constexpr int n = kRods;
  check_size("plate on a joint", {6 * n, 5 * n}, {6 * n + 6, 5 * n + 6});
  check_size("rotation constraints", {6 * n, 3 * n}, {6 * n, 5 * n});
  check_size("drives", {6 * n, 5 * n}, {6 * n, 6 * n});
  check_size("moving markers", {6 * n, 5 * n}, {6 * n, 5 * n});
  check_size("switched joints", {6 * n, 5 * n}, {6 * n, 6 * n});
  check_size("rotating bodies", {3 * n, n}, {6 * n, n});
  check_size("motion in space", {3 * n, 2 * n}, {6 * n, 5 * n});
  check_size("bolts as joints", {6 * n, 5 * n}, {12 * n, 11 * n});
}

TEST_CASE("omitted parts change no acceleration", "[unit][economies]") {
  const auto accelerations = [](const Chain& chain) {  // of the rods' frames
    Dynamics dynamics(*chain.sys, std::make_unique<SchurSolver>());
    State state = chain.sys->start();
    const Vec3 turn(0, 0.3, 0);  // all as one about the first hinge
    for (int k = 0; k < chain.sys->n_slots(); ++k) {
      state.v.segment<3>(6 * k) = cross(turn, state.slot_pose(k).x);
      state.v.segment<3>(6 * k + 3) = rotation(state.slot_pose(k).q).transpose() * turn;
    }
    const VecX a = dynamics.evaluate(state).a;
    std::vector<Vec3> out;
    for (const Body* rod : chain.rods) {
      const Mat3 A = rotation(state.slot_pose(rod->slot).q);
      const Vec3 w = state.slot_twist(rod->slot).w, al = a.segment<3>(6 * rod->slot + 3), r = rod->in_slot.x;
      out.push_back(a.segment<3>(6 * rod->slot) + A * (cross(al, r) + cross(w, cross(w, r))));
      out.push_back(A * al);
    }
    return out;
  };
  for (const auto& [absent, present] : {std::pair(flat(), plain()), std::pair(lumps(true), lumps(false)),
                                        std::pair(on_a_plate(false), on_a_plate(true))}) {
    const std::vector<Vec3> a = accelerations(absent), p = accelerations(present);
    REQUIRE(a.size() == p.size());
    for (std::size_t i = 0; i < a.size(); ++i) CHECK((a[i] - p[i]).norm() <= 1e-10 * std::max(1.0, p[i].norm()));
  }
}

TEST_CASE("a joint out of force is as if it were not there", "[unit][economies]") {
  const Size without = size(plain()), inactive = size(stayed(false));
  CHECK(inactive.unknowns == without.unknowns);
  CHECK(inactive.rows == without.rows);
}

TEST_CASE("halves and laws that a joint does without are not computed", "[unit][economies]") {
  // theory (5.2), 5 % allowed
  const long all_laws = lock_operations<with::all_laws>(Mask::all), none = lock_operations<with::nothing>(Mask::all);
  CHECK(all_laws <= 1.05 * 1219);
  CHECK(none <= 1.05 * 600);
  CHECK(lock_operations<with::parallel>(Mask::all) <= 1.05 * 322);
  CHECK(lock_operations<with::nothing>(Mask::xyz) <= 1.05 * 336);
  CHECK(lock_operations<with::nothing>(Mask::e123) <= 1.05 * 264);
  CHECK(lock_operations<with::nothing>(Mask::xyz) + lock_operations<with::nothing>(Mask::e123) == none);
  CHECK(lock_operations<with::p>(Mask::xyz) <= lock_operations<with::nothing>(Mask::xyz) + 9);  // (5.2): 6 in the table
  // (5.3): a row that is masked saves 48 operations, 30 a rotational one
  CHECK(none - lock_operations<with::nothing>(Mask::xyz | Mask::e1 | Mask::e2) >= 30);
  CHECK(none - lock_operations<with::nothing>(Mask::x | Mask::y | Mask::e123) >= 40);
}

TEST_CASE("unrecorded quantities are not evaluated", "[unit][economies]") {
  const long bare = evaluations({});
  CHECK(bare == 20 * 4);
  CHECK(evaluations({"rod0.x", "energy.total"}) == bare);         // positions and velocities are there already
  CHECK(evaluations({"joint0.force_on_p_world_x"}) == bare + 5);  // one solution an output
  CHECK(evaluations({"joint0.force_on_p_world_x", "rod3.az"}) == bare + 5);  // for all columns together
}

}  // namespace lockstep::economies
