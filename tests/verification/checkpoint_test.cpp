// SPDX-License-Identifier: BSD-3-Clause
// Runs that are saved between two steps and gone on with in another object, against those that are not.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/log.h>
#include <lockstep/sweep.h>
#include "framework/tools/rank/singular_watch.h"
#include "framework/tools/scene_run/scene_run.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/run_scene.h"

namespace checkpoint_test {

using namespace lockstep;

namespace {

const Registry& registry() {
  static const Registry all = builtin_registry();
  return all;
}

struct Way {
  std::string integrator = "dopri5", solver = "schur", formulation = "auto";
  Stabilization::Kind stabilization = Stabilization::Kind::project;
  std::string words() const { return integrator + " " + solver + " " + formulation; }
};

constexpr double kParts = 60;  // fixed steps of a run

/// A rod on a hinge with a stop, and a ball on a spring that is caught, let go by an event at an instant, and counted
/// by one that comes again and again.
constexpr const char* kEvents = R"({
  "lockstep": 1,
  "gravity": [0, -9.81, 0],
  "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0], "axial_inertia": 0.01}},
             {"name": "ball", "mass": 1, "inertia": [0.1, 0.1, 0.1], "position": [2, 0, 0]}],
  "markers": [{"name": "end", "body": "rod", "world_at": [0, 0, 0]},
              {"name": "pivot", "body": "ground", "orientation": {"axis": "z", "angle": "-90 deg"}},
              {"name": "eye", "body": "ball", "world_at": [2, 0, 0]},
              {"name": "hook", "body": "ground", "world_at": [2, 1, 0]}],
  "links": [{"name": "hinge", "type": "revolute", "p": "end", "s": "pivot",
             "stops": [{"axis": "rz", "low": 0, "restitution": 0.5}]},
            {"name": "grip", "type": "spherical", "p": "eye", "s": "hook", "active": false}],
  "forces": [{"name": "spring", "type": "spring_damper", "p": "eye", "s": "hook", "stiffness": 40, "damping": 0.3,
              "free_length": 0.5}],
  "events": [{"name": "low", "when": {"channel": "ball.y", "crosses": -0.1, "direction": "falling"}, "once": false, "deactivate": ["grip"]},
             {"name": "off", "at": 1.3, "deactivate": ["spring"]},
             {"name": "on", "at": 1.5, "activate": ["spring"]}],
  "run": {"tolerance": 1e-8, "until": 3, "output": 0.02,
          "record": ["rod.angle_z", "ball.y", "energy.total", "hinge.force_on_p_world_y"]}
})";

Scene scene_of(const std::string& file, const Way& way, double share) {
  Scene scene = file == "events" ? scene_from_text(kEvents, "events.json") : read_scene(file);
  RunSettings& run = scene.run;
  run.integrator = read_method_spec(way.integrator, types_of(registry().integrators));
  run.solver = read_method_spec(way.solver, types_of(registry().solvers));
  run.formulation = formulation_from(way.formulation), run.stabilization.kind = way.stabilization;
  run.until *= share;
  run.step = 0;
  RunSettings with_step = run;
  with_step.step = run.until / kParts;
  if (!make_integrator(with_step, registry())->info().adaptive) run = with_step;
  run.max_steps = 2000;
  return scene;
}

/// One run of a scene with everything that watches it.
struct Run {
  explicit Run(const Scene& scene) : m(build_mechanism(scene, registry())) {
    record_places(m);
    m.run.record.push_back({"energy.balance", "balance of a test", {}});
    m.run.record.push_back({"rejected", "tries of a test", {}});
    recorder = make_recorder(m);
    std::vector<Event> events = make_events(m, *recorder);
    audit = std::make_unique<EnergyAudit>(system_of(m), m.run.limits);
    dynamics.emplace(system_of(m), make_solver(m.run, registry()), DynamicsOptions{m.run.formulation, m.run.stabilization});
    loop.emplace(*dynamics, make_integrator(m.run, registry()), loop_options(m.run));
    loop->add_observer(*recorder), loop->add_observer(*audit);
    for (Event& event : events) loop->add_event(std::move(event));
  }
  void begin() { loop->set_state(assembled_start(*dynamics, m)); }
  void go() { loop->run_until(m.run.until); }

  Mechanism m;
  std::unique_ptr<Recorder> recorder;
  std::unique_ptr<EnergyAudit> audit;
  std::optional<Dynamics> dynamics;
  std::optional<StepLoop> loop;
};

