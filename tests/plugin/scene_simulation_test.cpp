// SPDX-License-Identifier: BSD-3-Clause
// Simulations of scenes: a host runs a scene as the program does.
#include <lockstep/simulation.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <type_traits>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include <lockstep/forces.h>
#include <lockstep/joints.h>
#include <lockstep/recorder.h>
#include <lockstep/scene.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"
#include "tests/support/scene_folder.h"

namespace scene_simulation_test {

using namespace lockstep;
using lockstep::testing::builtin, lockstep::testing::call, lockstep::testing::Called, lockstep::testing::check_words,
    lockstep::testing::kRunnerFolder, lockstep::testing::message_of, lockstep::testing::scene_file;

// The obvious way, which would lose a scene's start, events and settings.
static_assert(!std::is_constructible_v<Simulation, decltype((std::declval<Mechanism&>().system))>);
static_assert(std::is_constructible_v<Simulation, Mechanism>);
static_assert(std::is_nothrow_move_constructible_v<Simulation> && std::is_nothrow_move_assignable_v<Simulation>);

namespace {

using Set = std::vector<std::pair<std::string, std::string>>;

const std::string kParallelogram = std::string(paths::kSource) + "/tests/verification/scenes/parallelogram.json";

std::string text_of(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string csv_of(const Table& table) {
  std::ostringstream out;
  write_csv(out, table);
  return out.str();
}

// The rows that the program writes.
std::string program_rows(const std::string& scene, const Set& set) {
  std::string words = "run '" + scene + "' --no-picture --record host.csv";
  for (const auto& [name, value] : set) words += " --set '" + name + "=" + value + "'";
  const Called r = call(words);
  INFO(r.text);
  CHECK(r.exit == 0);
  return text_of(kRunnerFolder + "/host.csv");
}

// A rod on a hinge that starts at 0.3 rad and 2 rad/s, catches a second one at 0.5 rad, and stops at a time.
const std::string kCatch = R"~("gravity": [0, -9.81, 0],
  "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}},
             {"name": "load", "mass": 0.5, "inertia": [0.01, 0.01, 0.01], "position": [1, 0, 0]}],
  "links": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0],
             "start": {"position": {"rz": 0.3}, "velocity": {"rz": 2}}},
            {"name": "grab", "type": "fixed", "p": "load", "s": "rod", "at": [1, 0, 0]}],
  "events": [{"name": "drop", "when": {"channel": "A.rz", "crosses": 0.4, "direction": "rising"}, "deactivate": ["grab"]},
             {"name": "end", "at": 0.45, "stop": true}],
  "run": {"integrator": "dop853", "tolerance": 1e-9, "until": 1, "output": 0.01, "at_jumps": true,
          "record": ["A.rz", {"y": "load.y"}, "A.force_on_p_world_y", "energy.total"]})~";

}  // namespace

TEST_CASE("a host runs a scene to the same table as the program", "[simulation][scene]") {
  struct Case {
    const char* scene;
    Set set;
  };
  for (const Case& c : {Case{"four_bar", {{"crank", "0.12 m"}}}, Case{"bouncing_pendulum", {}},
                        Case{"slider_crank", {}}, Case{"free_body", {}}, Case{"gear_train", {}}}) {
    CAPTURE(c.scene);
    std::string file = paths::kScenes;
    file.append("/").append(c.scene).append(".json");
    Simulation run(read_mechanism(file, builtin(), c.set));
    run.run();
    CHECK(run.table().n_rows() > 10);
    CHECK(csv_of(run.table()) == program_rows(file, c.set));
    CHECK(run.verdict().right);
  }
}

TEST_CASE("a host's run of a scene has its start, events and outputs at jumps", "[simulation][scene]") {
  const std::string file = scene_file("catch", kCatch);
  Simulation run(read_mechanism(file, builtin()));
  const SimulationReport& report = run.run();
  CHECK(report.stopped_by == "end");
  CHECK(run.state().t == 0.45);
  const Table& t = run.table();
  CHECK(std::abs(t.first("A.rz") - 0.3) < 1e-9);
  CHECK(csv_of(t) == program_rows(file, {}));
  CHECK(run.verdict().audit.energy == Audit::Energy::conserved);
}

