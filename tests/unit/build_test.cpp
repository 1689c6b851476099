// SPDX-License-Identifier: BSD-3-Clause
// Scenes that are right: what the mechanism is made of.
#include <lockstep/scene.h>

#include <lockstep/author/lock.h>
#include <lockstep/author/registry.h>
#include <lockstep/sweep.h>
#include "framework/tools/scene_run/scene_run.h"
#include "tests/support/allocations.h"
#include "tests/support/catch.h"

namespace build_test {

using namespace lockstep;

namespace {

Mechanism mechanism(const std::string& members) {
  return build_mechanism(scene_from_text("{\"lockstep\": 1, " + members + "}", "good.json"), builtin_registry());
}

}  // namespace

TEST_CASE("bodies get mass, place and start from their keys", "[unit][scene]") {
  Mechanism m = mechanism(R"("gravity": ["0 m/s^2", -9.81, 0], "planar": "off", "bodies": [
    {"name": "rod", "rod": {"mass": "500 g", "from": [1, 0, 0], "to": [1, 2, 0], "axial_inertia": 0.01}, "omega_world": [0, 0, 3]},
    {"name": "ball", "sphere": {"density": 1000, "radius": "100 mm"}, "position": [0, 0, 5]},
    {"name": "free", "mass": 2, "center": [0.5, 0, 0], "inertia": {"xx": 1, "yy": 2, "zz": 2.5, "xy": 0.1}, "inertia_at": [0, 0, 0]},
    {"name": "bob", "particle": 3, "position": [0, 1, 0], "velocity": [1, 0, 0]},
    {"name": "two", "compound": [{"box": {"mass": 1, "size": [1, 1, 1]}}, {"box": {"mass": 1, "size": [1, 1, 1]}, "position": [2, 0, 0]}]},
    {"name": "base", "fixed": true}])");
  const System& s = m.system;
  CHECK(s.gravity()[1] == -9.81);
  CHECK(s.body("rod").mass.mass == Approx(0.5));
  CHECK(s.body("rod").home.x == Vec3(1, 1, 0));
  CHECK(s.body("rod").mass.J(1, 1) == Approx(0.5 * 4 / 12.0));
  CHECK(s.body("rod").start.w[2] == Approx(3));
  CHECK(s.body("ball").mass.mass == Approx(1000 * 4 / 3.0 * kPi * 1e-3));
  CHECK(s.body("free").mass.J(1, 1) == Approx(2 - 2 * 0.25));  // Steiner: given about the origin, kept about the centre
  CHECK(s.body("free").mass.J(0, 1) == Approx(0.1));
  CHECK(s.body("bob").freedoms == Freedoms::particle);
  CHECK(s.body("bob").start.v == Vec3(1, 0, 0));
  CHECK(s.body("two").mass.center.isApprox(Vec3(1, 0, 0)));
  CHECK(s.body("two").mass.J(2, 2) == Approx(2 * (1 / 6.0 + 1)));
  CHECK(s.body("base").fixed);
  CHECK(s.n_velocities() == 4 * 6 + 3);
}

TEST_CASE("a joint between bodies gets both markers at one place in the world", "[unit][scene]") {
  Mechanism m = mechanism(R"("bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": [2,0,0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [2,0,0], "axis": "y",
               "drive": {"axis": "rz", "speed": {"type": "ramp", "slope": 2}}, "active": false}])");
  const Lock& A = m.system.link("A");
  const auto [p, s] = A.pairs().front();
  CHECK(p->local.x.isApprox(Vec3(1, 0, 0)));
  CHECK(s->local.x.isApprox(Vec3(2, 0, 0)));
  CHECK((rotation(s->local.q) * Vec3::UnitZ()).isApprox(Vec3(0, 1, 0)));
  CHECK(A.driven()->n_drives() == 1);
  CHECK(A.row_count() == 6);
  CHECK_FALSE(A.active_at_start());
}

