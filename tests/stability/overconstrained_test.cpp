// SPDX-License-Identifier: BSD-3-Clause
// Overconstrained mechanisms: freedoms, dependencies, which reactions are unique, and the motion of a model without a
// row too many; in any frame of the world and any order of bodies and links.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include <lockstep/analysis.h>
#include <lockstep/assembly.h>
#include <lockstep/author/registry.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include <lockstep/sweep.h>
#include "framework/description/scene/system_of.h"
#include "framework/tools/rank/unknowns.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/worst.h"

namespace overconstrained_test {

using namespace lockstep;
using Json = nlohmann::ordered_json;
using Names = std::vector<std::string>;

namespace {

Json read_json(const std::string& path) {
  std::ifstream file(std::string(paths::kSource) + "/" + path);
  REQUIRE(file);
  return Json::parse(file);
}

/// A mechanism of the table: what theory says of it, and how its links become those of a model without redundant rows.
struct Case {
  std::string name;
  int freedoms, redundant;
  Names unique;  ///< patterns of the rows whose multipliers are unique: "*.x", "U?.cross"
  Json reduced;  ///< by link: the keys that change, or null where the link goes
  Json scene;

  std::string full_text() const { return scene.dump(); }
  std::string reduced_text() const {
    Json out = scene;
    Json links = Json::array();
    for (const Json& link : scene["joints"]) {
      const auto change = reduced.find(link["name"].get<std::string>());
      if (change != reduced.end() && change->is_null()) continue;
      links.push_back(link);
      if (change != reduced.end()) links.back().update(*change);
    }
    out["joints"] = links;
    return out.dump();
  }
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const Json& j : read_json("tests/verification/data/overconstrained.json"))
    all.push_back({j["scene"], j["freedoms"], j["redundant"], j["unique"], j["reduced"],
                   read_json("samples/scenes/overconstrained/" + j["scene"].get<std::string>() + ".json")});
  return all;
}

bool matches(std::string_view pattern, std::string_view text) {
  if (pattern.empty()) return text.empty();
  if (pattern[0] == '*') return matches(pattern.substr(1), text) || (!text.empty() && matches(pattern, text.substr(1)));
  return !text.empty() && (pattern[0] == '?' || pattern[0] == text[0]) && matches(pattern.substr(1), text.substr(1));
}

/// Another frame of the world, and another order of bodies and links.
struct View {
  Pose frame{};
  std::minstd_rand::result_type order = 0;  ///< 0: as written
};

View random_view(std::minstd_rand& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  const Vec3 x(number(random), number(random), number(random));
  Quat q{number(random), number(random), number(random), number(random)};
  return {{10 * x, normalized(q)}, random()};
}

Json shuffled(Json list, std::minstd_rand::result_type seed) {
  std::minstd_rand random(seed);
  for (std::size_t k = list.size(); k > 1; --k) std::swap(list[k - 1], list[random() % k]);
  return list;
}

void place(System& system, const Pose& frame) {
  const Mat3 A = rotation(frame.q);
  for (const Body& body : system.bodies()) {
    if (body.name == "ground") continue;
    Body& moved = system.body(body.name);
    moved.home = frame * body.home, moved.start.v = A * body.start.v;
  }
  for (const Marker& marker : system.markers())
    if (marker.body == &system.ground()) system.marker(marker.name).local = frame * marker.local;
  system.set_gravity(A * system.gravity());
  system.changed();
}

/// A mechanism in a view, with its assembled start.
struct Model {
  Mechanism mechanism;
  std::unique_ptr<Dynamics> dynamics;
  State start;

