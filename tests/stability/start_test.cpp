// SPDX-License-Identifier: BSD-3-Clause
// Starts that the links do not allow, and links that switch at one instant.

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/outcome.h"

namespace start_test {

using namespace lockstep;
using namespace lockstep::stability;

namespace {

constexpr const char* kRod = R"({"lockstep": 1, "planar": "off", "gravity": [0, -9.81, 0],
    "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}, "velocity": $v}],
    "links": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0]}],
    "run": {"integrator": "dop853", "assemble": $assemble, "until": 0.5, "output": 0.5, "record": ["rod.vx"]}})";

}  // namespace

TEST_CASE("start velocities against the constraints are removed and reported, or rejected", "[stability][start]") {
  const Outcome taken = outcome_of(filled(filled(kRod, "$v", "[5, 0, 5]"), "$assemble", "true"));
  CHECK(taken.ended());
  CHECK_FALSE(taken.report.findings.empty());
  const Outcome refused = outcome_of(filled(filled(kRod, "$v", "[5, 0, 5]"), "$assemble", "false"));
  CHECK_FALSE(refused.ended());
  CHECK(refused.error.find("5 m/s") != std::string::npos);
  const Outcome right = outcome_of(filled(filled(kRod, "$v", "[0, 0, 0]"), "$assemble", "false"));
  CHECK(right.ended());
}

TEST_CASE("a start that changes what is stated is reported with figures", "[stability][start]") {
  const std::string text = R"({"lockstep": 1, "bodies": [
      {"name": "cart", "box": {"mass": 1, "size": [0.3, 0.1, 0.1]}$stated}, {"name": "pole", "rod": {"mass": 1, "from": [0, 0, 0], "to": [0, 1, 0]}}],
    "links": [{"name": "rail", "type": "prismatic", "p": "cart", "s": "ground", "at": [0, 0, 0], "axis": "x"},
              {"name": "hinge", "type": "revolute", "p": "pole", "s": "cart", "at": [0, 0, 0], "start": {"velocity": {"rz": 1}}}],
    "run": {"until": 0, "record": ["cart.vx"]}})";
  const auto changed = [&](const std::string& stated) {
    const Outcome start = outcome_of(filled(text, "$stated", stated));
    REQUIRE(start.ended());
    std::vector<Finding> all;
    for (const Finding& f : start.report.findings)
      if (f.code() == "start-changed") all.push_back(f);
    return all;
  };
  CHECK(changed("").empty());                           // nothing is stated of the cart
  CHECK(changed(R"(, "assembled": "exact")").empty());  // of the pose alone
  const std::vector<Finding> all = changed(R"(, "velocity": [0, 0, 0])");
  REQUIRE(all.size() == 1);
  CHECK(all[0].thing == "body 'cart'");
  CHECK(all[0].value == Approx(0.25));  // M v + m (v - w l/2) = 0 and the moment about the hinge
}

// Assembly turns the body by 0.2 rad about y, and by 0.0005 rad about x.
TEST_CASE("stated angular velocities are compared in the axes in which they are stated", "[stability][start]") {
  const auto changed = [](const std::string& text) {
    const Outcome start = outcome_of(text);
    REQUIRE(start.ended());
    double most = 0;
    for (const Finding& f : start.report.findings)
      if (f.code() == "start-changed") most = std::max(most, f.value);
    return most;
  };
  CHECK(changed(R"({"lockstep": 1, "planar": "off",
    "bodies": [{"name": "rod", "mass": 1, "inertia": [0.1, 0.2, 0.3], "position": [0.5, 0, 0],
                "omega_world": [0, 0, 3], "velocity": [0, 1.5, 0]}],
    "joints": [{"name": "B", "type": "spherical", "p": "rod", "s": "ground", "at": [0, 0, 0]},
               {"name": "L", "type": "point_on_plane", "p": "rod", "s": "ground", "at_p": [1, 0, 0],
                "at_s": [1, 0, 0.2], "axis": "z"}],
    "run": {"until": 0, "record": ["rod.x"]}})") == Approx(0.603).epsilon(0.01));
  CHECK(changed(R"({"lockstep": 1, "planar": "off",
    "bodies": [{"name": "rod", "mass": 1, "inertia": [0.1, 0.2, 0.3], "position": [0.5, 0, 0],
                "orientation": {"axis": "x", "angle": 0.0005}, "omega_world": [0, 0, 3], "velocity": [0, 1.5, 0]}],
    "markers": [{"name": "P", "body": "rod", "at": [-0.5, 0, 0]}, {"name": "S", "body": "ground"}],
    "joints": [{"name": "B", "type": "revolute", "p": "P", "s": "S"}],
    "run": {"until": 0, "record": ["rod.x"]}})") == Approx(2e-7).epsilon(0.1));
}

