// SPDX-License-Identifier: BSD-3-Clause
// Singular positions: the branches that meet in one, what is said of runs that pass one with plain stages, starts in one.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include <lockstep/assembly.h>
#include <lockstep/author/registry.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include <lockstep/sweep.h>
#include "framework/description/scene/system_of.h"
#include "framework/tools/rank/branch_point.h"
#include "framework/tools/rank/doubts.h"
#include "framework/tools/rank/singular_watch.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/run_scene.h"

namespace singular_positions_test {

using namespace lockstep;

namespace {

std::string number(double x) { return std::to_string(x); }

std::string point(double x, double y) { return "[" + number(x) + ", " + number(y) + ", 0]"; }

std::string rod(const std::string& name, double x0, double y0, double x1, double y1) {
  return R"({"name": ")" + name + R"(", "rod": {"mass": 1, "axial_inertia": 1e-4, "from": )" + point(x0, y0) +
         R"(, "to": )" + point(x1, y1) + "}}";
}

std::string hinge(const std::string& name, const std::string& p, const std::string& s, double x, double y) {
  return R"({"name": ")" + name + R"(", "type": "revolute", "p": ")" + p + R"(", "s": ")" + s + R"(", "at": )" +
         point(x, y) + "}";
}

std::string scene(const std::string& bodies, const std::string& links, bool planar) {
  return R"({"lockstep": 1, "planar": ")" + std::string(planar ? "z" : "off") + R"(", "bodies": [)" + bodies +
         R"(], "links": [)" + links + R"(], "run": {"until": 1, "integrator": "dop853"}})";
}

/// n cranks of length r, side by side at distances L, and one coupler, all on the x axis.
std::string flat_cranks(int n, double r, double L, bool planar) {
  std::string bodies = rod("coupler", r, 0, r + (n - 1) * L, 0), links;
  for (int k = 0; k < n; ++k) {
    const std::string name = "crank_" + std::to_string(k);
    bodies += ", " + rod(name, k * L, 0, k * L + r, 0);
    links += (k > 0 ? ", " : "") + hinge("A" + std::to_string(k), name, "ground", k * L, 0) + ", " +
             hinge("B" + std::to_string(k), "coupler", name, k * L + r, 0);
  }
  return scene(bodies, links, planar);
}

/// Crank and rod of one length, upright and folded; the slider stands on the axis of the crank and slides along x.
std::string folded_slider_crank(bool planar) {
  return scene(
      rod("crank", 0, 0, 0, 0.2) + ", " + rod("rod", 0, 0.2, 0, 0) +
          R"(, {"name": "slider", "mass": 3, "inertia": [0.01, 0.01, 0.01]})",
      hinge("A", "crank", "ground", 0, 0) + ", " + hinge("B", "rod", "crank", 0, 0.2) + ", " +
          hinge("C", "rod", "slider", 0, 0) +
          R"(, {"name": "G", "type": "prismatic", "p": "slider", "s": "ground", "at": [0, 0, 0], "axis": "x"})",
      planar);
}

/// A kite of sides 1, 1, 2, 2, the ground among them, folded onto the x axis: B lies on D.
std::string folded_kite(bool planar) {
  return scene(rod("short", 0, 0, 1, 0) + ", " + rod("long", 1, 0, -1, 0) + ", " + rod("other", -1, 0, 1, 0),
               hinge("A", "short", "ground", 0, 0) + ", " + hinge("B", "long", "short", 1, 0) + ", " +
                   hinge("C", "other", "long", -1, 0) + ", " + hinge("D", "other", "ground", 1, 0),
               planar);
}

struct Model {
  Mechanism m;
  Dynamics dynamics;
  State state;
  explicit Model(const std::string& text)
      : m(build_mechanism(scene_from_text(text, "scene.json"), builtin_registry())),
        dynamics(system_of(m), std::make_unique<SchurSolver>(), {Formulation::omega, {}}),
        state(m.system.start()) {
    dynamics.set_up();
  }
  /// Turn about z of a body in a motion, rad.
  double turn(const std::string& body, const VecX& motion) const {
    const int slot = m.system.body(body).slot;
    return (rotation(state.slot_pose(slot).q) * Vec3(motion.segment<3>(6 * slot + 3)))[2];
  }
};

/// Ratios of two bodies' turns, one for each branch.
std::vector<double> ratios(const Model& model, const BranchPoint& at, const std::string& a, const std::string& b) {
  std::vector<double> all;
  for (const VecX& tangent : at.tangents) all.push_back(model.turn(a, tangent) / model.turn(b, tangent));
  std::ranges::sort(all);
  return all;
}

// The turns of one body over those of another along the branches of a folded mechanism, in rising order.
void check_two_branches(const std::string& scene, const char* one, const char* other, double first, double second) {
  Model model(scene);
  const BranchPoint at = branch_point(model.dynamics, model.state);
  CAPTURE(at.text(model.dynamics, model.state));
  CHECK(at.singular);
  const std::vector<double> found = ratios(model, at, one, other);
  REQUIRE(found.size() == 2);
  CHECK(found[0] == Approx(first).epsilon(1e-6).margin(1e-6 * (first == 0)));
  CHECK(found[1] == Approx(second).epsilon(1e-6));
}

}  // namespace

// x, to second order: r w1^2 + L p^2 = r w2^2, with p = r (w2 - w1)/L; so w2 = w1, or w2 (L - r) = -w1 (L + r).
TEST_CASE("a flat parallelogram has two branches, and their tangents are known", "[stability][analysis]") {
  const bool planar = GENERATE(true, false);
  constexpr double r = 0.3, L = 1.1;
  Model model(flat_cranks(2, r, L, planar));
  const BranchPoint at = branch_point(model.dynamics, model.state);
  CAPTURE(planar, at.text(model.dynamics, model.state));
  CHECK(at.singular);
  CHECK(at.all);
  CHECK(at.motions == 2);
  const std::vector<double> found = ratios(model, at, "crank_1", "crank_0");
  REQUIRE(found.size() == 2);
  CHECK(found[0] == Approx(-(L + r) / (L - r)).epsilon(1e-6));
  CHECK(found[1] == Approx(1).epsilon(1e-6));
}

// The third crank turns as the first two allow on one branch only.
TEST_CASE("three flat cranks have one branch", "[stability][analysis]") {
  const bool planar = GENERATE(true, false);
  Model model(flat_cranks(3, 0.3, 1.1, planar));
  const BranchPoint at = branch_point(model.dynamics, model.state);
  CAPTURE(planar, at.text(model.dynamics, model.state));
  CHECK(at.singular);
  CHECK(at.motions == 2);
  REQUIRE(at.tangents.size() == 1);
  CHECK(ratios(model, at, "crank_2", "crank_0")[0] == Approx(1).epsilon(1e-6));
  CHECK(std::abs(model.turn("coupler", at.tangents[0])) < 1e-6);
}

// Either the slider moves, and the rod turns against the crank, or it stands, and they turn together.
TEST_CASE("a folded slider-crank of equal arms has two branches", "[stability][analysis]") {
  const bool planar = GENERATE(true, false);
  CAPTURE(planar);
  check_two_branches(folded_slider_crank(planar), "rod", "crank", -1, 1);
}

// The loop, with turns t1 of the short side and t2, t3 of the long ones, to second order:
//   x: -t1^2 + 2 t2^2 - 2 t3^2 = 0,   y: t1 - 2 t2 + 2 t3 = 0
// t1 = 2 (t2 - t3): 4 (t2 - t3)^2 = 2 (t2 - t3)(t2 + t3), so t2 = t3 with t1 = 0, or t2 = 3 t3 with t1 = 4 t3.
TEST_CASE("a folded kite has two branches", "[stability][analysis]") {
  const bool planar = GENERATE(true, false);
  CAPTURE(planar);
  check_two_branches(folded_kite(planar), "short", "other", 0, 4);
}

TEST_CASE("regular positions of overconstrained mechanisms are no singular ones", "[stability][analysis]") {
  const std::string name = GENERATE("four_bar", "kite", "antiparallelogram", "slider_crank", "bennett", "bricard",
                                    "spherical_four_bar", "sarrus", "parallel_cranks_5", "peaucellier", "delta");
  Mechanism m =
      build_mechanism(read_scene(std::string(paths::kSource) + "/samples/scenes/overconstrained/" + name + ".json"),
                      builtin_registry());
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>(), {Formulation::omega, {}});
  dynamics.set_up();
  State state = m.system.start();
  assemble(dynamics, state, m.start_speeds);
  const BranchPoint at = branch_point(dynamics, state);
  CAPTURE(name, at.motions, at.nearness);
  CHECK(at.known);
  CHECK_FALSE(at.singular);
  CHECK(at.nearness > 1e-4);
}

