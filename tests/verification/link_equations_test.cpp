// SPDX-License-Identifier: BSD-3-Clause
// The equations of one link at a state: C along motions of the bodies, differentiated, against Ct, J, Cq and Qc.
#include <array>
#include <cmath>
#include <memory>
#include <string>

#include <lockstep/dynamics.h>
#include <lockstep/explain.h>
#include <lockstep/frame_laws.h>
#include <lockstep/lockstep.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace link_equations_test {

using namespace lockstep;

namespace {

/// A motion of one slot: a parabola, and a quaternion that turns and turns faster.
struct Course {
  Vec3 x, v, a;
  Vec4 q, qd, qdd;

  Pose at(double t) const {
    const Vec4 now = (q + t * qd + t * t * qdd).normalized();
    return {x + t * v + 0.5 * t * t * a, Quat::from(now)};
  }
  Vec4 quaternion(double t) const { return at(t).q.coefficients(); }
};

/// First and second derivative at 0 of what `f` gives over time, to the fourth power of the step.
template <class F>
std::array<VecX, 2> derivatives(F&& f) {
  constexpr double h = 2e-3;
  const VecX zero = f(0), up = f(h), down = f(-h), far_up = f(2 * h), far_down = f(-2 * h);
  return {(8 * (up - down) - (far_up - far_down)) / (12 * h),
          (16 * (up + down) - (far_up + far_down) - 30 * zero) / (12 * h * h)};
}

/// Two bodies that move by courses of their own, and links between them and to the ground with laws of all kinds.
struct Bench {
  System system;
  std::array<Course, 2> course{Course{{0.3, -0.2, 0.5},
                                      {0.4, 0.7, -0.3},
                                      {1.1, -0.6, 0.8},
                                      {0.9, 0.2, -0.3, 0.1},
                                      {0.1, 0.6, 0.2, -0.4},
                                      {-0.3, 0.2, 0.5, 0.4}},
                               Course{{-0.4, 0.6, 0.1},
                                      {-0.5, 0.2, 0.6},
                                      {0.3, 0.9, -0.7},
                                      {0.7, -0.4, 0.2, 0.3},
                                      {-0.2, 0.1, 0.5, 0.3},
                                      {0.6, 0.1, -0.2, 0.3}}};

  Bench() {
    Body& one = system.add_body("one", MassProperties{2, {0.1, 0.05, -0.1}, Mat3::Identity()}, pose_at(course[0].x));
    Body& two = system.add_body("two", MassProperties{3, {-0.1, 0, 0.2}, Mat3::Identity()}, pose_at(course[1].x));
    const auto pair = [&](const std::string& name, Body& p, Body& s) {
      return std::pair<Marker&, Marker&>(
          system.add_marker(name + ".P", p, {{0.2, -0.1, 0.3}, normalized(Quat{0.8, 0.1, 0.4, -0.2})}),
          system.add_marker(name + ".S", s, {{-0.3, 0.2, 0.1}, normalized(Quat{0.6, -0.3, 0.2, 0.5})}));
    };
    const auto wave = [](auto t) { return 0.3 * sin(2.0 * t) + 0.1 * t; };
    {
      auto [p, s] = pair("weld", one, two);
      p.translation_law = laws::translation([](auto t) { return std::array{0.1 * sin(t), 0.2 * cos(3.0 * t), t * t}; });
      s.rotation_law = laws::axis_rotation({1, 2, -1}, laws::law(wave));
      Lock& weld = system.add<Fixed>("weld", p, s);
      weld.jointed()->move(laws::translation([](auto t) { return std::array{0.2 * t, 0.1 * sin(t), 0.3 * t * t}; }));
      weld.jointed()->turn(laws::axis_rotation({0, 1, 1}, laws::law(wave)));
    }
    {
      auto [p, s] = pair("hinge", two, system.ground());
      system.add<Revolute>("hinge", p, s).jointed()->drive(Axis::rz, laws::law(wave));
    }
    {
      auto [p, s] = pair("cross", one, system.ground());
      system.add<Universal>("cross", p, s);
    }
    {
      auto [p, s] = pair("rod", two, one);
      system.add<Distance>("rod", p, s, laws::law([](auto t) { return 1.5 + 0.2 * sin(2.0 * t); }));
    }
    system.link("rod").set_active_at_start(false);
    system.setup();
  }
  State at(double t) const {
    State state = system.start();
    state.t = 0.7 + t;
    for (int k = 0; k < 2; ++k) state.set_slot_pose(k, course[k].at(t));
    return state;
  }
};

}  // namespace

