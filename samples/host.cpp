// SPDX-License-Identifier: BSD-3-Clause
// A host program of forty lines: loads two plugins, drives a plugin's cam by a plugin's law, and watches the lift.
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/lockstep.h>
#include "samples/shared/output.h"
#include "samples/shared/paths.h"

using namespace lockstep;

int main() {
  try {
    Registry registry = builtin_registry();
    for (const char* plugin : {"cam_follower", "bump"})
      fmt::print("loaded {}\n", load_plugin(registry, plugin, {paths::kPlugins}));

    System sys({.gravity = {0, -9.81, 0}});
    Body& cam = sys.add_body("cam", shapes::cylinder(1.0, 0.05, 0.02));
    Body& follower = sys.add_body("follower", shapes::box(0.3, {0.02, 0.1, 0.02}), {{0, 0.05, 0}, {}});
    auto& shaft = sys.add<Revolute>("shaft", cam, sys.ground(), pose_at({0, 0, 0}));
    sys.add<Prismatic>("guide", follower, sys.ground(), pose_at({0, 0.05, 0}, Vec3::UnitY()));

    // By name, like a built-in one: the cam joint from one plugin, the law of the shaft's angle from the other.
    Marker& tip = sys.add_marker_at("tip", follower, {{0, 0.05, 0}, {}});
    Marker& disc = sys.add_marker_at("disc", cam, {{0, 0, 0}, axis_angle(Vec3::UnitZ(), kPi / 2)});
    sys.add(registry.links.make("cam_follower", Attachment{"ride", {{&tip, &disc}}},
                                Params{{"base", 0.05}, {"lift", 0.02}}, &registry, "host"));
    shaft.drive(Axis::rz,
                registry.laws.make("bump", Params{{"height", kTwoPi}, {"at", 1.0}, {"width", 1.0}}, &registry, "host"));

    Recorder recorder(sys, {"shaft.rz", "follower.y", "shaft.drive.torque_on_p_link_z"});
    Dynamics dynamics(sys, registry.solvers.make("schur", Params{}, &registry, "host"));
    State start = sys.start();
    assemble(dynamics, start);
    StepLoop run(dynamics, registry.integrators.make("dopri5", Params{}, &registry, "host"), {.output = 0.01});
    run.set_state(start);
    run.add_observer(recorder);
    run.run_until(2.0);

    double worst = 0;
    const Table& t = recorder.table();
    for (std::size_t i = 0; i < t.n_rows(); ++i)
      worst = std::max(worst, std::abs(t["follower.y"][i] - (0.05 + 0.01 * (1 - std::cos(t["shaft.rz"][i])))));
    write_csv(samples::output("host.csv"), t);
    fmt::print("lift follows the profile to {:.1e} m; {}\n", worst, samples::output("host.csv"));
    return worst < 1e-9 ? 0 : 1;
  } catch (const Error& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