namespace {

/// A law that counts how often it is asked.
class Asked final : public MotionLaw {
 public:
  explicit Asked(long& times) : times_(times) {}
  LawValue at(double) const override {
    ++times_;
    return {};
  }

 private:
  long& times_;
};

/// A slide that its law holds, apart from everything else: each gathering of the rows asks the law.
void count_gatherings(System& system, long& times) {
  Body& slide = system.add_body("slide", MassProperties{1, Vec3::Zero(), Mat3::Identity()}, {Vec3(0, -9, 0), {}});
  system.add<Prismatic>("counted", slide, system.ground(), pose_at({0, -9, 0}))
      .drive(Axis::z, std::make_shared<Asked>(times));
}

/// Flat parallelograms that have nothing to do with one another, free rods, and a chain that hangs on the first.
std::string flat_parallelograms(int n, int n_free, int n_chain) {
  std::string bodies, links;
  const auto add = [](std::string& list, const std::string& more) { list += (list.empty() ? "" : ", ") + more; };
  for (int k = 0; k < n; ++k) {
    const std::string at = std::to_string(k);
    add(bodies, rod("coupler_" + at, 0.3, k, 1.4, k));
    for (int side = 0; side < 2; ++side) {
      const std::string name = (side == 0 ? "left_" : "right_") + at;
      add(bodies, rod(name, 1.1 * side, k, 1.1 * side + 0.3, k));
      add(links, hinge("A_" + name, name, "ground", 1.1 * side, k));
      add(links, hinge("B_" + name, "coupler_" + at, name, 1.1 * side + 0.3, k));
    }
  }
  for (int k = 0; k < n_free; ++k) add(bodies, rod("free_" + std::to_string(k), 5, k, 6, k));
  for (int k = 0; k < n_chain; ++k) {
    add(bodies, rod("chain_" + std::to_string(k), 1.4, -k, 1.4, -k - 1));
    add(links, hinge("C_" + std::to_string(k), "chain_" + std::to_string(k),
                     k == 0 ? "coupler_0" : "chain_" + std::to_string(k - 1), 1.4, -k));
  }
  return scene(bodies, links, false);
}

}  // namespace