TEST_CASE("the equations of a joint are the derivatives of its constraints along motions of its bodies",
          "[verification][explain]") {
  Bench bench;
  Dynamics dynamics(bench.system, std::make_unique<SchurSolver>());
  for (const auto& link : bench.system.links()) {
    CAPTURE(link->name());
    const LinkEquations shape = equations_of(dynamics, bench.at(0), *link);
    const auto n = static_cast<Eigen::Index>(shape.slots.size());
    REQUIRE(shape.J.cols() == 6 * n);
    REQUIRE(shape.Cq.cols() == 7 * n);
    VecX v(6 * n), a(6 * n), qd(7 * n), qdd(7 * n);
    State state = bench.at(0);
    for (Eigen::Index i = 0; i < n; ++i) {
      const std::size_t slot = shape.slots[i] == "one" ? 0 : 1;
      const Course& c = bench.course[slot];
      const auto [rate, second] = derivatives([&](double t) { return VecX(c.quaternion(t)); });
      const Mat34 G = G_matrix(c.at(0).q);
      qd.segment<7>(7 * i) << c.v, rate;
      qdd.segment<7>(7 * i) << c.a, second;
      v.segment<6>(6 * i) << c.v, Vec3(G * rate);
      a.segment<6>(6 * i) << c.a, Vec3(G * second);
      state.v.segment<6>(6 * static_cast<Eigen::Index>(slot)) = v.segment<6>(6 * i);
    }
    const LinkEquations e = equations_of(dynamics, state, *link);
    const auto [Cd, Cdd] = derivatives([&](double t) { return equations_of(dynamics, bench.at(t), *link).C; });
    CHECK((e.J * v + e.Ct - Cd).lpNorm<Eigen::Infinity>() < 1e-8);
    CHECK((e.Cq * qd + e.Ct - Cd).lpNorm<Eigen::Infinity>() < 1e-8);
    CHECK((e.J * a - e.Qc - Cdd).lpNorm<Eigen::Infinity>() < 1e-6);
    CHECK((e.Cq * qdd - e.Qc - Cdd).lpNorm<Eigen::Infinity>() < 1e-6);
    CHECK(Cdd.lpNorm<Eigen::Infinity>() > 0.1);
    const auto [still, none] = derivatives([&](double t) {  // time alone
      State frozen = bench.at(0);
      frozen.t += t;
      return equations_of(dynamics, frozen, *link).C;
    });
    CHECK((e.Ct - still).lpNorm<Eigen::Infinity>() < 1e-8);
  }
}

TEST_CASE("the equations of a joint have names: drives, function, and the bodies of their columns",
          "[verification][explain]") {
  Bench bench;
  Dynamics dynamics(bench.system, std::make_unique<SchurSolver>());
  const auto names = [&](const char* link) { return equations_of(dynamics, bench.at(0), bench.system.link(link)); };
  CHECK(names("weld").rows == std::vector<std::string>{"weld.x", "weld.y", "weld.z", "weld.e1", "weld.e2", "weld.e3"});
  CHECK(names("weld").slots == std::vector<std::string>{"one", "two"});
  CHECK(names("hinge").rows ==
        std::vector<std::string>{"hinge.x", "hinge.y", "hinge.z", "hinge.e1", "hinge.e2", "hinge.e3"});
  CHECK(names("hinge").slots == std::vector<std::string>{"two"});
  CHECK(names("rod").C.size() == 1);  // which is not in force
}

TEST_CASE("a merged joint has no equations, which is reported with the next move", "[verification][explain]") {
  System system;
  Body& one = system.add_body("one", MassProperties{2, Vec3::Zero(), Mat3::Identity()});
  Body& two = system.add_body("two", MassProperties{3, Vec3::Zero(), Mat3::Identity()});
  system.add<Revolute>("hinge", one, system.ground(), pose_at({0, 0, 0}));
  system.add<Fixed>("weld", two, one, pose_at({1, 0, 0}));
  system.set_merge(true);
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  const State start = system.start();
  REQUIRE(system.merged(system.link("weld")));
  const std::string said = testing::message_of<ModelError>([&] { equations_of(dynamics, start, system.link("weld")); });
  CHECK(said.find("joint 'weld' is merged") != std::string::npos);
  CHECK(said.find("\"merge\"") != std::string::npos);
  CHECK(equations_of(dynamics, start, system.link("hinge")).slots == std::vector<std::string>{"one + two"});
}

}  // namespace link_equations_test
