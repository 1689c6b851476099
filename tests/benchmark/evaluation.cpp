// SPDX-License-Identifier: BSD-3-Clause
// Time of one evaluation of the equations of motion a body: trees, redundant ladders and stars, in space and in their
// plane, against the articulated-body yardstick in the same run. A table, and evaluation.csv. Of large ladders also
// what they hold in memory, and how long it takes to read a scene and to count its freedoms. With the word "large" also
// its redundant rows, whose count takes half a minute.
#include <fstream>

#include <malloc.h>

#include <spdlog/fmt/fmt.h>

#include <lockstep/analysis.h>
#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/joints.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include "framework/description/scene/system_of.h"
#include "framework/tools/precision/work_precision.h"
#include "samples/shared/output.h"
#include "tests/benchmark/articulated.h"

using namespace lockstep;

namespace {

const Vec3 kJ(0.01, 1.0 / 12, 1.0 / 12);

Body& add_rod(System& s, const std::string& name, const Vec3& middle, double angle = 0) {
  return s.add_body(name, {1.0, Vec3::Zero(), kJ.asDiagonal()}, {middle, axis_angle(Vec3(0, 0, 1), angle)});
}

/// n rods end to end along x; axes z, or z and y in turn.
System chain(int n, bool spatial) {
  System s({.gravity = Vec3(0, -9.81, 0)});
  Body* last = &s.ground();
  for (int i = 0; i < n; ++i) {
    Body& b = add_rod(s, "rod" + std::to_string(i), Vec3(i + 0.5, 0, 0));
    s.add<Revolute>("hinge" + std::to_string(i), b, *last,
                    pose_at(Vec3(i, 0, 0), spatial && i % 2 == 1 ? Vec3(0, 1, 0) : Vec3(0, 0, 1)));
    last = &b;
  }
  return s;
}

/// n bays of parallel four-bars at 1.2 rad from flat: redundant in space, and closed n times.
System ladder(int n) {
  System s({.gravity = Vec3(0, -9.81, 0)});
  const Vec3 up(std::cos(1.2), std::sin(1.2), 0);
  std::vector<Body*> uprights;
  for (int i = 0; i <= n; ++i) {
    uprights.push_back(&add_rod(s, "upright" + std::to_string(i), Vec3(i, 0, 0) + 0.5 * up, 1.2));
    s.add<Revolute>("foot" + std::to_string(i), *uprights.back(), s.ground(), pose_at(Vec3(i, 0, 0)));
  }
  for (int i = 0; i < n; ++i) {
    Body& bar = add_rod(s, "bar" + std::to_string(i), Vec3(i + 0.5, 0, 0) + up);
    s.add<Revolute>("left" + std::to_string(i), bar, *uprights[i], pose_at(Vec3(i, 0, 0) + up));
    s.add<Revolute>("right" + std::to_string(i), bar, *uprights[i + 1], pose_at(Vec3(i + 1, 0, 0) + up));
  }
  return s;
}

/// A plate with n rods on ball joints around it.
System star(int n) {
  System s({.gravity = Vec3(0, -9.81, 0)});
  Body& plate = s.add_body("plate", MassProperties{10.0, Vec3::Zero(), Vec3(1, 1, 2).asDiagonal()});
  s.add<Spherical>("pivot", plate, s.ground(), pose_at(Vec3(0, 0, 0)));
  for (int i = 0; i < n; ++i) {
    const double angle = kTwoPi * i / n;
    const Vec3 out(std::cos(angle), std::sin(angle), 0);
    s.add<Spherical>("arm" + std::to_string(i), add_rod(s, "rod" + std::to_string(i), 1.5 * out, angle), plate,
                     pose_at(out));
  }
  return s;
}

constexpr int kLargest = 50000,  // bays of a ladder
    kAll = 20000;                // bodies; of more only joint coordinates are taken

/// Nanoseconds of one call a body: the least of nine rounds of 20 ms.
template <class F>
double nanoseconds(int bodies, F&& call) {
  const int calls = std::max(1, 2000 / bodies);  // the clock itself costs as much as some of them
  double best = HUGE_VAL;
  for (int round = 0; round < 9; ++round) {
    long n = 0;
    const double begin = thread_seconds();
    double spent = 0;
    for (; spent < 0.02; spent = thread_seconds() - begin)
      for (int i = 0; i < calls; ++i, ++n) call();
    best = std::min(best, 1e9 * spent / static_cast<double>(n));
  }
  return best / bodies;
}

struct Line {
  std::string mechanism;
  int bodies = 0;
  double schur = 0, sparse = 0, joint = 0, planar = 0, planar_joint = 0, articulated = 0;
  int corrections = 0;
};

double time_of(System& s, bool turning, std::unique_ptr<LinearSolver> solver, int* corrections = nullptr,
               Formulation formulation = Formulation::omega) {
  Dynamics dynamics(s, std::move(solver), {formulation, {}});
  State state = s.start();
  if (turning)
    for (int k = 0; k < s.n_slots(); ++k) state.v[6 * k + 5] = 0.3 + 0.1 * k;
  StateRate rate;
  dynamics.project_velocity(state);
  dynamics.to_formulation(state);
  double& speed = state.v[state.coordinates ? 0 : 5];
  const double time = nanoseconds(s.n_slots(), [&] { speed += 1e-13, dynamics.rates(state, rate); });
  if (corrections) *corrections = dynamics.rate(state, rate).report.corrections;
  return time;
}

Line measure(const std::string& name, const std::function<System()>& make, bool planar, bool in_space = true) {
  Line line;
  line.mechanism = name;
  System s = make();
  s.setup();
  line.bodies = s.n_slots();
  const bool all = line.bodies <= kAll;
  if (all) line.schur = time_of(s, true, std::make_unique<SchurSolver>(), &line.corrections);
  if (line.bodies <= 1000) line.sparse = time_of(s, true, std::make_unique<SparseSolver>());
  if (in_space &&
      Dynamics(s, std::make_unique<SchurSolver>(), {Formulation::joint, {}}).why_not_joint(s.start().modes).empty())
    line.joint = time_of(s, true, std::make_unique<SchurSolver>(), nullptr, Formulation::joint);
  if (!planar) return line;
  System flat = make();
  flat.set_planar(settle_in_plane(flat));
  if (all) line.planar = time_of(flat, true, std::make_unique<SchurSolver>());
  line.planar_joint = time_of(flat, true, std::make_unique<SchurSolver>(), nullptr, Formulation::joint);
  return line;
}

double articulated(int n, bool spatial) {
  benchmark::ArticulatedChain c;
  c.gravity = Vec3(0, -9.81, 0);
  for (int i = 0; i < n; ++i)
    c.links.push_back({spatial && i % 2 == 1 ? Vec3(0, 1, 0) : Vec3(0, 0, 1), 1.0, 1.0, kJ, 0.1 * i, 0.3, 0});
  return nanoseconds(n, [&] { c.links[0].q += 1e-13, c.evaluate(); });
}

double heap() {
  const struct mallinfo2 m = mallinfo2();
  return static_cast<double>(m.uordblks) + static_cast<double>(m.hblkhd);
}

/// What a system and its dynamics hold after an evaluation, bytes a body.
double memory(const std::function<System()>& make, bool planar, Formulation formulation) {
  const double before = heap();
  System s = make();
  if (planar) s.set_planar(settle_in_plane(s));
  Dynamics dynamics(s, std::make_unique<SchurSolver>(), {formulation, {}});
  State state = s.start();
  StateRate rate;
  dynamics.to_formulation(state);
  dynamics.rates(state, rate);
  return (heap() - before) / s.n_slots();
}

/// A scene of bodies and hinges.
std::string scene_of(const System& s) {
  const auto list = [](const auto& x) { return fmt::format("[{}, {}, {}]", x[0], x[1], x[2]); };
  std::string bodies, links;
  for (const Body& b : s.bodies())
    if (!b.fixed)
      bodies += fmt::format(
          R"({}{{"name": "{}", "mass": {}, "inertia": {}, "position": {}, "orientation": [{}, {}, {}, {}]}})",
          bodies.empty() ? "" : ",\n", b.name, b.mass.mass, list(b.mass.J.diagonal()), list(b.home.x), b.home.q.w,
          b.home.q.x, b.home.q.y, b.home.q.z);
  for (const auto& link : s.links()) {
    const auto [p, q] = link->pairs().front();
    links += fmt::format(R"({}{{"name": "{}", "type": "revolute", "p": "{}", "s": "{}", "at": {}}})",
                         links.empty() ? "" : ",\n", link->name(), p->body->name, q->body->name,
                         list((p->body->home * p->local).x));
  }
  return fmt::format(R"({{"lockstep": 1, "gravity": [0, -9.81, 0], "bodies": [{}], "links": [{}]}})", bodies, links);
}

/// Seconds from the text of a scene to the freedoms of its mechanism.
double load(const System& of, int& freedoms) {
  const std::string text = scene_of(of);
  const Registry registry = builtin_registry();
  const double begin = thread_seconds();
  Mechanism m = build_mechanism(scene_from_text(text, "ladder"), registry);
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>());
  freedoms = mobility(dynamics, m.system.start()).freedoms;
  return thread_seconds() - begin;
}

}  // namespace