TEST_CASE("bodies outside a loop neither hide its branches nor add to their cost", "[stability][analysis]") {
  Mechanism m = build_mechanism(scene_from_text(flat_parallelograms(1, 300, 70), "scene.json"), builtin_registry());
  long times = 0;
  count_gatherings(system_of(m), times);
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>(), {Formulation::omega, {}});
  dynamics.set_up();
  const State state = m.system.start();
  times = 0;
  const BranchPoint at = branch_point(dynamics, state);
  CHECK(times > 0);
  CHECK(times <= 26);
  CHECK(at.known);
  CHECK(at.singular);
  CHECK(at.all);
  CHECK(at.motions == 2);
  REQUIRE(at.tangents.size() == 2);
  VecX v = VecX::Zero(state.v.size());
  v[6 * m.system.body("free_7").slot] = 1;
  CHECK_FALSE(at.moves(v));
  v += at.tangents[0];
  CHECK(at.moves(v));
  CHECK(at.off_branches(m.system, v) < 1e-9);
}

TEST_CASE("a singular configuration is reported in few evaluations, for any number of motions",
          "[stability][analysis]") {
  const int n = GENERATE(2, 6, 12);
  Mechanism m = build_mechanism(scene_from_text(flat_parallelograms(n, 0, 0), "scene.json"), builtin_registry());
  long times = 0;
  count_gatherings(system_of(m), times);
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>(), {Formulation::omega, {}});
  dynamics.set_up();
  times = 0;
  const BranchPoint at = branch_point(dynamics, m.system.start());
  CAPTURE(n, times);
  CHECK(at.motions == 2 * n);
  CHECK(at.singular);
  CHECK_FALSE(at.all);
  CHECK(times > 0);
  CHECK(times <= 26);
}