  Model(const std::string& text, const View& view) : mechanism(made(text, view)) {
    place(system_of(mechanism), view.frame);
    dynamics = std::make_unique<Dynamics>(system_of(mechanism), make_solver(mechanism.run, builtin_registry()),
                                          DynamicsOptions{mechanism.run.formulation, mechanism.run.stabilization});
    dynamics->set_up();
    start = mechanism.system.start();
    assemble(*dynamics, start, mechanism.start_speeds);
  }
  State run() {
    SimulationReport report;
    return run(mechanism.run, report);
  }
  State run(const RunSettings& settings, SimulationReport& report) {
    StepLoop loop(*dynamics, make_integrator(settings, builtin_registry()),
                  {.tolerance = settings.tolerance, .max_steps = settings.max_steps});
    loop.set_state(start);
    report = loop.run_until(settings.until);
    State end = loop.state();
    dynamics->to_slots(end);
    return end;
  }

 private:
  static Mechanism made(const std::string& text, const View& view) {
    if (view.order == 0) return build_mechanism(scene_from_text(text, "scene.json"), builtin_registry());
    Json scene = Json::parse(text);
    scene["bodies"] = shuffled(scene["bodies"], view.order), scene["joints"] = shuffled(scene["joints"], view.order);
    return build_mechanism(scene_from_text(scene.dump(), "scene.json"), builtin_registry());
  }
};

std::set<std::string> row_names(const System& system) {
  std::set<std::string> names;
  for (const auto& link : system.links())
    for (int k = 0; k < link->row_count(); ++k) names.insert(link->name() + "." + link->row_name(k));
  return names;
}

// What the joints' own axes show does not depend on the world's.
std::set<std::string> own_channels(const UniquenessReport& report) {
  std::set<std::string> own;
  for (const std::string& name : report.channels)
    if (name.find("_world_") == std::string::npos) own.insert(name);
  return own;
}

void check_counts(const Case& c, const View& view, std::set<std::string>& channels) {
  Model model(c.full_text(), view);
  const MobilityReport m = mobility(*model.dynamics, model.start);
  CHECK(m.freedoms == c.freedoms);
  CHECK(m.redundant == c.redundant);
  int too_many = 0;
  std::set<std::string> dependent;
  for (const Dependency& d : m.dependencies) {
    too_many += d.too_many;
    CHECK(d.nearly == 0);
    dependent.insert(d.rows.begin(), d.rows.end());
  }
  CHECK(too_many == c.redundant);

  const UniquenessReport u = uniqueness(*model.dynamics, model.start);
  CHECK(u.undetermined == c.redundant);
  const std::set<std::string> not_unique(u.rows.begin(), u.rows.end());
  CHECK(not_unique == dependent);
  for (const std::string& row : row_names(model.mechanism.system)) {
    const bool expected = std::ranges::any_of(c.unique, [&](const std::string& p) { return matches(p, row); });
    CAPTURE(row);
    CHECK(not_unique.contains(row) != expected);
  }
  if (channels.empty()) channels = own_channels(u);
  CHECK(channels == own_channels(u));
}

Vec3 on_axes(const Reactions& reactions, const Lock& link, const Inputs& in, bool moment) {
  const auto [p, s] = link.pairs().front();
  const LinkWrench w = reactions.on_body_of(MarkerFrame(*p), link, in);
  return in_world(MarkerFrame(*s), in).A.transpose() * (moment ? w.moment : w.force);
}

// Unique components are those of the model without redundant rows, which has no choice.
void check_reactions(Model& full, const State& at, Model& reduced, const State& reduced_at) {
  const UniquenessReport u = uniqueness(*full.dynamics, at);
  const Solution& a = full.dynamics->evaluate(at);
  const Solution& b = reduced.dynamics->evaluate(reduced_at);
  double scale = 0;
  for (const auto& link : full.mechanism.system.links())
    keep_worst(scale, on_axes(Reactions(a), *link, a.in, false).norm());
  for (const auto& link : full.mechanism.system.links()) {
    const auto& others = reduced.mechanism.system.links();
    const auto other = std::ranges::find(others, link->name(), [](const auto& l) { return l->name(); });
    for (const bool moment : {false, true}) {
      const Vec3 ours = on_axes(Reactions(a), *link, a.in, moment);
      const Vec3 theirs = other == others.end() ? Vec3::Zero() : on_axes(Reactions(b), **other, b.in, moment);
      for (int i = 0; i < 3; ++i) {
        const std::string name = link->name() + (moment ? ".torque" : ".force") + "_on_p_link_" + "xyz"[i];
        if (!u.unique(name)) continue;
        CAPTURE(name, ours[i], theirs[i]);
        CHECK(std::abs(ours[i] - theirs[i]) < 1e-8 * scale);
      }
    }
  }
}

void check_motion(const Case& c, const View& view) {
  Model full(c.full_text(), view), reduced(c.reduced_text(), View{});
  const MobilityReport m = mobility(*reduced.dynamics, reduced.start);
  CHECK(m.redundant == 0);
  CHECK(m.freedoms == c.freedoms);
  check_reactions(full, full.start, reduced, reduced.start);
  const State end = full.run(), reduced_end = reduced.run();
  double moved = 0;
  for (const Body& body : full.mechanism.system.bodies()) {
    if (body.fixed) continue;
    const Pose ours = body_pose(body, end);
    const Pose theirs = view.frame * body_pose(reduced.mechanism.system.body(body.name), reduced_end);
    const Pose before = body_pose(body, full.start);
    keep_worst(moved, (ours.x - before.x).norm()), keep_worst(moved, (rotation(ours.q) - rotation(before.q)).norm());
    CAPTURE(body.name);
    CHECK((ours.x - theirs.x).norm() < 1e-9);
    CHECK((rotation(ours.q) - rotation(theirs.q)).norm() < 1e-9);
  }
  if (c.freedoms > 0)
    CHECK(moved > 1e-3);
  else
    CHECK(moved < 1e-9);
  check_reactions(full, end, reduced, reduced_end);
}

// In each frame redundant rows lie otherwise across the axes of the joints. Accelerations are unique. Multipliers are the
// smallest in one metric; what is redundant in them has roundings of 1e-16 over a proximal term of 1e-9 or 1e-8.
void check_solver(const Case& c, const View& view, const char* solver) {
  const auto with = [&](const char* name) {
    Json scene = c.scene;
    scene["run"]["solver"] = name;
    return scene.dump();
  };
  Model ours(with(solver), view), referee(with("dense"), view);
  const Solution &a = ours.dynamics->evaluate(ours.start), &b = referee.dynamics->evaluate(ours.start);
  CHECK((a.a - b.a).lpNorm<Eigen::Infinity>() < 1e-9 * (1 + b.a.lpNorm<Eigen::Infinity>()));
  CHECK((a.lambda - b.lambda).lpNorm<Eigen::Infinity>() < 1e-5 * b.lambda.lpNorm<Eigen::Infinity>());
}

}  // namespace