int main(int argc, char** argv) {
  const bool large = argc > 1 && std::string_view(argv[1]) == "large";
  std::vector<Line> lines;
  for (const int n : {1, 2, 4, 10, 100, 1000, 10000, 100000}) {
    lines.push_back(measure(
        "chain in space", [n] { return chain(n, true); }, false));
    lines.back().articulated = articulated(n, true);
  }
  for (const int n : {1, 10, 100, 1000, 100000}) {
    lines.push_back(measure(
        "planar chain", [n] { return chain(n, false); }, true));
    lines.back().articulated = articulated(n, false);
  }
  for (const int n : {2, 40, 50, 500, kLargest})
    lines.push_back(measure(
        "ladder", [n] { return ladder(n); }, true, large || n < kLargest));
  for (const int n : {10, 50})
    lines.push_back(measure(
        "star", [n] { return star(n); }, false));

  const std::string file = samples::output("evaluation.csv");
  std::ofstream csv(file);
  csv << "mechanism,bodies,schur [ns/body],corrections,sparse [ns/body],joint [ns/body],planar [ns/body],planar joint "
         "[ns/body],articulated body [ns/body]\n";
  fmt::print("{:16} {:>7} {:>9} {:>5} {:>9} {:>9} {:>9} {:>12} {:>12}   ns a body and evaluation\n", "", "bodies",
             "schur", "corr", "sparse", "joint", "planar", "planar joint", "articulated");
  const auto shown = [](double x) { return x > 0 ? fmt::format("{:.0f}", x) : std::string("-"); };
  for (const Line& l : lines) {
    csv << fmt::format("{},{},{:.1f},{},{:.1f},{:.1f},{:.1f},{:.1f},{:.1f}\n", l.mechanism, l.bodies, l.schur,
                       l.corrections, l.sparse, l.joint, l.planar, l.planar_joint, l.articulated);
    fmt::print("{:16} {:>7} {:>9} {:>5} {:>9} {:>9} {:>9} {:>12} {:>12}\n", l.mechanism, l.bodies, shown(l.schur),
               l.corrections, shown(l.sparse), shown(l.joint), shown(l.planar), shown(l.planar_joint),
               shown(l.articulated));
  }
  const auto tenth = [] { return ladder(kLargest / 10); };
  fmt::print("ladder of {} bodies: {:.0f} B a body in space, {:.0f} in the plane, along joints {:.0f} and {:.0f}\n",
             kLargest / 5 + 1, memory(tenth, false, Formulation::omega), memory(tenth, true, Formulation::omega),
             memory(tenth, false, Formulation::joint), memory(tenth, true, Formulation::joint));
  int freedoms = 0;
  const double seconds = load(ladder(kLargest), freedoms);
  fmt::print("ladder of {} bodies, read from its scene, and its freedoms counted ({}): {:.1f} s\n", 2 * kLargest + 1,
             freedoms, seconds);
  fmt::print("{}\n", file);
}