TEST_CASE("drawn poses that assembly moves by more than a thousandth are reported", "[stability][start]") {
  const std::string text = R"({"lockstep": 1, "planar": "off",
    "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, $off, 0], "to": [1, $off, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at_p": [0, $off, 0], "at_s": [0, 0, 0]}],
    "run": {"until": 0, "record": ["rod.x"]}})";
  const auto moved = [&](const char* off) {
    const Outcome start = outcome_of(filled(text, "$off", off));
    REQUIRE(start.ended());
    return std::ranges::count_if(start.report.findings, [](const Finding& f) { return f.code() == "start-moved"; });
  };
  CHECK(moved("0.0002") == 0);
  CHECK(moved("0.002") == 1);
  // Beside a body that may go anywhere, and goes farther.
  const std::string free = R"(, {"name": "free", "particle": 1, "position": [0, 0, 3], "assembled": "free"}],
    "links": [{"name": "F", "type": "spherical", "p": "free", "s": "ground", "at_p": [0, 0, 3], "at_s": [0, 0, 2]}, )";
  const Outcome start = outcome_of(filled(filled(text, R"(}],
    "links": [)",
                                                 "}" + free),
                                          "$off", "0.002"));
  REQUIRE(start.ended());
  CHECK(std::ranges::count_if(start.report.findings, [](const Finding& f) {
          return f.code() == "start-moved" && f.thing == "body 'rod'";
        }) == 1);
}

// By the closed form of a pendulum of 0.35 kg m^2; about its own axis the rod has next to no inertia.
TEST_CASE("a rotation that a joint holds is not lost in round-off, and one that it leaves is", "[stability][start]") {
  const std::string text = R"({"lockstep": 1, "planar": "off", "gravity": [0, -10, 0],
    "bodies": [{"name": "rod", "mass": 1, "inertia": [1e-12, 0.1, 0.1], "position": [0.5, 0, 0]}$more],
    "links": [{"name": "A", "type": "$type", "p": "rod", "s": "$on", "at": [0, 0, 0]}$joint],
    "run": {"integrator": "dop853", "tolerance": 1e-11, "until": 0.4, "output": 0.4, "formulation": "$formulation",
            "record": [{"w": "rod.omega_world_z"}, "energy.kinetic", "rod.y"]}})";
  const auto outcome = [&](const std::string& type, const std::string& formulation, bool carried) {
    std::string scene = filled(filled(text, "$type", type), "$formulation", formulation);
    scene = filled(scene, "$on", carried ? "cart" : "ground");
    scene = filled(scene, "$more", carried ? R"(, {"name": "cart", "box": {"mass": 1e9, "size": [1, 1, 1]}})" : "");
    return outcome_of(filled(scene, "$joint",
                             carried ? R"(, {"name": "B", "type": "spherical", "p": "cart",
        "s": "ground", "at": [0, 0, 0]})"
                                     : ""));
  };
  const auto n_lost = [](const Outcome& run) {
    REQUIRE(run.ended());
    return std::ranges::count_if(run.report.findings, [](const Finding& f) { return f.code() == "inertia-lost"; });
  };
  for (const char* formulation : {"joint", "omega", "quaternion"}) {
    const Outcome held = outcome("revolute", formulation, false);
    CAPTURE(formulation);
    CHECK(n_lost(held) == 0);
    const double w = held.table.last("w");
    CHECK(0.5 * 0.35 * w * w == Approx(-10 * held.table.last("rod.y")).epsilon(1e-10));
  }
  CHECK(n_lost(outcome("revolute", "omega", true)) == 0);
  CHECK(n_lost(outcome("spherical", "omega", false)) == 1);
  CHECK(n_lost(outcome("universal", "omega", false)) == 1);
}

