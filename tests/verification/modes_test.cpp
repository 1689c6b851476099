// SPDX-License-Identifier: BSD-3-Clause
// Modes of linearised mechanisms against exact eigenvalues (tests/verification/data/modes.csv): what is held by joints
// alone has no frequency without their geometric stiffness.
#include <algorithm>
#include <complex>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <lockstep/author/phi_links.h>
#include <lockstep/dynamics.h>
#include <lockstep/forces.h>
#include <lockstep/joints.h>
#include <lockstep/modes.h>
#include <lockstep/solvers.h>
#include "tests/support/catch.h"
#include "tests/support/paths.h"

namespace modes_test {

using namespace lockstep;

namespace {

using Eigenvalues = std::vector<std::complex<double>>;

Eigenvalues exact(const std::string& name) {
  std::ifstream file(std::filesystem::path(paths::kSource) / "tests/verification/data/modes.csv");
  Eigenvalues out;
  for (std::string line; std::getline(file, line);) {
    std::istringstream cells(line);
    std::string which, k, re, im;
    std::getline(cells, which, ','), std::getline(cells, k, ','), std::getline(cells, re, ','), std::getline(cells, im);
    if (which == name) out.emplace_back(std::stod(re), std::stod(im));
  }
  REQUIRE_FALSE(out.empty());
  return out;
}

/// As many eigenvalues as there are, each near one of its own, and as many zeros: none split by round-off.
void check(const std::string& name, System& sys, const Vec3& spin = Vec3::Zero()) {
  Dynamics dynamics(sys, std::make_unique<DenseSolver>(), {.formulation = Formulation::omega, .stabilization = {}});
  for (const bool given : {true, false}) {
    CAPTURE(name, given);
    ModesOptions options;
    if (given) options.motion.spin = spin;
    const Modes modes = find_modes(dynamics, sys.start(), options);
    CHECK(modes.unrest.acceleration <= 1e-11);
    CHECK((modes.spin - spin).norm() <= 1e-14 * spin.norm());
    Eigenvalues found = modes.eigenvalues();
    const Eigenvalues truth = exact(name);
    REQUIRE(found.size() == truth.size());
    CHECK(std::ranges::count(found, 0.0) == std::ranges::count(truth, 0.0));
    for (const std::complex<double>& l : truth) {
      const auto nearest = std::min_element(
          found.begin(), found.end(), [&](const auto& a, const auto& b) { return std::abs(a - l) < std::abs(b - l); });
      CAPTURE(l, *nearest);
      CHECK(std::abs(*nearest - l) <= 1e-11 * std::abs(l));
      found.erase(nearest);
    }
    for (const Mode& mode : modes.modes) {
      CAPTURE(mode.value);
      if (mode.kind != Mode::Kind::rigid) CHECK(mode.bound <= 1e-6 * std::abs(mode.value));
    }
  }
}

MassProperties plain(double mass, const Vec3& J, const Vec3& center = Vec3::Zero()) {
  return {mass, center, J.asDiagonal()};
}
Quat turned(double angle) { return axis_angle(Vec3::UnitZ(), angle); }
Vec3 along(double angle, double length) { return {length * std::cos(angle), length * std::sin(angle), 0}; }

/// A uniform rod from `from` at an angle in the xy plane: x along it.
Body& rod(System& sys, const std::string& name, double mass, const Vec3& from, double angle, double length,
          double axial) {
  const double J = mass * length * length / 12;
  return sys.add_body(name, plain(mass, Vec3(axial, J, J)), {from + along(angle, 0.5 * length), turned(angle)});
}

}  // namespace

TEST_CASE("modes of a pendulum: hanging, standing, on a ball joint", "[verification][modes]") {
  for (const std::string name : {"pendulum_hanging", "pendulum_standing", "pendulum_spherical"}) {
    System sys({.gravity = {0, -9.81, 0}});
    const double y = name == "pendulum_standing" ? 0.7 : -0.7;
    Body& bob = sys.add_body("bob", plain(2, Vec3(0.2, 0.25, 0.3)), {Vec3(0, y, 0), {}});
    if (name == "pendulum_spherical")
      sys.add<Spherical>("pivot", bob, sys.ground(), pose_at(Vec3::Zero()));
    else
      sys.add<Revolute>("pivot", bob, sys.ground(), pose_at(Vec3::Zero()));
    check(name, sys);
  }
}

TEST_CASE("modes of a double pendulum", "[verification][modes]") {
  System sys({.gravity = {0, -9.81, 0}});
  Body& one = rod(sys, "one", 1, Vec3::Zero(), -kPi / 2, 1, 0.01);
  Body& two = rod(sys, "two", 1, Vec3(0, -1, 0), -kPi / 2, 1, 0.01);
  sys.add<Revolute>("A", one, sys.ground(), pose_at(Vec3::Zero()));
  sys.add<Revolute>("B", two, one, pose_at(Vec3(0, -1, 0)));
  check("double_pendulum", sys);
}

TEST_CASE("modes of a damped four-bar in space, with three redundant constraints", "[verification][modes]") {
  struct Pose4 {
    std::string name;
    double crank, coupler, rocker;
  };
  for (const Pose4& p :
       {Pose4{"four_bar_stable", 0.089357136630898975828, 0.93326034955042093343, 1.5781315719346305964},
        Pose4{"four_bar_unstable", -2.9772630999919799985, 0.76196040398267403441, 2.2736929447102757732}}) {
    System sys({.gravity = {0, -9.81, 0}});
    const Vec3 A = Vec3::Zero(), Dg(0.28, 0, 0), B = along(p.crank, 0.1), C = Dg + along(p.rocker, 0.25);
    REQUIRE((B + along(p.coupler, 0.3) - C).norm() <= 1e-15);
    Body& crank = rod(sys, "crank", 0.5, A, p.crank, 0.1, 0.0001);
    Body& coupler =
        sys.add_body("coupler", plain(1.2, Vec3(0.006, 0.008, 0.011), Vec3(0.12, 0.04, 0)), {B, turned(p.coupler)});
    Body& rocker = rod(sys, "rocker", 0.9, Dg, p.rocker, 0.25, 0.0001);
    sys.add<Revolute>("A", crank, sys.ground(), pose_at(A));
    sys.add<Revolute>("B", coupler, crank, pose_at(B));
    sys.add<Revolute>("C", coupler, rocker, pose_at(C));
    sys.add<Revolute>("D", rocker, sys.ground(), pose_at(Dg));
    Marker& P = sys.add_marker_at("spring.P", rocker, {Dg + along(p.rocker, 0.2), {}});
    Marker& S = sys.add_marker_at("spring.S", sys.ground(), {Vec3(0.5, 0.1, 0), {}});
    sys.add<SpringDamper>("spring", P, S, {.stiffness = 300, .damping = 4, .free_length = 0.2});
    check(p.name, sys);
  }
}

TEST_CASE("modes of a hanging chain: prestress alone", "[verification][modes]") {
  const double angle[] = {-0.75368352660804060617, 0.11654735384448024539, 0.97212536120518843814};
  const double length[] = {1, 0.8, 1.2}, mass[] = {1, 0.8, 1.5};
  for (const bool spherical : {false, true}) {
    System sys({.gravity = {0, -9.81, 0}});
    Vec3 x = Vec3::Zero();
    Body* before = &sys.ground();
    const auto join = [&](const std::string& name, Body& p, Body& s) {
      if (spherical)
        sys.add<Spherical>(name, p, s, pose_at(x));
      else
        sys.add<Revolute>(name, p, s, pose_at(x));
    };
    for (std::size_t k = 0; k < 3; ++k) {
      Body& body = rod(sys, "rod " + std::to_string(k), mass[k], x, angle[k], length[k], 0.001);
      join("joint " + std::to_string(k), body, *before);
      x += along(angle[k], length[k]);
      before = &body;
    }
    REQUIRE((x - Vec3(2.2, 0.4, 0)).norm() <= 1e-15);
    join("end", *before, sys.ground());
    check(spherical ? "chain_spherical" : "chain_planar", sys);
  }
}

namespace {

/// The y axis of S stays normal to the z axis of P: with a ball joint a universal joint.
struct Hooke {
  static constexpr PhiSpec spec{.reads = Reads::rotation};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return 2.0 * (y.e2 * y.e3 - y.e0 * y.e1);
  }
};
class UniversalJoint final : public PhiLock<Hooke> {
 public:
  UniversalJoint(std::string name, Marker& p, Marker& s) : PhiLock(std::move(name), p, s, Mask::xyz, Hooke{}) {}
  std::string_view type() const override { return "universal"; }
};

class Steady final : public MotionLaw {
 public:
  LawValue at(double t) const override { return {8 * t, 8, 0}; }
};

void build_governor(System& sys, bool universal, bool driven, double damping) {
  const double s = 0.64543751715686550992, alpha = 0.30558434360219792460;
  const Vec3 spin(0, 0, 8);
  const auto turning = [&](Body& b) {
    const Pose& home = b.home;
    b.start = {cross(spin, home.x), rotation(home.q).transpose() * spin};
  };
  Body& shaft = sys.add_body("shaft", plain(0.3, Vec3::Constant(0.02)));
  Body& slider = sys.add_body("slider", plain(3, Vec3::Constant(0.005)), {Vec3(0, 0, s), {}});
  turning(shaft), turning(slider);
  Revolute& bearing = sys.add<Revolute>("bearing", shaft, sys.ground(), pose_at(Vec3::Zero()));
  if (driven) bearing.drive(Axis::rz, std::make_shared<Steady>());
  sys.add<Prismatic>("guide", slider, shaft, pose_at(Vec3(0, 0, s)));
  for (const double side : {1.0, -1.0}) {
    const std::string name = side > 0 ? "right" : "left";
    const Vec3 hinge(0.05 * side, 0, 1), x(side * std::cos(alpha), 0, -std::sin(alpha)), y(0, side, 0);
    Mat3 A;
    A << x, y, cross(x, y);
    Body& arm = sys.add_body(name, plain(2, Vec3(0.01, 0.12, 0.125)), {hinge + 0.8 * x, quaternion_of(A)});
    turning(arm);
    if (universal)  // markers in the arm's axes, at home: y of S along the shaft's, z of P along the arm's
      sys.add<UniversalJoint>(name + " joint", arm, shaft, Pose{hinge, quaternion_of(A)});
    else
      sys.add<Revolute>(name + " joint", arm, shaft, pose_at(hinge, Vec3(y)));
    Marker& P = sys.add_marker_at(name + ".P", arm, {hinge + 0.5 * x, {}});
    Marker& S = sys.add_marker_at(name + ".S", slider, {Vec3(0.05 * side, 0, s), {}});
    sys.add<SpringDamper>(name + " spring", P, S, {.stiffness = 2000, .damping = damping, .free_length = 0.5});
  }
}

}  // namespace

TEST_CASE("modes of a governor in steady rotation", "[verification][modes]") {
  struct Case {
    std::string name;
    bool universal, driven;
    double damping;
  };
  for (const Case& c :
       {Case{"governor_revolute_free", false, false, 0}, Case{"governor_revolute_driven", false, true, 0},
        Case{"governor_universal_driven", true, true, 0}, Case{"governor_damped_universal_driven", true, true, 40},
        Case{"governor_damped_universal_free", true, false, 40}}) {
    System sys({.gravity = {0, 0, -9.81}});
    build_governor(sys, c.universal, c.driven, c.damping);
    check(c.name, sys, Vec3(0, 0, 8));
  }
}

}  // namespace modes_test