TEST_CASE("a body given with a marker gets the marker of that place", "[unit][scene]") {
  Mechanism m = mechanism(R"("bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": [2,0,0]}}],
    "markers": [{"name": "tip", "body": "arm", "at": [1,0,0], "orientation": {"axis": "x", "angle": "90 deg"}}],
    "links": [{"name": "A", "type": "spherical", "p": "tip", "s": "ground", "start": {"velocity": {"rz": "60 rpm"}}}])");
  const auto [p, s] = m.system.link("A").pairs().front();
  CHECK(s->local.x.isApprox(Vec3(2, 0, 0)));
  CHECK(rotation(s->local.q).isApprox(rotation(p->body->home.q * p->local.q)));
  REQUIRE(m.start_speeds.size() == 1);
  CHECK(m.start_speeds.front().value == Approx(kTwoPi));
}

TEST_CASE("run settings, records and events are read", "[unit][scene]") {
  Mechanism m = mechanism(R"("bodies": [{"name": "bob", "particle": 1}],
    "links": [{"name": "L", "type": "lock", "mask": "x y", "p": "bob", "s": "ground"}],
    "events": [{"name": "let go", "when": {"channel": "bob.z", "crosses": "10 mm", "direction": "rising"}, "deactivate": ["L"], "once": false}],
    "run": {"integrator": {"type": "dopri5", "fixed": true}, "step": "5 ms", "until": 2, "output": 0.5, "formulation": "quaternion",
            "stabilization": {"kind": "baumgarte", "alpha": 20, "beta": 30}, "solver": "dense", "record": ["bob.x", {"height": "bob.z"}]})");
  CHECK(m.run.step == 0.005);
  CHECK(m.run.tolerance.atol_x == Approx(1e-8));
  CHECK(m.run.formulation == Formulation::quaternion);
  CHECK(m.run.stabilization.kind == Stabilization::Kind::baumgarte);
  CHECK(m.run.stabilization.beta == 30);
  const std::unique_ptr<Recorder> recorder = make_recorder(m);
  CHECK(recorder->table().names() == std::vector<std::string>{"t", "bob.x", "height"});
  const std::vector<Event> events = make_events(m, *recorder);
  REQUIRE(events.size() == 1);
  CHECK(events.front().crossing == Event::Crossing::rising);
  CHECK_FALSE(events.front().once);
  CHECK(events.front().value);
  CHECK(make_solver(m.run, builtin_registry())->name() == "dense");
}

TEST_CASE("the heap use of building a scene grows with its size, not with its square", "[unit][scene]") {
  const Registry registry = builtin_registry();
  const auto asked = [&](int n) {  // a chain of links and of markers, whose long names are no short strings
    const auto name = [](const char* of, int k) { return std::string("a_long_name_of_a_") + of + std::to_string(k); };
    std::string bodies, markers, links;
    for (int k = 0; k < n; ++k) {
      const std::string comma = k == 0 ? "" : ", ", x = std::to_string(k);
      const std::string on = k == 0 ? "ground" : name("body", k - 1);
      bodies += comma + R"({"name": ")" + name("body", k) + R"(", "rod": {"mass": 1, "from": [)" + x +
                ", 0, 0], \"to\": [" + std::to_string(k + 1) + ", 0, 0]}}";
      markers += comma + R"({"name": ")" + name("marker", k) + R"(", "body": ")" + name("body", k) + R"("})";
      links += comma + R"({"name": ")" + name("link", k) + R"(", "type": "revolute", "p": ")" + name("body", k) +
               R"(", "s": ")" + on + R"(", "at": [)" + x + ", 0, 0]}";
    }
    const Scene scene = scene_from_text(
        R"({"lockstep": 1, "bodies": [)" + bodies + R"(], "markers": [)" + markers + R"(], "links": [)" + links + "]}",
        "chain.json");
    return allocations_of([&] { (void)build_mechanism(scene, registry); });
  };
  const long few = asked(100), many = asked(400);
  if (allocations_are_counted()) CHECK(few > 0);
  CHECK(double(many) <= 4.2 * double(few));
}

}  // namespace build_test
