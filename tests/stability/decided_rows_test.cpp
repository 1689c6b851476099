// SPDX-License-Identifier: BSD-3-Clause
// Rows that nearly depend, decided beside other things: lanes, implicit methods, the plane, events, drives, couplings.
#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include <lockstep/analysis.h>
#include <lockstep/couplings.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/scene.h>
#include "tests/support/catch.h"
#include "tests/support/doors.h"
#include "tests/support/messages.h"
#include "tests/support/outcome.h"

namespace decided_rows_test {

using namespace lockstep;
using doors::distance, doors::door, doors::Frame, doors::frames, doors::Model, doors::Names;
using doors::kApart, doors::kMass, doors::kSideways, doors::kSolvers;
using stability::Outcome, stability::outcome_of;
using testing::message_of;

namespace {

/// The door, and an arm that hangs on it by a hinge of its own.
std::unique_ptr<Model> door_with_arm(bool both) {
  auto out = door({}, both);
  Body& arm = out->system.add_body("arm", shapes::rod(2, {0.9, 0, 1}, {0.9, 0.5, 1}));
  out->system.add<Revolute>("knob", arm, out->system.body("door"), pose_at({0.9, 0, 1}));
  return out;
}

/// Where a mechanism is after 0.8 s with nothing decided.
State told_end(Model& one) {
  one.begin(NearlyRedundant::reported, "schur");
  State end;
  one.run(0.8, end);
  return end;
}

/// Free by every solver, a mechanism whose door has both hinges moves as that with the lower one alone.
void check_free(const std::function<std::unique_ptr<Model>(bool both)>& make) {
  const auto one = make(false);
  const State truth = told_end(*one);
  for (const std::string& solver : kSolvers) {
    const auto free = make(true);
    free->begin(NearlyRedundant::free, solver);
    REQUIRE(free->near.size() == 1);
    const NearDependency& found = free->near.front();
    CAPTURE(solver, found.undecided);
    CHECK(found.decided);
    State end;
    free->run(0.8, end);
    CHECK(distance(free->system, end, {}, one->system, truth) < 1e-9);
  }
}

}  // namespace

TEST_CASE("a door free or held moves alike by implicit methods", "[stability][redundancy]") {
  const auto one = door({}, false);
  const State truth = told_end(*one);
  struct Method {
    const char* name;
    double step, error;
  };
  for (const Method& method : {Method{"radau5", 0, 1e-8}, Method{"generalized_alpha", 1e-3, 1e-5}})
    for (const Frame& frame : frames(3)) {
      CAPTURE(method.name, frame.x.transpose());
      const auto free = door(frame, true);
      free->begin(NearlyRedundant::free, "schur");
      State end;
      CHECK(free->run(0.8, end, method.name, method.step).steps < 1000);
      CHECK(distance(free->system, end, frame, one->system, truth) < method.error);

      const auto held = door(frame, true);
      held->begin(NearlyRedundant::held, "schur");
      CHECK(held->run(0.05, end, method.name, method.step).steps < 1000);
      CHECK(distance(held->system, end, frame, one->system, one->system.start()) < 1e-7);
    }
}

// In the plane of its motion the door has five rows in place of ten.
TEST_CASE("a door in its plane is free and held as it is in space", "[stability][redundancy]") {
  const auto flat_door = [](bool both, bool planar) {
    auto out = door({}, both);
    out->system.set_gravity({0, kSideways, 0});
    if (planar) out->system.set_planar(Plane{2});
    return out;
  };
  const auto one = flat_door(false, false);
  const State truth = told_end(*one);
  for (const std::string& solver : kSolvers) {
    CAPTURE(solver);
    const auto told = flat_door(true, true);
    told->begin(NearlyRedundant::reported, solver);
    REQUIRE(told->system.plane().n == 2);
    REQUIRE(told->near.size() == 1);
    CHECK(told->near.front().rows == Names{"low.y", "high.y"});
    CHECK(told->near.front().singular_value > 0.1 * kApart);
    CHECK(told->near.front().singular_value < 10 * kApart);

    const auto free = flat_door(true, true);
    free->begin(NearlyRedundant::free, solver);
    CHECK(free->near.front().left_out == Names{"high.x", "high.y"});
    CHECK(mobility(*free->dynamics, free->start).freedoms == 1);
    State end;
    free->run(0.8, end);
    CHECK(distance(free->system, end, {}, one->system, truth) < 1e-9);

    const auto held = flat_door(true, true);
    held->begin(NearlyRedundant::held, solver);
    CHECK(mobility(*held->dynamics, held->start).freedoms == 0);
    const Solution& v = held->dynamics->evaluate(held->start);
    CHECK(v.a.lpNorm<Eigen::Infinity>() < 1e-6);
    const Lock& high = held->system.link("high");
    const MarkerFrame p(*high.pairs().front().first);
    CHECK(Reactions(v).on_body_of(p, high, v.in).force[1] == Approx(-0.45 * kMass * kSideways / kApart).epsilon(1e-6));
  }
}

TEST_CASE("events that switch joints on a loop with left-out or held constraints are rejected by name, others act",
          "[stability][redundancy]") {
  for (const NearlyRedundant choice : {NearlyRedundant::free, NearlyRedundant::held})
    for (const char* const link : {"low", "high"}) {
      CAPTURE(link);
      const auto two = door_with_arm(true);
      two->begin(choice, "schur");
      Event open;
      open.name = "open", open.at = 0.01, open.deactivate = {link};
      State end;
      const std::string said = message_of<ModelError>([&] { two->run(0.1, end, "dop853", 0, {open}); });
      CHECK(said.find("event 'open' switches joint '" + std::string(link) + "'") != std::string::npos);
      CHECK(said.find(choice == NearlyRedundant::held ? "kept as nearly redundant" : "left out as redundant") !=
            std::string::npos);
    }
  // The arm comes off at its hinge, which is on no loop.
  Event off;
  off.name = "off", off.at = 0.2, off.deactivate = {"knob"};
  const auto one = door_with_arm(false), two = door_with_arm(true);
  one->begin(NearlyRedundant::reported, "schur"), two->begin(NearlyRedundant::free, "schur");
  State truth, end;
  one->run(0.6, truth, "dop853", 0, {off}), two->run(0.6, end, "dop853", 0, {off});
  CHECK(distance(two->system, end, {}, one->system, truth) < 1e-9);
}

TEST_CASE("a driven hinge next to a decided door rotates as it is driven", "[stability][redundancy]") {
  const auto driven = [](bool both) {
    auto out = door_with_arm(both);
    out->system.link("knob").jointed()->drive(Axis::rz, laws::law([](auto t) { return 1.0 - cos(3.0 * t); }));
    return out;
  };
  check_free(driven);
  for (const std::string& solver : kSolvers) {
    CAPTURE(solver);
    const auto held = driven(true);
    held->begin(NearlyRedundant::held, solver);
    CHECK(held->near.front().decided);
    CHECK(mobility(*held->dynamics, held->start).freedoms == 0);
    State end;
    held->run(0.05, end);
    const Body &door = held->system.body("door"), &arm = held->system.body("arm");
    CHECK((body_pose(door, end).x - door.home.x).norm() < 1e-7);
    const Quat turned = conjugate(arm.home.q) * body_pose(arm, end).q;
    CHECK(2 * turned.vec()[2] / turned.w == Approx(1 - std::cos(0.15)).epsilon(1e-4));
  }
}

TEST_CASE("a coupling between the hinges of a door and an arm: its neighbours are decided, and it holds",
          "[stability][redundancy]") {
  const auto coupled = [](bool both) {
    auto out = door_with_arm(both);
    System& system = out->system;
    Attachment pairs{"gear", {}};
    for (const char* const hinge : {"low", "knob"}) {
      const auto [p, s] = system.link(hinge).pairs().front();
      pairs.pairs.emplace_back(&system.marker(p->name), &system.marker(s->name));
    }
    system.add(std::make_unique<Gear>(pairs, 2.0));
    return out;
  };
  check_free(coupled);
}

// What nearly depends is held by dense alone, which has another limit: 1e-4 m apart, the hinges lock the door.
TEST_CASE("a door of two hinges that nearly agree stays locked by dense if nothing is decided", "[stability]") {
  const Outcome pushed = outcome_of(R"({"lockstep": 1, "planar": "off", "gravity": [0, 0, -9.81],
    "bodies": [{"name": "door", "box": {"mass": 10, "size": [0.8, 0.05, 2]}, "position": [0.4, 0, 0]}],
    "joints": [{"name": "A", "type": "revolute", "p": "door", "s": "ground", "at": [0, 0, -0.8], "axis": "z"},
               {"name": "B", "type": "revolute", "p": "door", "s": "ground", "at": [1e-4, 0, 0.8], "axis": "z"}],
    "forces": [{"name": "push", "type": "applied_force", "p": "door", "at": [0.8, 0, 0], "force": [0, 5, 0]}],
    "run": {"until": 0.5, "output": 0.1, "nearly_redundant": "report", "formulation": "omega", "solver": "dense",
            "record": ["A.rz"]}})");
  CAPTURE(pushed.error);
  REQUIRE(pushed.ended());
  CHECK(std::abs(pushed.table.last("A.rz")) < 1e-9);
}

}  // namespace decided_rows_test