TEST_CASE("a run of a scene may be moved, and changed before it begins", "[simulation][scene]") {
  const std::string file = scene_file("catch", kCatch);
  Simulation whole(read_mechanism(file, builtin()));
  whole.settings().tolerance.relative = 1e-6;
  whole.system().add_particle("dust", 0.1, {5, 0, 0});
  whole.record({"dust.y"});
  Simulation moved(std::move(whole));
  moved.run_until(0.2);
  Simulation further = std::move(moved);
  further.run();
  const double t = further.state().t;
  CHECK(std::abs(further.table().last("dust.y") + 0.5 * 9.81 * t * t) < 1e-6);  // it falls
  Simulation other(read_mechanism(file, builtin()));
  other.run();
  CHECK(other.loop().report().steps > further.loop().report().steps);  // 1e-9 for 1e-6
  check_words(message_of<ModelError>([&] { further.settings(); }), {"settings()", "before"});
  further = std::move(other);  // the old run goes
  CHECK(further.state().t == 0.45);
}

TEST_CASE("the verdict of a host's run is that of the program", "[simulation][scene]") {
  const std::string file = kParallelogram;
  const auto verdict = [&](const Set& set) {
    Simulation run(read_mechanism(file, builtin(), set));
    run.run();
    return run.verdict();
  };
  const auto program = [&](const Set& set, const std::string& options = "") {
    std::string words = "run '" + file + "' --no-picture --record host.csv " + options;
    for (const auto& [name, value] : set) words += " --set '" + name + "=" + value + "'";
    return call(words);
  };
  const Set lossy = {{"run.integrator", "semi_implicit_euler"}, {"run.step", "0.02 s"}, {"run.until", "3 s"}};
  CHECK(!verdict(lossy).right);
  CHECK(program(lossy).exit == 9);
  CHECK(program(lossy, "--strict").exit == 9);  // doubts do not hide it
  const Set fine = {{"run.tolerance", "1e-15"}, {"run.until", "3.3 s"}};  // which no rounding reaches
  const RunVerdict doubtful = verdict(fine);
  CHECK(doubtful.right);
  REQUIRE(!doubtful.findings.empty());
  const Called r = program(fine, "--strict");
  CHECK(r.exit == 11);
  for (const Finding& f : doubtful.findings) check_words(r.text, {f.text()});
}

TEST_CASE("columns that a host adds are treated as those of the scene", "[simulation][scene]") {
  const std::string far = scene_file("far", R"~("gravity": [0, -9.81, 0],
    "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0],
               "start": {"position": {"rz": 4}}}],
    "run": {"until": 0.1, "output": 0.1, "record": ["A.rz"]})~");
  Simulation turned(read_mechanism(far, builtin()));
  turned.record({{"mine", "A.rz"}});
  turned.run();
  CHECK(std::abs(turned.table().first("mine") - 4) < 1e-9);
  CHECK(turned.table()["mine"] == turned.table()["A.rz"]);

  // The start lies in a singular position.
  const auto doubts_of = [](const std::string& column) {
    Mechanism m = read_mechanism(
        paths::kSource + std::string("/tests/verification/defects/start_in_change_point.json"), builtin());
    m.run.record.clear(), m.run.draw.clear();
    Simulation run(std::move(m));
    run.record({column});
    run.run();
    return texts_of(run.verdict().findings);
  };
  CHECK(doubts_of("left.angle_z").empty());
  check_words(doubts_of("A.force_on_p_link_x").at(0), {"reactions", "uncertain"});
}

TEST_CASE("a host's force is in the balance that a scene records", "[simulation][scene]") {
  const std::string file = scene_file("dust", R"~("gravity": [0, 0, 0],
    "bodies": [{"name": "dust", "mass": 2, "inertia": [1, 1, 1], "velocity": [3, 0, 0]}],
    "run": {"tolerance": 1e-10, "until": 1, "output": 0.1, "record": ["energy.balance", "energy.total"]})~");
  Simulation run(read_mechanism(file, builtin()));
  System& system = run.system();
  Marker& at = system.add_marker("at", system.body("dust"));
  Marker& still = system.add_marker("still", system.ground());
  system.add<Bushing>("air", at, still, Bushing::Options{.damping = {4, 0, 0}});
  run.run();
  CHECK(std::abs(run.table().last("energy.total") - 9 * std::exp(-4.0)) < 1e-7);  // v = 3 exp(-c t/m)
  CHECK(std::abs(run.table().last("energy.balance")) < 1e-7);
  CHECK(run.verdict().right);
}