TEST_CASE("overconstrained mechanisms: degrees of freedom, dependencies and unique reactions",
          "[stability][analysis]") {
  std::minstd_rand random(7);
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    std::set<std::string> channels;
    check_counts(c, View{}, channels);
    for (int k = 0; k < 2; ++k) check_counts(c, random_view(random), channels);
  }
}

namespace {

/// Which rows depend on which, without those that only nearly do.
std::vector<std::pair<Names, int>> dependent(const MobilityReport& report) {
  std::vector<std::pair<Names, int>> all;
  for (const Dependency& d : report.dependencies)
    if (d.too_many > 0) all.emplace_back(d.rows, d.too_many);
  return all;
}

}  // namespace

// What depends on what is a function of the links and the branch: alike in all poses that a free motion leads to.
TEST_CASE("constraints of overconstrained mechanisms depend on one another alike along a branch",
          "[stability][analysis]") {
  for (const Case& c : cases()) {
    if (c.freedoms == 0) continue;
    Mechanism m = build_mechanism(scene_from_text(c.full_text(), "scene.json"), builtin_registry());
    System& system = system_of(m);
    Dynamics dynamics(system, std::make_unique<SchurSolver>(), {Formulation::omega, {}});
    dynamics.set_up();
    State state = m.system.start();
    assemble(dynamics, state, m.start_speeds);
    MobilityReport first;  // a start in line with the axes of the world hides which rows depend
    VecX way = VecX::Zero(Unknowns(system).n());
    for (int pose = 1; pose <= 10; ++pose) {
      const MatX N = free_motions(dynamics.gather_rows(state));
      way = way.isZero(0) ? VecX(N.col(0)) : VecX(N * (N.transpose() * way));
      way.normalize();
      dynamics.advance(state, 0.05 * system.length(), Unknowns(system).motion_of(way));
      dynamics.project(state);
      const MobilityReport there = mobility(dynamics, state);
      CAPTURE(c.name, pose);
      if (pose == 1) first = there;
      CHECK(there.freedoms == c.freedoms);
      CHECK(there.redundant == c.redundant);
      CHECK(dependent(there) == dependent(first));
    }
  }
}