namespace {

std::vector<PassedPosition> watch(const std::string& text, const std::string& method, double step, double until,
                                  double speed) {
  Model model(text);
  assemble(model.dynamics, model.state, {{"A0", Axis::rz, speed}});
  RunSettings run;
  run.integrator = {method};
  run.step = step;
  run.tolerance = {1e-9, 1e-11};
  StepLoop loop(model.dynamics, make_integrator(run, builtin_registry()), {.step = step, .tolerance = run.tolerance});
  SingularWatch singular(system_of(model.m));
  loop.add_observer(singular);
  loop.set_state(model.state);
  loop.run_until(until);
  return singular.passed();
}

/// Two upright cranks without gravity: they turn on at one rate, and lie flat at a quarter turn, three quarters, ...
std::string upright_cranks() {
  std::string text = scene(
      rod("coupler", 0, 0.3, 1.1, 0.3) + ", " + rod("crank_0", 0, 0, 0, 0.3) + ", " + rod("crank_1", 1.1, 0, 1.1, 0.3),
      hinge("A0", "crank_0", "ground", 0, 0) + ", " + hinge("B0", "coupler", "crank_0", 0, 0.3) + ", " +
          hinge("A1", "crank_1", "ground", 1.1, 0) + ", " + hinge("B1", "coupler", "crank_1", 1.1, 0.3),
      true);
  return text.insert(1, R"("gravity": [0, 0, 0], )");
}

}  // namespace

TEST_CASE("singular configurations passed with unprojected stages are found, with their times and joints",
          "[stability][analysis]") {
  const auto [method, step] = GENERATE(table<std::string, double>({{"rk4", 1e-3}, {"rk4", 0.01}, {"rattle2", 1e-3}}));
  constexpr double kSpeed = 2;  // rad/s, constant
  const std::vector<PassedPosition> passed = watch(upright_cranks(), method, step, 1.5, kSpeed);
  CAPTURE(method, step);
  REQUIRE(!passed.empty());
  CHECK(passed[0].t == Approx(0.25 * std::numbers::pi * 2 / kSpeed).margin(2e-3));
  std::vector<std::string> links = passed[0].links;
  std::ranges::sort(links);
  CHECK(links == std::vector<std::string>{"A0", "A1", "B0", "B1"});
  CHECK(passed[0].indicator < 1e-6);
  CHECK(passed.size() == 1);
}

// The second crank drives a third one of another length, whose bay stays regular.
TEST_CASE("the joints of a flat bay are named, and not those of its neighbour", "[stability][analysis]") {
  std::string text = upright_cranks();
  const auto append = [&](const std::string& before, const std::string& more) {
    text.insert(text.find(before), ", " + more);
  };
  append(R"(], "links")", rod("crank_2", 2.4, 0, 2.3, 0.6) + ", " + rod("coupler_2", 1.1, 0.3, 2.3, 0.6));
  append(R"(], "run")", hinge("C1", "coupler_2", "crank_1", 1.1, 0.3) + ", " +
                            hinge("C2", "coupler_2", "crank_2", 2.3, 0.6) + ", " +
                            hinge("A2", "crank_2", "ground", 2.4, 0));
  const std::vector<PassedPosition> passed = watch(text, "rk4", 1e-3, 1.2, 2.0);
  REQUIRE(passed.size() == 1);
  std::vector<std::string> links = passed[0].links;
  std::ranges::sort(links);
  CHECK(links == std::vector<std::string>{"A0", "A1", "B0", "B1"});
}

// The trusted history says between which of its rows the first upright passes the line through its bearings.
TEST_CASE("the ten singular configurations of two bays are found", "[stability][analysis]") {
  const Table truth = trusted("nfourbar_2");
  Mechanism m = build_mechanism(read_scene(scene_path("nfourbar_2")), builtin_registry());
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>(), {Formulation::omega, {}});
  State start = m.system.start();
  assemble(dynamics, start, m.start_speeds);
  RunSettings settings = m.run;
  settings.integrator = {"rk4"}, settings.step = 1e-3;
  StepLoop loop(dynamics, make_integrator(settings, builtin_registry()), {.step = 1e-3});
  SingularWatch singular(system_of(m));
  loop.add_observer(singular);
  loop.set_state(start);
  loop.run_until(10);
  std::vector<std::pair<double, double>> intervals;
  for (std::size_t i = 1; i < truth.n_rows(); ++i)
    if (truth["B0y"][i - 1] * truth["B0y"][i] < 0) intervals.emplace_back(truth["t"][i - 1], truth["t"][i]);
  CHECK(intervals.size() == 10);
  REQUIRE(singular.passed().size() == intervals.size());
  for (std::size_t k = 0; k < intervals.size(); ++k) {
    CAPTURE(k);
    CHECK(singular.passed()[k].t > intervals[k].first);
    CHECK(singular.passed()[k].t < intervals[k].second);
  }
}

