// Loops in joint coordinates: links beside the tree stay rows. Accelerations against omega, projections, runs.
#include <cmath>
#include <filesystem>

#include <lockstep/assembly.h>
#include <lockstep/registry.h>
#include <lockstep/solvers.h>
#include <lockstep/sweep.h>
#include "framework/dynamics/tree/joint_tree.h"
#include "tests/support/catch.h"
#include "tests/support/configuration.h"
#include "tests/support/paths.h"
#include "tests/support/run_scene.h"
#include "tests/support/worst.h"

namespace closures_test {

using namespace lockstep;
using oracle::Draw;

namespace {

double largest(const VecX& x) { return x.size() > 0 ? x.lpNorm<Eigen::Infinity>() : 0.0; }

/// The scenes of a folder of the sources, by file name.
std::vector<std::string> scenes_in(const std::string& folder) {
  std::vector<std::string> all;
  for (const auto& file : std::filesystem::directory_iterator(std::string(paths::kSource) + "/" + folder))
    if (file.path().extension() == ".json") all.push_back(file.path().string());
  std::ranges::sort(all);
  return all;
}

/// A mechanism in space, in joint coordinates with its closures; null where these are not possible.
struct Loops {
  Mechanism mechanism;
  std::unique_ptr<Dynamics> dynamics;
  std::string why_not;
  Loops(const std::string& path, const Registry& registry) : mechanism(built(path, registry)) {
    dynamics = std::make_unique<Dynamics>(
        mechanism.system, std::make_unique<SchurSolver>(),
        DynamicsOptions{.formulation = Formulation::joint, .stabilization = mechanism.run.stabilization});
    why_not = dynamics->why_not_joint(mechanism.system.start().modes);
  }
  State start() {
    State state = mechanism.system.start();
    if (mechanism.run.assemble) assemble(*dynamics, state, mechanism.start_speeds, mechanism.assembly);
    return state;
  }

 private:
  static Mechanism built(const std::string& path, const Registry& registry) {
    Scene scene = read_scene(path);
    scene.run.formulation = Formulation::joint;
    return build_mechanism(scene, registry);
  }
};

/// Accelerations of the slots, world axes, that rates in joint coordinates mean, without laws.
VecX accelerations(const Dynamics& dynamics, const State& state, const StateRate& rate) {
  std::vector<Motion> motions;
  dynamics.system().motions(state, motions);
  VecX dx, dv;
  state.coordinates->variations(state, motions, rate, dx, dv);
  return dv;
}

VecX of_omega(Dynamics& dynamics, const State& state) {
  const Solution& s = dynamics.evaluate(state);
  VecX a = s.a;
  for (int k = 0; k < dynamics.system().n_slots(); ++k)
    a.segment<3>(6 * k + 3) = s.in.slot(k).A * a.segment<3>(6 * k + 3);
  return a;
}

}  // namespace

TEST_CASE("scenes with loops accelerate in joint coordinates as in omega", "[verification][joint]") {
  int checked = 0;
  for (const char* folder : {"samples/scenes", "tests/verification/scenes", "tests/verification/scenes/overconstrained"})
    for (const std::string& path : scenes_in(folder)) {
      CAPTURE(path);
      Loops loops(path, builtin_registry());
      if (!loops.why_not.empty()) continue;
      State state = loops.start();
      Draw draw(7);
      for (int n = 0; n < 4; ++n) {
        CAPTURE(n);
        State joint = state;
        loops.dynamics->to_formulation(joint);
        REQUIRE(joint.coordinates);
        if (!joint.coordinates->has_rows() || joint.coordinates->has_laws()) break;
        if (n > 0) {  // another position, and other velocities
          for (double& v : joint.v) v += 0.3 * draw.number(-1, 1);
          loops.dynamics->project_velocity(joint);
          loops.dynamics->advance(joint, 0.05 * n, joint.v);
        }
        const ProjectReport there = loops.dynamics->project(joint, 0);
        if (n > 0 && !there.converged) continue;
        CHECK(there.converged);
        State slots = joint;
        loops.dynamics->to_slots(slots);
        CHECK(loops.dynamics->violation(slots) < 1e-10 * std::max(1.0, loops.dynamics->system().length()));
        StateRate rate;
        const SolveReport report = loops.dynamics->rates_with_report(joint, rate);
        const VecX a = accelerations(*loops.dynamics, joint, rate), omega = of_omega(*loops.dynamics, slots);
        const double error = largest(a - omega) / std::max(1e-3, largest(omega));
        std::printf("%-40s %d error %.1e residual %.1e pivot %.1e detector %.1e corr %ld\n", path.substr(path.rfind('/') + 1).c_str(), n, error, report.residual, report.smallest_pivot, report.detector, loops.dynamics->work().corrections);
        CHECK(error < 1e-10);
        std::fflush(stdout);
        ++checked;
      }
    }
  CHECK(checked > 100);
}

}  // namespace closures_test