bool same_bits(const double* a, const double* b, std::size_t n) { return n == 0 || std::memcmp(a, b, 8 * n) == 0; }

/// The first thing in which two runs differ; "" where they are equal to the last bit.
std::string difference(Run& a, Run& b) {
  const Table &ta = a.recorder->table(), &tb = b.recorder->table();
  if (ta.n_rows() != tb.n_rows()) return "rows: " + std::to_string(ta.n_rows()) + ", " + std::to_string(tb.n_rows());
  for (std::size_t k = 0; k < ta.n_columns(); ++k)
    for (std::size_t i = 0; i < ta.n_rows(); ++i)
      if (!same_bits(&ta.columns()[k].values[i], &tb.columns()[k].values[i], 1))
        return "column " + ta.columns()[k].name + ", row " + std::to_string(i) + " of " + std::to_string(ta.n_rows());
  const State &sa = a.loop->state(), &sb = b.loop->state();
  const auto differ = [](const VecX& x, const VecX& y) {
    return x.size() != y.size() || !same_bits(x.data(), y.data(), static_cast<std::size_t>(x.size()));
  };
  if (sa.t != sb.t || differ(sa.q, sb.q) || differ(sa.v, sb.v) || differ(sa.s, sb.s) || differ(sa.z, sb.z))
    return "state";
  if (sa.modes != sb.modes || sa.watched != sb.watched) return "links in force";
  const SimulationReport &ra = a.loop->report(), &rb = b.loop->report();
  if (ra.steps != rb.steps || ra.rejected != rb.rejected || ra.impacts != rb.impacts ||
      ra.manifold_steps != rb.manifold_steps)
    return "steps";
  if (ra.largest_violation != rb.largest_violation || ra.stiff_since != rb.stiff_since ||
      ra.largest_turn != rb.largest_turn || ra.turned_most != rb.turned_most)
    return "largest numbers of the report";
  if (ra.stopped != rb.stopped || ra.stopped_by != rb.stopped_by || texts_of(ra.findings) != texts_of(rb.findings))
    return "words of the report";
  const Audit xa = a.audit->result(), xb = b.audit->result();
  if (xa.imbalance != xb.imbalance || xa.scale != xb.scale || xa.violation != xb.violation || xa.end != xb.end ||
      xa.drives != xb.drives || xa.dissipated != xb.dissipated || xa.instants.size() != xb.instants.size())
    return "audit";
  const WorkCount &wa = a.loop->dynamics().work(), &wb = b.loop->dynamics().work();
  if (wa.evaluations != wb.evaluations || wa.factors != wb.factors || wa.projections != wb.projections)
    return "work: evaluations " + std::to_string(wa.evaluations) + ", " + std::to_string(wb.evaluations) +
           "; factors " + std::to_string(wa.factors) + ", " + std::to_string(wb.factors) + "; projections " +
           std::to_string(wa.projections) + ", " + std::to_string(wb.projections);
  return {};
}

/// Runs a scene once through, saves a second run at `n` steps drawn by `draw`, and goes on from each. Returns the first
/// difference, "" where there is none; or "refused" where the scene does not go with this way to run it.
std::string try_scene(const std::string& file, const Way& way, double share, int n, std::mt19937& draw) {
  std::optional<Scene> scene;
  std::optional<Run> whole, saving;
  try {
    scene = scene_of(file, way, share);
    whole.emplace(*scene);
    whole->begin(), whole->go();
  } catch (const Error&) {
    return "refused";
  }
  const long n_steps = whole->loop->report().steps;
  if (n_steps < 2) return "refused";
  std::vector<long> at;
  for (int k = 0; k < n; ++k) at.push_back(1 + static_cast<long>(draw() % static_cast<unsigned long>(n_steps - 1)));
  std::vector<Snapshot> saved(at.size());
  saving.emplace(*scene);
  saving->begin();
  saving->loop->between_steps = [&] {
    for (std::size_t k = 0; k < at.size(); ++k)
      if (saving->loop->report().steps == at[k] && saved[k].numbers().empty()) saving->loop->save(saved[k]);
  };
  saving->go();
  if (const std::string d = difference(*whole, *saving); !d.empty()) return "saving changed the run: " + d;
  for (std::size_t k = 0; k < at.size(); ++k) {
    const std::string when = "after step " + std::to_string(at[k]) + " of " + std::to_string(n_steps) + ": ";
    if (saved[k].numbers().empty()) return when + "not saved";
    Run on(*scene);
    on.loop->load(saved[k]);
    on.go();
    if (const std::string d = difference(*whole, on); !d.empty()) return when + d;
  }
  return {};
}

