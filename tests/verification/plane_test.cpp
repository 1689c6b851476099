// SPDX-License-Identifier: BSD-3-Clause
// Planar mechanisms: the same motion as in space, half the unknowns; and who leaves the plane is told by name.
#include <algorithm>

#include <lockstep/author/phi_links.h>
#include <lockstep/author/registry.h>
#include <lockstep/combined_laws.h>
#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include <lockstep/forces.h>
#include <lockstep/frame_laws.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include <lockstep/splines.h>
#include "framework/description/scene/system_of.h"
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

std::string own_scene(const std::string& name) {
  return std::string(paths::kSource) + "/tests/verification/scenes/" + name + ".json";
}

/// y = 0, by a function that does not say that planar mechanisms stay in their plane.
struct Straight {
  static constexpr PhiSpec spec{.reads = Reads::translation};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.y;
  }
};
class Guided final : public PhiLock<Straight> {
 public:
  using PhiLock::PhiLock;
  std::string_view type() const override { return "guided"; }
};

/// A force on the rod at this place on it.
void push(Rod& r, const Vec3& at, const AppliedForce::Options& options) {
  r.system.add(std::make_unique<AppliedForce>("push", r.system.add_marker("tip", r.rod, pose_at(at)), options));
}

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
  const SceneRun space = run_scene(scene_path(name), precise, [](Scene& scene) { scene = in_space(scene); });
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
  CHECK_FALSE(settle_in_plane(system_of(m)));
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
    Dynamics dynamics(system_of(m), std::move(solver));
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
    CHECK(settle_in_plane(system) == Plane{n});
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

TEST_CASE("a motion that leaves the plane is named", "[verification][plane]") {
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
    CHECK(text.find("joint 'tilted', constraint") != std::string::npos);
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
  CHECK(text.find("joint 'drive': its law leaves the plane at t = 6") != std::string::npos);
  CHECK_FALSE(settle_in_plane(r.system));  // a law that does not say that it stays
}

