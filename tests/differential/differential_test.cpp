// SPDX-License-Identifier: BSD-3-Clause
// Random mechanisms, computed in all ways: every two ways agree, or one says by name why it does not go. A disagreement
// prints its seed and the smallest scene that shows it. LOCKSTEP_SEEDS="FROM:TO" takes other seeds than the default.
#include <algorithm>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <map>
#include <thread>

#include "tests/differential/design.h"
#include "tests/differential/seeds.h"
#include "tests/differential/shrink.h"
#include "tests/differential/trial.h"
#include "tests/support/catch.h"

namespace differential_test {

using namespace lockstep;
using namespace lockstep::differential;

namespace {

// m and rad. The motions last 0.4 s, of bodies a metre or less apart; steps are made to 1e-10.
constexpr double kAgree = 2e-7;

Seeds seeds() { return seeds_up_to(25); }

// A motion and how far it may be off: what a looser tolerance changes, times a thousand, is what a mechanism makes of
// small errors.
struct Reference {
  Trial trial;
  double allowed = kAgree;
};
Reference reference_of(const std::string& scene) {
  Reference r{compute(scene, {})};
  if (!r.trial.ok()) return r;
  const Trial loose = compute(scene, {.tolerance = 1e-9});
  r.allowed = kAgree + (loose.ok() ? 1e3 * difference(r.trial.history, loose.history) : 0);
  return r;
}

// A way to compute a design that must give the motion of the reference.
struct Variant {
  std::string name;
  std::function<bool(const Design&)> applies;
  /// Writes its history, or why it refuses, and adds what its own error allows.
  std::function<Trial(const Design&, double& allowed)> run;
};

bool always(const Design&) { return true; }

Variant method(const Way& way, const std::string& planar = "off") {
  return {way.words() + ", planar " + planar, planar == "off" ? always : [](const Design& d) { return d.planar; },
          [=](const Design& d, double&) { return compute(scene_text(d, {}, planar), way); }};
}

// With fixed steps: the difference that half the step makes, three times, bounds the error of the finer run of any order.
Variant fixed(const std::string& integrator, const std::string& formulation, double step) {
  return {integrator + ", " + formulation + ", fixed steps", [](const Design& d) { return !d.has_stop(); },
          [=](const Design& d, double& allowed) {
            Way way{.integrator = integrator, .solver = "schur", .formulation = formulation, .step = step};
            const Trial coarse = compute(scene_text(d), way);
            way.step = 0.5 * step;
            Trial fine = compute(scene_text(d), way);
            if (!coarse.ok()) return coarse;  // nothing to judge the finer one by
            if (fine.ok()) allowed += 3 * difference(coarse.history, fine.history);
            return fine;
          }};
}

Variant view(const std::string& name, const View& v) {
  return {name, always, [=](const Design& d, double&) {
            Trial t = compute(scene_text(d, v), {.solver = "schur", .tolerance = 1e-10, .unit = v.length});
            t.history = seen_back(std::move(t.history), v.frame, v.length);
            return t;
          }};
}

std::vector<Variant> variants() {
  std::vector<Variant> all;
  for (const char* solver : {"schur", "block", "sparse"}) {
    all.push_back(method({.solver = solver, .tolerance = 1e-10}));
    all.push_back(method({.integrator = "dopri5", .solver = solver, .tolerance = 1e-9}));
  }
  all.push_back(method({.solver = "sparse", .formulation = "quaternion", .tolerance = 1e-10}));
  all.push_back(method({.solver = "schur", .formulation = "joint", .tolerance = 1e-10}));
  all.push_back(method({.integrator = "dopri5", .solver = "schur", .formulation = "auto", .tolerance = 1e-9}));
  all.push_back(method({.integrator = "radau5", .solver = "schur", .tolerance = 1e-8}));
  all.push_back(method({.solver = "schur", .tolerance = 1e-10, .baumgarte = true}));
  for (const char* planar : {"z", "auto", ""})
    all.push_back(
        method({.integrator = "dopri5", .solver = "schur", .formulation = "auto", .tolerance = 1e-9}, planar));
  all.push_back(method({.solver = "block", .tolerance = 1e-10}, "z"));
  for (const char* formulation : {"omega", "auto"}) all.push_back(fixed("rk4", formulation, 4e-4));
  for (const char* integrator : {"generalized_alpha", "rattle2", "rattle4", "semi_implicit_euler"})
    all.push_back(fixed(integrator, "omega", 1e-3));
  const Pose turned{{3, -2, 0.5}, exponential(Vec3(0.4, -1.1, 0.8))};
  all.push_back(view("a turned world", {.frame = turned}));
  all.push_back(view("millimetres", {.frame = {}, .length = 1000}));
  all.push_back(view("another order", {.frame = {}, .order = 7}));
  all.push_back(view("all three", {.frame = turned, .length = 0.01, .order = 11}));
  return all;
}

// A refusal is one of our errors, and names a thing: 'l2', the formulation, the integrator.
bool is_named(const Trial& t) {
  if (t.kind == "foreign") return false;
  for (const char* name :
       {"'", "\"", "(formulation", "dop853:", "dopri5:", "radau5:", "rk4:", "rattle", "generalized_alpha:"})
    if (t.refusal.find(name) != std::string::npos) return true;
  return false;
}

double disagreement(const Variant& v, const Design& d) {
  const Reference ref = reference_of(scene_text(d));
  if (!ref.trial.ok()) return 0;
  double allowed = ref.allowed;
  const Trial t = v.run(d, allowed);
  return t.ok() ? difference(ref.trial.history, t.history) / allowed : 0;
}

struct Counts {
  long compared = 0, refused = 0;
  std::map<std::string, long> reasons;
};

// The sentence without numbers and names, to count its like.
std::string reason(const std::string& sentence) {
  std::string text;
  for (const char c : sentence.substr(0, 110))
    if (!std::isdigit(static_cast<unsigned char>(c))) text += c;
  return text;
}

void compare(unsigned seed, const Design& d, const Variant& v, const Reference& ref, Counts& counts) {
  double allowed = ref.allowed;
  if (std::getenv("LOCKSTEP_SEEDS")) std::cout << "seed " << seed << ", " << v.name << std::endl;
  const Trial t = v.run(d, allowed);
  if (!t.ok()) {
    ++counts.refused, ++counts.reasons[v.name + ": " + reason(t.refusal)];
    INFO("seed " << seed << ", " << v.name << ": " << t.refusal);
    CHECK(is_named(t));
    return;
  }
  ++counts.compared;
  const double apart = difference(ref.trial.history, t.history);
  if (apart <= allowed) return;
  const Design small = shrunk(d, [&](const Design& next) { return disagreement(v, next) > 1; });
  FAIL_CHECK("seed " << seed << ", " << v.name << ": off by " << apart << ", allowed are " << allowed
                     << "\nthe smallest scene that shows it:\n"
                     << scene_text(small) << '\n');
}

}  // namespace

TEST_CASE("random mechanisms move alike in all ways to compute them", "[differential]") {
  const std::vector<Variant> all = variants();
  const Seeds range = seeds();
  Counts counts;
  long moved = 0, mechanisms = 0;
  for (unsigned seed = range.from; seed < range.to; ++seed) {
    const Design d = random_design(seed);
    if (range.to == range.from + 1) std::cout << scene_text(d) << '\n';
    const Reference ref = reference_of(scene_text(d));
    ++mechanisms;
    if (!ref.trial.ok()) {
      INFO("seed " << seed << ": " << ref.trial.refusal);
      CHECK(is_named(ref.trial));
      ++counts.reasons["reference: " + reason(ref.trial.refusal)];
      continue;
    }
    ++moved;
    for (const Variant& v : all)
      if (v.applies(d)) compare(seed, d, v, ref, counts);
  }
  if (std::getenv("LOCKSTEP_SEEDS")) {
    std::cout << mechanisms << " mechanisms, " << moved << " moved; " << counts.compared << " comparisons, "
              << counts.refused << " refusals\n";
    for (const auto& [words, n] : counts.reasons) std::cout << n << "  " << words << '\n';
  }
  CHECK(moved * 10 >= mechanisms * 9);
  CHECK(counts.compared > 5 * counts.refused);
}

TEST_CASE("random mechanisms without losses return when time is reversed", "[differential]") {
  const Seeds range = seeds();
  int returned = 0;
  for (unsigned seed = range.from; seed < range.to; ++seed) {
    const Design d = random_design(seed);
    if (d.has_loss() || d.has_drive()) continue;
    const Reference ref = reference_of(scene_text(d));
    if (!ref.trial.ok()) continue;
    for (const char* formulation : {"omega", "auto"}) {
      Trial back = compute(scene_text(d), {.solver = "schur", .formulation = formulation, .and_back = true});
      INFO("seed " << seed << ", " << formulation << ": " << back.refusal);
      REQUIRE(back.ok());
      differential::Snapshot& end = back.history.front();
      end.t = 0;
      for (Twist& v : end.twists) v = {Vec3(-v.v), Vec3(-v.w)};
      CHECK(difference({ref.trial.history.front()}, back.history) < ref.allowed);
      ++returned;
    }
  }
  CHECK(returned > static_cast<int>(range.to - range.from) / 4);
}

TEST_CASE("a repeated run is the same to the last bit, on separate threads as well", "[differential]") {
  const auto same = [](const std::vector<lockstep::differential::Snapshot>& a,
                       const std::vector<lockstep::differential::Snapshot>& b) {
    if (a.size() != b.size()) return false;
    for (std::size_t k = 0; k < a.size(); ++k)
      for (std::size_t i = 0; i < a[k].poses.size(); ++i)
        if (a[k].poses[i].x != b[k].poses[i].x || a[k].poses[i].q.coefficients() != b[k].poses[i].q.coefficients() ||
            a[k].twists[i].v != b[k].twists[i].v || a[k].twists[i].w != b[k].twists[i].w)
          return false;
    return true;
  };
  std::vector<std::string> scenes;
  for (unsigned seed = 1; seed <= 8; ++seed) scenes.push_back(scene_text(random_design(seed)));
  for (const char* integrator : {"dopri5", "dop853"})
    for (const char* formulation : {"omega", "auto"}) {
      const Way way{.integrator = integrator, .solver = "schur", .formulation = formulation, .tolerance = 1e-6};
      std::vector<Trial> alone, together(scenes.size());
      for (const std::string& scene : scenes) alone.push_back(compute(scene, way));
      std::vector<std::thread> threads;
      for (std::size_t k = 0; k < scenes.size(); ++k)
        threads.emplace_back([&, k] { together[k] = compute(scenes[k], way); });
      for (std::thread& thread : threads) thread.join();
      for (std::size_t k = 0; k < scenes.size(); ++k) {
        INFO(way.words() << "\n" << scenes[k]);
        CHECK(alone[k].refusal == together[k].refusal);
        CHECK(same(alone[k].history, together[k].history));
        CHECK(same(alone[k].history, compute(scenes[k], way).history));
      }
    }
}

TEST_CASE("a disagreement is shrunk to the things that show it", "[differential]") {
  Design d;
  for (unsigned seed = 1; d.bodies.size() < 4 || d.forces.empty(); ++seed) d = random_design(seed);
  d.bodies[2].mass = 77;
  const auto heavy = [](const Design& n) {
    return std::any_of(n.bodies.begin(), n.bodies.end(), [](const DesignBody& b) { return b.mass == 77; });
  };
  const Design small = shrunk(d, heavy);
  CHECK(small.bodies.size() == 1);
  CHECK(small.links.empty());
  CHECK(small.forces.empty());
  CHECK(small.gravity.isZero(0));
  CHECK(heavy(small));
}

}  // namespace differential_test