std::vector<std::string> sample_files() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(paths::kScenes))
    if (entry.path().extension() == ".json") files.push_back(entry.path().string());
  std::ranges::sort(files);
  return files;
}

void check_ways(const std::vector<std::string>& files, const std::vector<Way>& ways, double share, int n,
                long at_least) {
  std::mt19937 draw(20261);
  const auto before = logger();
  set_logger(nullptr);
  long equal = 0;
  for (const std::string& file : files)
    for (const Way& way : ways) {
      const std::string found = try_scene(file, way, share, n, draw);
      INFO(std::filesystem::path(file).filename().string() << ", " << way.words());
      if (found == "refused") continue;
      CHECK(found.empty());
      ++equal;
    }
  set_logger(before);
  CHECK(equal >= at_least);
}

}  // namespace

TEST_CASE("a run resumed after any step of a sample equals the uninterrupted one, with every integrator") {
  std::vector<Way> ways;
  for (const char* integrator :
       {"dopri5", "dop853", "dop853:stages=manifold", "dopri5:fixed=true", "rk4", "semi_implicit_euler", "radau5",
        "generalized_alpha", "generalized_alpha:adaptive=true", "rattle2", "rattle4"})
    ways.push_back({.integrator = integrator});
  check_ways(sample_files(), ways, 0.04, 1, 300);
}

TEST_CASE("a resumed run equals the uninterrupted one, with every solver, formulation and stabilisation") {
  std::vector<Way> ways;
  for (const char* solver : {"dense", "sparse", "block"})
    for (const char* formulation : {"omega", "quaternion"})
      ways.push_back({.integrator = "dop853", .solver = solver, .formulation = formulation});
  ways.push_back({.formulation = "omega"});
  ways.push_back({.formulation = "joint"});
  ways.push_back({.formulation = "omega", .stabilization = Stabilization::Kind::baumgarte});
  ways.push_back({.integrator = "radau5", .formulation = "omega", .stabilization = Stabilization::Kind::none});
  std::vector<std::string> files = sample_files();
  std::erase_if(files, [](const std::string& file) {  // large ones, which dense matrices take long for
    return file.find("chain") != std::string::npos || file.find("_40") != std::string::npos;
  });
  check_ways(files, ways, 0.02, 1, 150);
}

TEST_CASE("a run resumed across events and impacts equals the uninterrupted one") {
  std::vector<Way> ways;
  for (const char* integrator : {"dopri5", "dop853", "rk4", "radau5", "generalized_alpha"})
    ways.push_back({.integrator = integrator});
  check_ways({scene_path("bouncing_pendulum"), "events"}, ways, 1, 6, 8);
  const Scene scene = scene_of("events", {}, 1);
  Run run(scene);
  run.begin(), run.go();
  CHECK(run.loop->report().impacts >= 2);
  CHECK(run.audit->result().instants.size() >= 2);
}

// Rows of four hinges on parallel axes are redundant in space, and all that the watch knows of them is its solver's.
TEST_CASE("a resumed monitor of singular configurations keeps the state of its solver") {
  Scene scene = read_scene(std::string(paths::kSource) + "/samples/scenes/overconstrained/four_bar.json");
  scene.run.integrator = {"rk4"}, scene.run.until = 1, scene.run.step = 0.005, scene.run.output = 0.1;
  const auto learned = [](const SingularWatch& watch) {
    Snapshot all;
    watch.save(all);
    return all.numbers();
  };
  Run whole(scene);
  SingularWatch watch(system_of(whole.m));
  whole.loop->add_observer(watch);
  std::vector<Snapshot> saved;
  whole.loop->between_steps = [&] {
    if (whole.loop->report().steps % 40 == 0) whole.loop->save(saved.emplace_back());
  };
  whole.begin(), whole.go();
  REQUIRE(saved.size() >= 4);
  const std::vector<double> expected = learned(watch);
  for (const Snapshot& at : saved) {
    Run on(scene);
    SingularWatch watch_on(system_of(on.m));
    on.loop->add_observer(watch_on);
    on.loop->load(at);
    on.go();
    const std::vector<double> found = learned(watch_on);
    REQUIRE(found.size() == expected.size());
    CHECK(same_bits(found.data(), expected.data(), found.size()));
  }
}

}  // namespace checkpoint_test