TEST_CASE("a type that does not declare to stay in the plane keeps the mechanism in space", "[verification][plane]") {
  const auto found = [](auto&& add) {
    Rod r;
    add(r);
    return bool(settle_in_plane(r.system));
  };
  const Vec3 tip(0.5, 0, 0);
  const auto late = laws::sequence({{5, laws::constant(0)}, {5, laws::constant(1)}});  // zero wherever it is evaluated
  CHECK(found([](Rod&) {}));
  SECTION("laws that end") {  // before the times at which the plane is looked at
    CHECK(found([](Rod& r) { r.joint.drive(Axis::rz, laws::spline({{0, 0}, {0.005, 0.1}, {0.01, 0.1}})); }));
    struct Ends final : MotionLaw {
      LawValue at(double t) const override {
        if (t > 0.01) throw std::out_of_range("no more");
        return {};
      }
    };
    CHECK(found([](Rod& r) { r.joint.drive(Axis::rz, std::make_shared<Ends>()); }));
  }
  SECTION("forces") {
    const auto function = [](const Inputs&, WrenchSum&) {};
    CHECK_FALSE(found([&](Rod& r) {
      r.system.add(function_force("own", {&r.system.add_marker("tip", r.rod, pose_at(tip))}, function));
    }));
    const auto applied = [&](const Vec3& direction, const Vec3& at) {
      return found([&](Rod& r) { push(r, at, {.law = late, .direction = direction, .axes = AppliedAxes::body}); });
    };
    CHECK(applied(Vec3(1, 2, 0), tip));
    CHECK_FALSE(applied(Vec3(0, 0, 1), tip));
    CHECK_FALSE(applied(Vec3(1, 2, 0), Vec3(0.5, 0, 0.1)));
  }
  SECTION("laws") {
    const auto moved = [&](LawPtr<TranslationLaw> law) {
      return found([&](Rod& r) {
        Marker& marker = r.system.add_marker("guide", r.rod, pose_at(tip));
        marker.translation_law = law;
        Body& other = r.system.add_body("other", r.rod.mass, {tip, {}});
        r.system.add<Revolute>("pin", r.system.add_marker("own", other, pose_at(Vec3(0, 0, 0))), marker);
      });
    };
    const auto sine = laws::sine({.amplitude = 0.1, .omega = 1});
    CHECK(moved(laws::along(Vec3(1, 1, 0), sine)));
    CHECK_FALSE(moved(laws::along(Vec3(0, 0, 1), late)));
    const Vec3 z(0, 0, 1);  // a law itself: where it leaves the plane is not looked at
    CHECK_FALSE(laws::path({{0, Vec3(0, 0, 0)}, {7, Vec3(1, 0, 0)}, {9, Vec3(0, 1, 0.01)}})->stays_in_plane(z));
    CHECK(laws::path({{0, Vec3(0, 0, 1)}, {7, Vec3(1, 0, 1)}, {9, Vec3(0, 1, 1)}})->stays_in_plane(z));
    CHECK(moved(laws::components(sine, sine, laws::constant(0))));
    CHECK_FALSE(moved(laws::components(sine, sine, late)));
    CHECK(moved(laws::path({{0, Vec3(0, 0, 0)}, {1, Vec3(0.1, 0, 0)}, {2, Vec3(0, 0.1, 0)}},
                           {.outside = SplineOutside::hold})));
    CHECK_FALSE(moved(laws::path({{0, Vec3(0, 0, 0)}, {1, Vec3(0.1, 0, 0)}, {2, Vec3(0, 0.1, 0.01)}},
                                 {.outside = SplineOutside::hold})));
  }
  SECTION("turns") {
    const auto turned = [&](LawPtr<RotationLaw> law) {
      return found([&](Rod& r) {
        Body& other = r.system.add_body("other", r.rod.mass, {tip, {}});
        r.system.add<Fixed>("pin", other, r.rod, pose_at(tip)).turn(law);
      });
    };
    const auto ramp = laws::ramp(1);
    CHECK(turned(laws::axis_rotation(Vec3(0, 0, -2), ramp)));
    CHECK_FALSE(turned(laws::axis_rotation(Vec3(0, 1, 1), late)));
    CHECK(turned(laws::rotation_product(laws::constant_rotation(axis_angle(Vec3(0, 0, 1), 0.3)),
                                        laws::axis_rotation(Vec3(0, 0, 1), ramp))));
    const auto about = [](const Vec3& axis) {
      return laws::spline_rotation({{0, Quat{}}, {1, axis_angle(axis, 0.4)}, {2, axis_angle(axis, 0.1)}},
                                   {.outside = SplineOutside::hold});
    };
    CHECK(turned(about(Vec3(0, 0, 1))));
    CHECK_FALSE(turned(about(Vec3(0, 1, 0))));
    CHECK_FALSE(about(Vec3(0, 1, 0))->turns_about(Vec3(0, 0, 1)));
    CHECK(about(Vec3(0, 1, 0))->turns_about(Vec3(0, -1, 0)));
  }
  SECTION("functions") {
    const auto held = [&](auto&& add) {
      return found([&](Rod& r) {
        add(r, r.system.add_marker("tip", r.rod, pose_at(tip)),
            r.system.add_marker("rail", r.system.ground(), pose_at(Vec3(0, 0, 0))));
      });
    };
    CHECK(held([](Rod& r, Marker& P, Marker& S) { r.system.add<Distance>("bar", P, S); }));
    CHECK_FALSE(
        held([](Rod& r, Marker& P, Marker& S) { r.system.add<Guided>("guide", P, S, Mask::none, Straight{}); }));
  }
}