// Nothing depends on it: without it the shaft is free. Its other joints hold the folded pose.
TEST_CASE("the constraint of a joint that is folded by nearly 180 degrees is not released", "[stability][start]") {
  const std::string text = R"({"lockstep": 1, "parameters": {"fold": "$fold deg"},
    "bodies": [{"name": "in", "mass": 1, "inertia": [0.01, 0.01, 0.01]},
               {"name": "arm", "mass": 1, "inertia": [0.01, 0.01, 0.01], "orientation": {"axis": "y", "angle": "=fold"}},
               {"name": "out", "mass": 1, "inertia": [0.01, 0.01, 0.01], "orientation": {"axis": "y", "angle": "=fold"}}],
    "markers": [{"name": "P", "body": "out"}, {"name": "S", "body": "in"}],
    "links": [{"name": "I", "type": "revolute", "p": "in", "s": "ground", "at": [0, 0, 0],
               "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 2}}},
              {"name": "Y", "type": "revolute", "p": "arm", "s": "ground", "at": [0, 0, 0], "axis": "y",
               "drive": {"axis": "rz", "law": 0}},
              {"name": "O", "type": "lock", "mask": "e1 e2", "p": "out", "s": "arm", "at": [0, 0, 0],
               "orientation": {"axis": "y", "angle": "=fold"}},
              {"name": "J", "type": "homokinetic", "p": "P", "s": "S"}],
    "forces": [{"name": "load", "type": "applied_torque", "p": "out", "at": [0, 0, 0], "torque": [0, 0, -1], "axes": "body"}],
    "run": {"until": 1, "output": 1, "record": [{"w": "out.omega_body_z"}]}})";
  for (const char* fold : {"170", "179.86", "179.9", "179.99", "179.999"}) {
    const Outcome run = outcome_of(filled(text, "$fold", fold));
    CAPTURE(fold, run.error);
    REQUIRE(run.ended());
    CHECK(run.table.last("w") == Approx(2).epsilon(1e-6));
  }
}

TEST_CASE("links that switch at one instant do not depend on the order of the events", "[stability][start]") {
  // a bar on two pins; at 0.3 s one goes and another comes
  const std::string text = R"({"lockstep": 1, "planar": "off", "gravity": [0, -9.81, 0],
    "bodies": [{"name": "bar", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
    "links": [{"name": "left", "type": "revolute", "p": "bar", "s": "ground", "at": [0, 0, 0]},
              {"name": "right", "type": "revolute", "p": "bar", "s": "ground", "at": [1, 0, 0]},
              {"name": "middle", "type": "revolute", "p": "bar", "s": "ground", "at": [0.4, 0, 0], "active": false}],
    "events": [$events],
    "run": {"integrator": "dop853", "tolerance": 1e-10, "until": 1, "output": 0.5, "record": ["bar.x", "bar.y"]}})";
  const std::string a = R"({"name": "a", "at": 0.3, "deactivate": ["left"]})",
                    b = R"({"name": "b", "at": 0.3, "deactivate": ["right"], "activate": ["middle"]})",
                    both = R"({"name": "c", "at": 0.3, "deactivate": ["left", "right"], "activate": ["middle"]})";
  const Outcome one = outcome_of(filled(text, "$events", a + "," + b)),
                other = outcome_of(filled(text, "$events", b + "," + a)),
                together = outcome_of(filled(text, "$events", both));
  REQUIRE(one.ended());
  REQUIRE(other.ended());
  REQUIRE(together.ended());
  for (const Outcome* o : {&other, &together}) {
    CHECK(o->table.last("bar.x") == Approx(one.table.last("bar.x")).margin(1e-9));
    CHECK(o->table.last("bar.y") == Approx(one.table.last("bar.y")).margin(1e-9));
  }
  CHECK(one.table.last("bar.y") < -0.01);  // it falls about the middle pin
}

}  // namespace start_test
