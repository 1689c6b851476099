// SPDX-License-Identifier: BSD-3-Clause
#include "tests/benchmark/peers/assemblies.h"

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

namespace lockstep::peers {

namespace {

const Vec3 kX = Vec3::UnitX(), kY = Vec3::UnitY(), kZ = Vec3::UnitZ();

/// A point fixed in a planar body at `origin` whose x axis stands at `angle`.
Vec3 planar_point(const Vec3& origin, double angle, double a, double b) {
  return origin + Vec3(a * std::cos(angle) - b * std::sin(angle), a * std::sin(angle) + b * std::cos(angle), 0);
}

// IFToMM A03; the angles are those of its start at beta = -0.062, the loops closed (andrews_a03.csv).
Assembly andrews() {
  const double beta = -0.062, theta = 2.1458685379951532e-04, gamma = 0.45527981210037022, phi = 0.22266837590302747;
  const double delta = 0.48736498114063280, omega = -0.22266837590302747, epsilon = 1.2305474391566008;
  const Vec3 O = Vec3::Zero(), A{-0.06934, -0.00227, 0}, B{-0.03635, 0.03273, 0}, C{0.014, 0.072, 0};
  const Vec3 F = planar_point(O, beta, 0.007, 0), E = planar_point(F, beta + theta, -0.028, 0);
  const Vec3 G = planar_point(A, delta, 0.04, 0), H = planar_point(A, epsilon, 0, -0.04);
  Assembly a;
  const auto add = [&](double mass, double J, const Vec3& origin, double angle, double x, double y) {
    a.bodies.push_back({{mass, {J, J, J}}, planar_point(origin, angle, x, y)});
  };
  add(0.04325, 2.194e-6, O, beta, 0.00092, 0);
  add(0.00365, 4.410e-7, F, beta + theta, -0.0115, 0);
  add(0.02373, 5.255e-6, B, gamma, 0.01043, -0.01874);
  add(0.00706, 5.667e-7, G, phi + delta, 0, -0.00579);
  add(0.07050, 1.169e-5, A, delta, 0.02308, 0.00916);
  add(0.00706, 5.667e-7, H, omega + epsilon, 0.00579, 0);
  add(0.05498, 1.912e-5, A, epsilon, -0.00449, -0.01228);
  a.tree = {{kGroundBody, 0, O, kZ}, {0, 1, F, kZ}, {kGroundBody, 2, B, kZ}, {kGroundBody, 4, A, kZ}, {4, 3, G, kZ},
            {kGroundBody, 6, A, kZ}, {6, 5, H, kZ}};
  a.loops = {{1, 2, E, kZ, true}, {1, 3, E, kZ, true}, {1, 5, E, kZ, true}};
  a.springs = {{2, kGroundBody, planar_point(B, gamma, 0.02, -0.018), C, 4530, 0, 0.07785}};
  a.torque = 0.033;
  return a;
}

// IFToMM A04, square section of 0.1 m.
Assembly bricard() {
  const std::vector<Vec3> P = {{0, 0, 0}, {1, 0, 0}, {1, -1, 0}, {1, -1, 1}, {0, -1, 1}, {0, 0, 1}};
  const std::vector<Vec3> axes = {kY, kZ, kX, kY, kZ, kX};
  const double axial = 0.02 / 12, transverse = 1.01 / 12;
  Assembly a;
  for (int k = 0; k < 5; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const Vec3 d = P[i + 1] - P[i];
    const Vec3 J = Vec3::Constant(transverse) + (axial - transverse) * d.cwiseAbs();
    a.bodies.push_back({{1, J}, (P[i] + P[i + 1]) / 2});
    a.tree.push_back({k - 1, k, P[i], axes[i]});
  }
  a.loops = {{4, kGroundBody, P[5], axes[5]}};
  return a;
}

// IFToMM A05: shaft, slider, two rods of 0.3 kg with 5 kg at their ends.
Assembly flyball() {
  const double alpha = kHalfTurn / 6, c = (0.3 * 0.5 + 5) / 5.3;
  const double J = 0.3 * (1 + 1e-4) / 12 + 0.3 * (c - 0.5) * (c - 0.5) + 5 * (1 - c) * (1 - c);
  const Vec3 top{0, 0, 1};
  Assembly a;
  a.bodies = {{{0.3, {0.3 * (1 + 1e-4) / 12, 0.3 * (1 + 1e-4) / 12, 5e-6}}, {0, 0, 0.5}},
              {{3, {0.005, 0.005, 0.005}}, {0, 0, 0.5}}};
  a.tree = {{kGroundBody, 0, Vec3::Zero(), kZ, false, 2 * kHalfTurn}, {0, 1, {0, 0, 0.5}, kZ, true}};
  for (const double side : {1.0, -1.0}) {
    const Vec3 hinge = top + 0.05 * side * kX, d{side * std::cos(alpha), 0, -std::sin(alpha)};
    Mat3 R;
    R.col(0) = d, R.col(1) = kY, R.col(2) = d.cross(kY);
    a.bodies.push_back({{5.3, {5e-6, J, J}}, hinge + c * d, R});
    const int rod = static_cast<int>(a.bodies.size()) - 1;
    a.tree.push_back({0, rod, hinge, kY});
    a.springs.push_back({rod, 1, hinge + 0.5 * d, Vec3(0.05 * side, 0, 0.5), 8e5, 4e4, 0.5});
  }
  return a;
}

}  // namespace

Assembly assembly_of(const Mechanism& m) {
  switch (m.kind) {
    case Kind::andrews:
      return andrews();
    case Kind::bricard:
      return bricard();
    case Kind::flyball:
      return flyball();
    default:
      throw std::runtime_error(m.name + " is described in mechanisms.h");
  }
}

}  // namespace lockstep::peers
