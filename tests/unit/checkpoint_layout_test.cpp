// SPDX-License-Identifier: BSD-3-Clause
// Kept checkpoints: as long as the number of their layout is the same, they are gone on with.
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include <lockstep/error.h>
#include <lockstep/forces.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/recorder.h>
#include <lockstep/simulation.h>
#include "framework/tools/rank/doubts.h"
#include "framework/tools/simulation/checkpoint.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"

namespace checkpoint_layout_test {

using namespace lockstep;

namespace {

constexpr double kSaved = 0.25, kEnd = 0.5;  // s

/// A run with what checkpoints hold: counted turns, an integrated state, a rope that jerks, an event, rows, and what
/// watches a run.
struct Kept {
  System system{System::Options{{0, -9.81, 0}}};
  std::vector<std::unique_ptr<Observer>> watches;
  std::unique_ptr<Simulation> run;

  explicit Kept(SimulationOptions options) {
    const MassProperties bar{1.0, Vec3(0.5, 0, 0), Vec3(0.01, 0.125, 0.125).asDiagonal()};
    Body& rod = system.add_body("rod", bar);
    Body& wheel = system.add_body("wheel", bar, {Vec3(3, 0, 0), {}});
    system.add<Revolute>("hinge", rod, system.ground(), pose_at({0, 0, 0}));
    Revolute& axle = system.add<Revolute>("axle", wheel, system.ground(), pose_at({3, 0, 0}));
    if (!options.integrator.starts_with("rattle"))
      axle.drive_speed(Axis::rz, laws::ramp(2));  // they take no own states
    Marker &p = system.add_marker("p", rod), &s = system.add_marker("s", system.ground());
    system.add<TorsionSpringDamper>("coil", p, s, TorsionSpringDamper::Options{0.5, 0, 0, 0, {}});
    Marker &tip = system.add_marker("tip", rod, pose_at({1, 0, 0})),
           &hook = system.add_marker("hook", system.ground(), pose_at({1, 0.5, 0}));
    Distance& rope = system.add<Distance>("rope", tip, hook, 0.625);  // taut at 0.125 m below the start
    rope.set_unilateral({.restitution = 0.5, .below = true});
    options.output = 0.125;
    options.dynamics.formulation = options.solver.empty() ? Formulation::automatic : Formulation::omega;
    run = std::make_unique<Simulation>(system, options);
    run->record({"rod.angle_z", "energy.balance"});
    watches.push_back(std::make_unique<EnergyAudit>(system));
    watches.push_back(std::make_unique<Doubts>(true, options.tolerance));
    for (const auto& watch : watches) run->add_observer(*watch);
    run->add_event({.name = "halt", .at = 5, .stop = true});
  }
};

const std::vector<SimulationOptions>& all_options() {
  static const std::vector<SimulationOptions> all = [] {
    std::vector<SimulationOptions> each;
    for (const char* method :
         {"dopri5", "dop853", "radau5", "rk4", "rattle2", "rattle4", "generalized_alpha", "semi_implicit_euler"})
      each.push_back({.integrator = method});
    for (const char* solver : {"sparse", "dense", "block"}) each.push_back({.integrator = "dopri5", .solver = solver});
    for (SimulationOptions& o : each)
      o.step = o.integrator.starts_with("do") || o.integrator == "radau5" ? 0 : 0.0078125;
    return each;
  }();
  return all;
}

std::string name_of(const SimulationOptions& o) {
  return o.integrator + (o.solver.empty() ? " default" : " " + o.solver);
}

Snapshot saved_by(const SimulationOptions& options) {
  Kept kept(options);
  kept.run->run_until(kSaved);
  Snapshot out;
  kept.run->loop().save(out);
  return out;
}

/// name, how many, the numbers: one run a line.
std::map<std::string, std::vector<double>> read(const std::string& file) {
  std::map<std::string, std::vector<double>> all;
  std::ifstream in(file);
  std::string method, solver, word;
  for (std::size_t n = 0; in >> method >> solver >> n;) {
    std::vector<double>& numbers = all[method + " " + solver];
    while (numbers.size() < n && in >> word) numbers.push_back(std::stod(word));
  }
  return all;
}

std::string file_name() { return fmt::format("checkpoint_layout_{}.txt", kCheckpointLayout); }

/// What this build writes, to be kept when the layout has another number.
std::string write_present() {
  const std::filesystem::path folder = std::filesystem::path(paths::kBuild) / "output";
  std::filesystem::create_directories(folder);
  const std::string file = (folder / file_name()).string();
  std::ofstream out(file);
  for (const SimulationOptions& options : all_options()) {
    const Snapshot saved = saved_by(options);
    out << name_of(options) << ' ' << saved.numbers().size();
    for (const double x : saved.numbers()) out << fmt::format(" {}", x);
    out << '\n';
  }
  return file;
}

}  // namespace

TEST_CASE("kept checkpoints are gone on with while their layout has the same number", "[unit][checkpoint]") {
  const std::string file = std::string(paths::kSource) + "/tests/unit/data/" + file_name(), present = write_present();
  INFO("Checkpoints of layout " << kCheckpointLayout << " cannot be read as they are kept in " << file
                                << ". Where what they hold has changed: add 1 to kCheckpointLayout "
                                   "(framework/tools/simulation/checkpoint.h), run this test, and keep "
                                << present << ", which it names then, in place of that file.");
  const auto kept = read(file);
  REQUIRE(kept.size() == all_options().size());
  for (const SimulationOptions& options : all_options()) {
    CAPTURE(name_of(options));
    REQUIRE(kept.contains(name_of(options)));
    const std::vector<double>& numbers = kept.at(name_of(options));
    Kept on(options), whole(options);
    Snapshot in, again;
    in.assign(numbers);
    REQUIRE_NOTHROW(on.run->loop().load(in));
    REQUIRE(on.run->state().t == kSaved);
    on.run->loop().save(again);
    CHECK(again.numbers() == numbers);
    on.run->run_until(kEnd);
    whole.run->run_until(kSaved), whole.run->run_until(kEnd);
    const Table &rest = on.run->table(), &all = whole.run->table();
    REQUIRE(rest.n_rows() == all.n_rows());
    CHECK(rest.last("rod.angle_z") == Approx(all.last("rod.angle_z")).margin(1e-6));
    CHECK(on.run->state().s.size() == whole.run->state().s.size());
    CHECK((on.run->state().v - whole.run->state().v).norm() < 1e-5);
  }
}

}  // namespace checkpoint_layout_test