TEST_CASE("the monitor finds nothing if no configuration is singular", "[stability][analysis]") {
  // One crank shorter: a crank-rocker, whose rods never lie in line.
  const std::string text = scene(
      rod("coupler", 0, 0.3, 1.1, 0.6) + ", " + rod("crank_0", 0, 0, 0, 0.3) + ", " + rod("crank_1", 1.1, 0, 1.1, 0.6),
      hinge("A0", "crank_0", "ground", 0, 0) + ", " + hinge("B0", "coupler", "crank_0", 0, 0.3) + ", " +
          hinge("A1", "crank_1", "ground", 1.1, 0) + ", " + hinge("B1", "coupler", "crank_1", 1.1, 0.6),
      true);
  CHECK(watch(text, "rk4", 1e-3, 4, 4).empty());
}

namespace {

/// What becomes of cranks that turn at 1 rad/s and begin `before` rad from where they lie flat, after 1 s.
struct Passage {
  bool ended = false, watched = false;
  double error = HUGE_VAL;  ///< of the crank's angle, rad: it turns on at one rate
  long steps = 0;
};

Passage pass(const std::string& method, double tolerance, double step, double before) {
  const double x = 0.3 * std::cos(before), y = -0.3 * std::sin(before);
  const auto exact = [](double v) { return fmt::format("{:.17g}", v); };
  const auto rod_to = [&](const char* name, double from, double to_x) {
    return fmt::format(
        R"({{"name": "{}", "rod": {{"mass": 1, "axial_inertia": 1e-4, "from": [{}, 0, 0], "to": [{}, {}, 0]}}}})", name,
        exact(from), exact(to_x), exact(y));
  };
  const auto hinge_at = [&](const char* name, const char* p, const char* s, double at_x, double at_y) {
    return fmt::format(R"({{"name": "{}", "type": "revolute", "p": "{}", "s": "{}", "at": [{}, {}, 0]}})", name, p, s,
                       exact(at_x), exact(at_y));
  };
  const std::string coupler = fmt::format(
      R"({{"name": "coupler", "rod": {{"mass": 1, "axial_inertia": 1e-4, "from": [{0}, {1}, 0], "to": [{2}, {1}, 0]}}}})",
      exact(x), exact(y), exact(1.1 + x));
  Model model(scene(coupler + ", " + rod_to("crank_0", 0, x) + ", " + rod_to("crank_1", 1.1, 1.1 + x),
                    hinge_at("A0", "crank_0", "ground", 0, 0) + ", " + hinge_at("B0", "coupler", "crank_0", x, y) +
                        ", " + hinge_at("A1", "crank_1", "ground", 1.1, 0) + ", " +
                        hinge_at("B1", "coupler", "crank_1", 1.1 + x, y),
                    true));
  assemble(model.dynamics, model.state, {{"A0", Axis::rz, 1.0}, {"A1", Axis::rz, 1.0}});
  RunSettings run;
  run.integrator = {method}, run.step = step, run.tolerance = {tolerance, 1e-2 * tolerance};
  StepLoop loop(model.dynamics, make_integrator(run, builtin_registry()),
                {.step = step, .tolerance = run.tolerance, .max_steps = 20000});
  SingularWatch singular(system_of(model.m));
  loop.add_observer(singular);
  Passage out;
  try {
    loop.set_state(model.state);
    loop.run_until(1);
    out.ended = true;
  } catch (const Error&) {
  }
  out.watched = !singular.passed().empty();
  out.steps = loop.report().steps;
  State end = loop.state();
  model.dynamics.to_slots(end);
  const Quat turned =
      conjugate(model.m.system.body("crank_0").home.q) * body_pose(model.m.system.body("crank_0"), end).q;
  out.error = std::abs(2 * std::atan2(turned.vec()[2], turned.w) - 1);
  return out;
}

}  // namespace

