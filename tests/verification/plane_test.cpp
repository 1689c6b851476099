// Planar mechanisms: the same motion as in space, half the unknowns; and who leaves the plane is told by name.
#include <algorithm>

#include <lockstep/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/solvers.h>
#include <lockstep/joints.h>
#include <lockstep/scene.h>
#include <lockstep/error.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/paths.h"
#include "tests/support/run_scene.h"

namespace plane_test {

using namespace lockstep;
using lockstep::testing::message_of;

namespace {

void in_plane(Scene& scene) { scene.root.object()->push_back({"planar", Value("auto"), {}}); }

/// A rod on a revolute joint at the origin, axis z, that hangs along x.
struct Rod {
  System system{{.gravity = Vec3(0, -9.81, 0)}};
  Body& rod = system.add_body("rod", {1.0, Vec3::Zero(), Vec3(0.01, 0.1, 0.1).asDiagonal()}, {Vec3(0.5, 0, 0), {}});
  Revolute& joint = system.add<Revolute>("hinge", rod, system.ground(), pose_at(Vec3(0, 0, 0)));
};

/// Along x; from t = 5 s along z as well.
class LeavesLater final : public TranslationLaw {
 public:
  TranslationValue at(double t) const override {
    TranslationValue l;
    l.x = Vec3(0.1 * t, 0, t > 5 ? t - 5 : 0.0), l.v = Vec3(0.1, 0, t > 5 ? 1.0 : 0.0), l.a.setZero();
    return l;
  }
};

/// What setting up in the plane says.
std::string refusal(System& system, int n = 2) {
  system.set_planar(Plane{n});
  return message_of<ModelError>([&] { system.setup(); });
}

}  // namespace

TEST_CASE("planar scenes move as in space, every column", "[verification][plane]") {
  const std::string name = GENERATE("rod_pendulum", "a01_pendulum", "double_pendulum", "chain_10", "andrews_ivp",
                                    "four_bar", "slider_crank", "prismatic_law", "mass_spring_damper", "oldham");
  CAPTURE(name);
  const auto precise = [](RunSettings& run) {
    if (run.step == 0) run.tolerance = {1e-11, 1e-13};
  };
  const SceneRun space = run_scene(scene_path(name), precise);
  const SceneRun flat = run_scene(scene_path(name), precise, in_plane);
  CHECK(flat.n_velocities < space.n_velocities);
  for (const ColumnError& e : compare(flat.table, space.table)) {
    CAPTURE(e.name, e.error, e.size);
    CHECK(e.error <= 1e-10 * std::max(1.0, e.size));
  }
}

TEST_CASE("mechanisms in space are not taken for planar ones", "[verification][plane]") {
  const std::string name = GENERATE("heavy_top", "spatial_chain_10_tilted", "robot_arm", "homokinetic",
                                    "moving_marker_free", "free_body", "gyroscope_steady");
  CAPTURE(name);
  const Registry registry = builtin_registry();
  Mechanism m = build_mechanism(read_scene(scene_path(name)), registry);
  CHECK_FALSE(find_plane(m.system));
}

TEST_CASE("in the plane all solvers agree, redundant or not", "[verification][plane]") {
  const Registry registry = builtin_registry();
  const std::string name = GENERATE("andrews_ivp", "four_bar", "prismatic_law", "chain_10");
  CAPTURE(name);
  Scene scene = read_scene(scene_path(name));
  in_plane(scene);
  Mechanism m = build_mechanism(scene, registry);
  REQUIRE(m.system.plane() == Plane{2});
  const auto solved = [&](std::unique_ptr<LinearSolver> solver) {
    Dynamics dynamics(m.system, std::move(solver));
    State state = m.system.start();
    dynamics.project(state);
    const Evaluated& v = dynamics.evaluate(state);
    return std::pair<VecX, VecX>(v.a, v.lambda);
  };
  const std::pair<VecX, VecX> schur = solved(std::make_unique<SchurSolver>());
  const VecX &a = schur.first, &lambda = schur.second;
  const auto same = [&](std::unique_ptr<LinearSolver> solver) {
    const auto [a2, lambda2] = solved(std::move(solver));
    CHECK((a - a2).lpNorm<Eigen::Infinity>() <= 1e-9 * std::max(1.0, a.lpNorm<Eigen::Infinity>()));
    CHECK((lambda - lambda2).lpNorm<Eigen::Infinity>() <= 1e-8 * std::max(1.0, lambda.lpNorm<Eigen::Infinity>()));
  };
  same(std::make_unique<DenseSolver>());
  same(std::make_unique<SparseSolver>());
}

TEST_CASE("every axis can be the normal", "[verification][plane]") {
  // The same pendulum turned: gravity along -(n + 2), the rod along n + 1, axis n.
  double rate[3];
  for (int n = 0; n < 3; ++n) {
    const Vec3 along = Vec3::Unit((n + 1) % 3), axis = Vec3::Unit(n), down = -9.81 * Vec3::Unit((n + 2) % 3);
    System system{{.gravity = down}};
    Vec3 J(0.1, 0.1, 0.1);
    J[(n + 1) % 3] = 0.01;
    Body& rod = system.add_body("rod", {1.0, Vec3::Zero(), J.asDiagonal()}, {0.5 * along, {}});
    rod.start.w = 2.0 * axis;
    rod.start.v = cross(Vec3(2.0 * axis), Vec3(0.5 * along));
    system.add<Revolute>("hinge", rod, system.ground(), pose_at(Vec3(0, 0, 0), axis));
    CHECK(find_plane(system) == Plane{n});
    system.set_planar(Plane{n});
    Dynamics dynamics(system, std::make_unique<SchurSolver>());
    CHECK(system.n_velocities() == 3);
    const Solution& values = dynamics.evaluate(system.start());
    rate[n] = values.a[3 + n];
    CHECK(values.rows.n_rows == 2);
  }
  CHECK(rate[0] == Approx(-9.81 * 0.5 / 0.35));
  CHECK(rate[1] == Approx(rate[0]).epsilon(1e-14));
  CHECK(rate[2] == Approx(rate[0]).epsilon(1e-14));
}

TEST_CASE("whoever leaves the plane is named", "[verification][plane]") {
  {
    Rod r;
    CHECK(refusal(r.system, 1).find("gravity has -9.81 m/s^2") != std::string::npos);
  }
  {
    Rod r;
    r.rod.start.v = Vec3(0, 0, 0.1);
    CHECK(refusal(r.system).find("body 'rod'") != std::string::npos);
  }
  {
    Rod r;
    r.rod.mass.J(0, 2) = r.rod.mass.J(2, 0) = 0.005;
    CHECK(refusal(r.system).find("not a principal axis") != std::string::npos);
  }
  {
    Rod r;
    Body& other =
        r.system.add_body("other", {1.0, Vec3::Zero(), Vec3(0.1, 0.1, 0.1).asDiagonal()}, {Vec3(1, 0, 0), {}});
    r.system.add<Revolute>("tilted", other, r.rod, pose_at(Vec3(1, 0, 0), Vec3(0, 1, 1)));
    const std::string text = refusal(r.system);
    CHECK(text.find("link 'tilted', row") != std::string::npos);
    CHECK(text.find("normal z") != std::string::npos);
  }
  {
    Rod r;
    CHECK(refusal(r.system) == "no error");
    CHECK(r.system.n_velocities() == 3);
  }
}

TEST_CASE("a law that leaves the plane later stops the run by name", "[verification][plane]") {
  Rod r;
  Body& slider = r.system.add_body("slider", {1.0, Vec3::Zero(), Vec3(0.1, 0.1, 0.1).asDiagonal()}, {});
  Fixed& drive = r.system.add<Fixed>("drive", slider, r.system.ground(), pose_at(Vec3(0, 0, 0)));
  drive.move(std::make_shared<LeavesLater>());
  r.system.set_planar(Plane{2});
  Dynamics dynamics(r.system, std::make_unique<SchurSolver>());
  State state = r.system.start();
  CHECK_NOTHROW(dynamics.evaluate(state));
  state.t = 6.0;
  const std::string text = message_of<ModelError>([&] { dynamics.evaluate(state); });
  CHECK(text.find("link 'drive': its law leaves the plane at t = 6") != std::string::npos);
}

}  // namespace plane_test