TEST_CASE("planar by default: loops that are known to stay in their plane", "[verification][plane]") {
  const auto plane_of = [](const std::string& path, Formulation formulation = Formulation::automatic) {
    const Registry registry = builtin_registry();
    Scene scene = read_scene(path);
    scene.run.formulation = formulation;
    return build_mechanism(scene, registry).system.plane();
  };
  CHECK(plane_of(scene_path("four_bar")) == Plane{2});
  CHECK(plane_of(scene_path("andrews_ivp")) == Plane{2});
  CHECK_FALSE(plane_of(scene_path("four_bar"), Formulation::quaternion));
  CHECK_FALSE(plane_of(scene_path("chain_10")));  // joint coordinates are cheaper
  CHECK(plane_of(scene_path("chain_10"), Formulation::omega) == Plane{2});
  CHECK_FALSE(plane_of(scene_path("heavy_top")));
  CHECK_FALSE(plane_of(own_scene("conical_pendulum")));
  CHECK_FALSE(plane_of(own_scene("conical_pendulum"), Formulation::omega));
}

TEST_CASE("an addition to a mechanism in its plane may bring it back into space", "[verification][plane]") {
  Mechanism m = build_mechanism(read_scene(scene_path("four_bar")), builtin_registry());
  REQUIRE(m.system.plane() == Plane{2});
  const Marker& tip = system_of(m).add_marker("tip", system_of(m).body(system_of(m).bodies().back().name));
  system_of(m).add(function_force("own", {&tip}, [](const Inputs&, WrenchSum&) {}));
  system_of(m).setup();
  CHECK_FALSE(m.system.plane());
  system_of(m).set_planar(Plane{2});  // by name it is looked at only
  system_of(m).setup();
  CHECK(m.system.plane() == Plane{2});
}

TEST_CASE("lever arms of small mechanisms are seen", "[verification][plane]") {
  const double size = 1e-5;
  System system;
  Body& rod =
      system.add_body("rod", {1e-12, Vec3::Zero(), 1e-22 * Vec3(1, 10, 10).asDiagonal()}, {Vec3(size, 0, 0), {}});
  rod.start = {Vec3(0, size, 0), Vec3(0, 0, 1)};
  system.add<Revolute>("hinge", rod, system.ground(), pose_at(Vec3(0, 0, 0.3 * size)));
  system.set_planar(Plane{2});
  system.setup();
  CHECK(system.has_offsets());
  CHECK_FALSE(settle_in_plane(system));
}

TEST_CASE("a start or a force that leaves the plane is rejected by name", "[verification][plane]") {
  const auto refused = [](const std::string& scene, const char* normal) {
    const Registry registry = builtin_registry();
    Scene read = read_scene(own_scene(scene));
    read.root.object()->push_back({"planar", Value(normal), {}});
    return message_of<SceneError>([&] { build_mechanism(read, registry); });
  };
  const std::string start = refused("conical_pendulum", "y");
  CHECK(start.find("joint 'ball'") != std::string::npos);
  CHECK(start.find("starts with 2 rad/s out of the plane") != std::string::npos);
  const std::string force = refused("force_off_the_plane", "z");
  CHECK(force.find("force 'f'") != std::string::npos);
  CHECK(force.find("lever arm along the normal") != std::string::npos);
}

// The same lever arm on a body that a hinge holds in the plane: the hinge takes the moment.
TEST_CASE("a lever arm along the normal is taken by joints that hold the body", "[verification][plane]") {
  const auto turning = [](bool planar) {
    Rod r;
    push(r, Vec3(0.5, 0, 0.1), {.force = Vec3(0, 1, 0)});
    if (planar) r.system.set_planar(Plane{2});
    Dynamics dynamics(r.system, std::make_unique<SchurSolver>());
    return dynamics.evaluate(r.system.start()).a[5];
  };
  CHECK(turning(true) == Approx(turning(false)).epsilon(1e-13));

  Rod beside;  // a body that flies freely does not matter, a link that is not in force does not help
  beside.system.add_body("free", beside.rod.mass, {Vec3(0, 2, 0), {}});
  push(beside, Vec3(0.5, 0, 0.1), {.force = Vec3(0, 1, 0)});
  CHECK(refusal(beside.system) == "no error");
  beside.joint.set_active_at_start(false);
  beside.system.set_planar({});
  const std::string tips = refusal(beside.system);
  CHECK(tips.find("the joints of body 'rod' do not take it, so the body tips out of the plane") != std::string::npos);
}

}  // namespace plane_test