// From afar and from a millionth of a radian before the position, at tolerances to the edge of round-off.
TEST_CASE("a singular configuration is passed from any distance at any tolerance", "[stability][integrators]") {
  for (const char* method : {"dopri5", "dop853"})
    for (const double before : {0.3, 1e-2, 1e-4, 1e-6})
      for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10, 1e-12}) {
        const Passage p = pass(method, tolerance, 0, before);
        CAPTURE(method, before, tolerance, p.ended, p.error, p.steps);
        CHECK(p.ended);
        CHECK(p.error < 20 * tolerance + 1e-9);
        CHECK(p.steps < 500);
      }
}

// Two cranks and a coupler of 1 kg each, the cranks 1 m long: (5/6) theta'^2 = 2 g (sin theta_0 - sin theta).
TEST_CASE("a start at rest near a singular configuration continues at any tolerance", "[stability][integrators]") {
  for (const Formulation formulation : {Formulation::omega, Formulation::joint})
    for (const double angle : {0.05, 0.02, 5e-3, 1e-3})
      for (const double tolerance : {1e-6, 1e-9, 1e-12}) {
        CAPTURE(to_string(formulation), angle, tolerance);
        System system({.gravity = Vec3(0, -9.81, 0)});
        const Vec3 tip(std::cos(angle), std::sin(angle), 0), right(2, 0, 0);
        const auto rod = [&](const char* name, const Vec3& middle, double length, double turned) -> Body& {
          const double J = length * length / 12;
          return system.add_body(name, {1.0, Vec3::Zero(), Vec3(1e-4, J, J).asDiagonal()},
                                 {middle, axis_angle(Vec3::UnitZ(), turned)});
        };
        Body &left = rod("left", 0.5 * tip, 1, angle), &other = rod("right", right + 0.5 * tip, 1, angle),
             &bar = rod("bar", tip + 0.5 * right, 2, 0);
        const auto hinge = [&](const char* name, Body& p, Body& s, const Vec3& at) {
          system.add<Revolute>(name, p, s, Pose{at, {}});
        };
        hinge("A", left, system.ground(), Vec3::Zero()), hinge("B", other, system.ground(), right);
        hinge("C", bar, left, tip), hinge("D", bar, other, right + tip);
        Dynamics dynamics(system, std::make_unique<SchurSolver>(), {formulation, {}});
        StepLoop loop(dynamics, std::make_unique<Dopri5>(), {.tolerance = {tolerance, 1e-2 * tolerance}});
        loop.run_until(0.5);
        State end = loop.state();
        dynamics.to_slots(end);
        const double sine = 2 * body_pose(left, end).x[1], w = body_twist(left, end).w[2];
        CHECK(w < -1);
        CHECK(std::abs(5.0 / 6 * w * w - 2 * 9.81 * (std::sin(angle) - sine)) < 100 * tolerance + 1e-9);
        CHECK(loop.report().rejected < 30);
      }
}

TEST_CASE(
    "methods with unprojected stages pass a singular configuration correctly, and it is reported from any distance",
    "[stability][integrators]") {
  struct Plain {
    const char* method;
    double step;
  };
  for (const Plain& plain : {Plain{"rk4", 1e-2}, Plain{"rattle2", 1e-2}, Plain{"rattle4", 1e-2}, Plain{"radau5", 0},
                             Plain{"generalized_alpha", 1e-2}, Plain{"semi_implicit_euler", 1e-3}})
    for (const double before : {0.3, 0.1, 0.05, 0.03, 0.02, 0.015, 1e-2, 7e-3, 3e-3, 1e-3, 1e-4, 1e-6}) {
      const Passage p = pass(plain.method, 1e-8, plain.step, before);
      CAPTURE(plain.method, before, p.ended, p.watched, p.error, p.steps);
      CHECK((!p.ended || p.watched));
      if (p.ended) CHECK(p.error < 1e-3);
    }
}

TEST_CASE("a motion away from a singular configuration passes none", "[stability][integrators]") {
  for (const char* method : {"rk4", "radau5"})
    for (const double before : {-3e-3, -1e-2, -0.1}) {
      const Passage p = pass(method, 1e-8, method[1] == 'k' ? 1e-2 : 0, before);
      CAPTURE(method, before);
      CHECK(p.ended);
      CHECK_FALSE(p.watched);
    }
}

}  // namespace singular_positions_test