TEST_CASE("overconstrained mechanisms move as models without redundant constraints", "[stability][analysis]") {
  std::minstd_rand random(11);
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    check_motion(c, random_view(random));
  }
}

TEST_CASE("overconstrained mechanisms: all solvers agree with the referee in any frame", "[stability][solvers]") {
  std::minstd_rand random(17);
  for (const Case& c : cases())
    for (const char* solver : {"schur", "block", "sparse"})
      for (int k = 0; k < (c.name == "scissor_lift_20" ? 2 : solver == std::string("schur") ? 60 : 3); ++k) {
        CAPTURE(c.name, solver, k);
        check_solver(c, random_view(random), solver);
      }
}

// In large mechanisms round-off leaves more of the rows than their tolerance, and of rates from both sides of a position nine
// digits: neither is a reason to make steps smaller and smaller.
TEST_CASE("overconstrained mechanisms run on the constraints at any tolerance", "[stability][integrators]") {
  std::minstd_rand random(17);
  for (const Case& c : cases()) {
    if (c.freedoms == 0) continue;
    for (const double tolerance : {1e-6, 1e-9, 1e-11, 1e-12}) {
      Model plain(c.full_text(), View{}), ours(c.full_text(), random_view(random));
      CAPTURE(c.name, tolerance);
      RunSettings settings = ours.mechanism.run;
      settings.integrator = {"dop853"};
      settings.integrator.keys = Value::object({{"stages", "auto"}});
      settings.tolerance = {tolerance, 1e-2 * tolerance};
      settings.max_steps = 400;
      SimulationReport report;
      const State end = ours.run(settings, report);
      CHECK(report.steps < 200);
      CHECK(report.rejected < 400);
      CHECK(report.largest_violation < 1e-9);
      const State truth = plain.run();
      double off = 0;  // distances between bodies depend on no frame
      for (const Body& a : ours.mechanism.system.bodies())
        for (const Body& b : ours.mechanism.system.bodies()) {
          const Body &p = plain.mechanism.system.body(a.name), &q = plain.mechanism.system.body(b.name);
          if (a.fixed || b.fixed) continue;
          keep_worst(off, std::abs((body_pose(a, end).x - body_pose(b, end).x).norm() -
                                   (body_pose(p, truth).x - body_pose(q, truth).x).norm()));
        }
      CHECK(off < 50 * tolerance + 1e-9);
    }
  }
}

TEST_CASE("overconstrained mechanisms in a hundred frames and orders", "[stability][analysis][long]") {
  std::minstd_rand random(13);
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    std::set<std::string> channels;
    for (int k = 0; k < 100; ++k) {
      CAPTURE(k);
      const View view = random_view(random);
      check_counts(c, view, channels);
      if (k % (c.name == "scissor_lift_20" ? 25 : 1) == 0) check_motion(c, view);
    }
  }
}

}  // namespace overconstrained_test