TEST_CASE("outputs at jumps reach a host once, by its function", "[simulation][scene]") {
  std::string scene = kCatch;
  scene.replace(scene.find("\"at\": 0.45"), 10, "\"at\": 0.3 ");  // an output time
  const std::string file = scene_file("jumps", scene);
  const auto times = [&](bool keep) {
    std::vector<double> all;
    Simulation run(read_mechanism(file, builtin()));
    run.on_row([&](std::span<const double> row) { all.push_back(row[0]); }, keep);
    run.run();
    if (keep) CHECK(all == run.table()["t"]);
    return all;
  };
  const std::vector<double> kept = times(true);
  CHECK(std::ranges::count(kept, 0.3) >= 1);
  CHECK(times(false) == kept);
}

TEST_CASE("a solver that a host names is used", "[simulation][scene]") {
  Simulation run(read_mechanism(paths::kScenes + std::string("/four_bar.json"), builtin()));
  run.settings().solver = {"dense"};
  run.run_until(0.01);
  CHECK(run.dynamics().options().formulation == Formulation::omega);
  CHECK(run.dynamics().solver().name() == std::string("dense"));
}

TEST_CASE("a method that a host registers may have a law as a key", "[simulation][scene]") {
  Registry registry = builtin();
  double seen = 0;
  registry.integrators.add({"lawful", "order 4", {{"pace", Form::law, Unit::any, kRequired, "a law"}}},
                           [&](const Params& p) {
                             seen = p.law("pace")->at(2).y;
                             RunSettings rk4;
                             rk4.integrator = {"rk4"}, rk4.step = 0.1;
                             return make_integrator(rk4, builtin());
                           });
  Simulation run(read_mechanism(scene_file("lawful", R"("run": {"until": 0.1, "step": 0.1,
        "integrator": {"type": "lawful", "pace": {"type": "polynomial", "coefficients": [1, 3]}}})"),
                                registry));
  run.run();
  CHECK(seen == 7);
}

TEST_CASE("errors in a host's scene have their place", "[simulation][scene]") {
  const auto refused = [](const std::string& members, const Set& set = {}) {
    return message_of<Error>([&] {
      Simulation run(read_mechanism(scene_file("wrong", members), builtin(), set));
      run.run();
    });
  };
  check_words(refused(kCatch, {{"run.utnil", "3"}}), {"utnil"});
  std::string unknown = kCatch;
  unknown.replace(unknown.find("load.y"), 6, "load.w");
  check_words(refused(unknown), {"wrong.json:", "load.w"});
  unknown.replace(unknown.find("A.rz\", \"crosses"), 4, "A.rw");  // of an event: both are reported at once
  check_words(refused(unknown), {"load.w", "A.rw", "event 'drop'"});
  std::string endless = kCatch;
  endless.replace(endless.find("\"until\": 1, "), 12, "");
  check_words(refused(endless), {"run()", "until"});
  check_words(refused(R"("requires": ["no_such_plugin"])"), {"no_such_plugin"});
}

TEST_CASE("a start that cannot be assembled leaves a host's run as it was", "[simulation][scene]") {
  System system({.gravity = {0, -9.81, 0}});
  Body& rod = system.add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
  Body& other = system.add_body("other", shapes::rod(1.0, {5, 0, 0}, {6, 0, 0}));
  Marker& end = system.add_marker("end", rod, {{1, 0, 0}, {}});
  Marker& far = system.add_marker("far", other, {{-0.5, 0, 0}, {}});
  system.add<Revolute>("A", rod, system.ground(), pose_at({0, 0, 0}));
  system.add<Revolute>("B", other, system.ground(), pose_at({5, 0, 0}));
  system.add<Revolute>("C", end, far);  // 4 m apart, and neither arm reaches
  Simulation run(system);
  for (int i = 0; i < 2; ++i)
    CHECK_THROWS_AS(run.run_until(1), AssemblyError);  // again, not a run from the poses that were given
}

}  // namespace scene_simulation_test
