// Simulations of scenes: a host runs a scene as the program does.
#include <lockstep/simulation.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>
#include <type_traits>

#include <lockstep/error.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"
#include "tests/support/scene_folder.h"

namespace scene_simulation_test {

using namespace lockstep;
using lockstep::testing::builtin, lockstep::testing::call, lockstep::testing::Called, lockstep::testing::check_words,
    lockstep::testing::contains, lockstep::testing::kRunnerFolder, lockstep::testing::message_of,
    lockstep::testing::scene_file;

// The obvious way, which would lose a scene's start, events and settings.
static_assert(!std::is_constructible_v<Simulation, decltype((std::declval<Mechanism&>().system))>);
static_assert(std::is_constructible_v<Simulation, Mechanism>);
static_assert(std::is_nothrow_move_constructible_v<Simulation> && std::is_nothrow_move_assignable_v<Simulation>);

namespace {

using Set = std::vector<std::pair<std::string, std::string>>;

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
  "events": [{"name": "drop", "when": {"channel": "A.angle_z", "crosses": 0.4, "direction": "rising"}, "deactivate": ["grab"]},
             {"name": "end", "at": 0.45, "stop": true}],
  "run": {"integrator": "dop853", "tolerance": 1e-9, "until": 1, "output": 0.01, "at_jumps": true,
          "record": ["A.angle_z", {"y": "load.y"}, "A.force_on_p_world_y", "energy.total"]})~";

}  // namespace

TEST_CASE("a host runs a scene to the same rows as the program", "[simulation][scene]") {
  struct Case {
    const char* scene;
    Set set;
  };
  for (const Case& c : {Case{"four_bar", {{"crank", "0.12 m"}}}, Case{"bouncing_pendulum", {}}, Case{"slider_crank", {}},
                        Case{"free_body", {}}, Case{"gear_train", {}}}) {
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

TEST_CASE("a host's run of a scene has its start, events and rows at jumps", "[simulation][scene]") {
  const std::string file = scene_file("catch", kCatch);
  Simulation run(read_mechanism(file, builtin()));
  const SimulationReport& report = run.run();
  CHECK(report.stopped_by == "end");
  CHECK(run.state().t == 0.45);
  const Table& t = run.table();
  CHECK(std::abs(t.first("A.angle_z") - 0.3) < 1e-9);
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

TEST_CASE("what is wrong with a host's scene is said with its place", "[simulation][scene]") {
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
