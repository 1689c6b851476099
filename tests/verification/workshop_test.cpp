// SPDX-License-Identifier: BSD-3-Clause
// Mechanisms of the workshop, samples/scenes, against closed forms: Jansen's leg, a quick return, a scissor lift,
// an engine.
#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/math.h>
#include <lockstep/scene.h>
#include <lockstep/splines.h>
#include "tests/support/catch.h"
#include "tests/support/run_scene.h"
#include "tests/support/scene_folder.h"

namespace workshop_test {

using namespace lockstep;
using lockstep::testing::builtin;
using Plane = std::complex<double>;

namespace {

Table ran(const std::string& scene, const std::vector<std::string>& set = {}) {
  return run_scene(scene_path(scene), {}, [&](Scene& s) { s = set_in_scene(s, set, builtin()); }).table;
}

// A + r e^{i (arg(B - A) +- alpha)}, with the angle at A by the law of cosines; side 1: left of the line from A to B.
Plane apex(Plane A, double r, Plane B, double s, double side) {
  const double d = std::abs(B - A), alpha = std::acos((r * r + d * d - s * s) / (2 * r * d));
  return A + std::polar(r, std::arg(B - A) + side * alpha);
}

// The left foot of the leg by its crank angle, with the lengths of T. Jansen, "The Great Pretender" (010 Publishers 2007).
Plane foot(double theta) {
  const double a = 0.38, b = 0.415, c = 0.393, d = 0.401, e = 0.558, f = 0.394, g = 0.367, h = 0.657, i = 0.49, j = 0.5,
               k = 0.619, l = 0.078, m = 0.15;
  const Plane M = std::polar(m, theta), P(-a, -l);
  const Plane J = apex(M, j, P, b, -1), K = apex(P, d, J, e, 1), L = apex(M, k, P, c, 1), N = apex(K, f, L, g, -1);
  return apex(N, h, L, i, -1);
}

}  // namespace

TEST_CASE("Jansen's leg: the paths of both feet are those of circles that meet", "[verification][scene]") {
  const Table t = ran("jansen_leg");
  REQUIRE(t.n_rows() == 73);
  double x_error = 0, y_error = 0, right = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    const Plane left = foot(t["crank"][i]), mirrored = foot(kPi - t["crank"][i]);
    x_error = std::max(x_error, std::abs(t["x"][i] - left.real()));
    y_error = std::max(y_error, std::abs(t["y"][i] - left.imag()));
    right =
        std::max(right, std::abs(Plane(t["x_right"][i], t["y_right"][i]) - Plane(-mirrored.real(), mirrored.imag())));
  }
  CHECK(x_error < 1e-9);
  CHECK(y_error < 1e-9);
  CHECK(right < 1e-9);
}

TEST_CASE("Jansen's leg: step and lift are the extremes of its path, and the step is flat", "[verification][scene]") {
  const Table t = ran("jansen_leg");
  std::vector<double> x, y;
  constexpr int kMany = 20'000;
  for (int i = 0; i < kMany; ++i)
    x.push_back(foot(kTwoPi * i / kMany).real()), y.push_back(foot(kTwoPi * i / kMany).imag());
  const auto range = [](const std::vector<double>& v) {
    return *std::ranges::max_element(v) - *std::ranges::min_element(v);
  };
  CHECK(std::abs(t["step"].back() - range(x)) < 1e-6 * range(x));
  CHECK(std::abs(t["lift"].back() - range(y)) < 1e-6 * range(y));
}

TEST_CASE("quick return: lever and ram follow the closed form", "[verification][scene]") {
  const double r = 0.15, c = 0.4, lever = 0.7, rod = 0.25, phi = std::asin(r / c),
               rail = lever * (1 + std::cos(phi)) / 2;
  const Table t = ran("quick_return");
  REQUIRE(t.n_rows() == 73);
  const auto ram = [&](double crank) {  // measured from the right end
    const double alpha = crank - phi, theta = std::atan2(r * std::cos(alpha), c + r * std::sin(alpha));
    const double drop = rail - lever * std::cos(theta);
    return std::pair(phi - theta, lever * std::sin(theta) + std::sqrt(rod * rod - drop * drop));
  };
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    const auto [turned, x] = ram(t["crank"][i]);
    CAPTURE(i);
    CHECK(std::abs(t["lever"][i] - turned) < 1e-9);
    CHECK(std::abs(t["x"][i] - x) < 1e-9);
  }
  // both ends of the lever are equally high
  CHECK(std::abs(t["stroke"].back() - 2 * lever * std::sin(phi)) < 1e-6 * t["stroke"].back());
}

TEST_CASE("quick return: the strokes take times in the ratio of the angles of the crank", "[verification][scene]") {
  for (const double r : {0.1, 0.15, 0.2}) {
    const double phi = std::asin(r / 0.4), ratio = (kPi + 2 * phi) / (kPi - 2 * phi), cut = ratio / (1 + ratio);
    const Table t = ran("quick_return", {"crank=" + std::to_string(r) + " m", "run.until=" + std::to_string(cut)});
    CAPTURE(r, ratio);
    // the written time has six digits, and the ram's acceleration is some metres per second squared
    CHECK(std::abs(t["v"].back()) < 1e-4);
    CHECK(std::abs(t["x"].front() - t["x"].back() - 2 * 0.7 * std::sin(phi)) < 1e-9);
    CHECK(*std::ranges::max_element(t["v"]) < 1e-4);  // no return before
  }
}

TEST_CASE("scissor lift: the actuator's force at rest is that of virtual work", "[verification][scene]") {
  for (const int n : {1, 2, 3, 5})
    for (const double degrees : {10.0, 15.0, 45.0}) {
      const Table t = ran("scissor_lift",
                          {"stages=" + std::to_string(n), "angle=" + std::to_string(degrees) + " deg", "run.until=0"});
      // F dw + (load n + 2 arm (1/2 + 3/2 + ... + (n - 1/2))) g dh = 0, w = L cos, h = L sin: the sum is n^2/2
      const double force = -(300 * n + 8 * n * n) * 9.81 / std::tan(degrees / 180 * kPi);
      CAPTURE(n, degrees, force);
      CHECK(std::abs(t["force"][0] - force) < 1e-9 * std::abs(force));
      CHECK(std::abs(t["at_rest"][0] - force) < 1e-9 * std::abs(force));
      CHECK(std::abs(t["height"][0] - n * 1.2 * std::sin(degrees / 180 * kPi)) < 1e-12);
    }
}

TEST_CASE("scissor lift: force and work of the motion are those of Lagrange's equation", "[verification][scene]") {
  const double L = 1.2, m = 8, W = 300, g = 9.81, T = 6, begin = 15 * kPi / 180, end = 50 * kPi / 180;
  const int n = 3;
  const double I = m * (L * L / 12 + (L / 50) * (L / 50) / 4);  // a rod is a cylinder of radius length/50
  double squares = 0;                                           // of (i + 1/2)
  for (int i = 0; i < n; ++i) squares += (i + 0.5) * (i + 0.5);
  const Table t = ran("scissor_lift");
  REQUIRE(t.n_rows() == 61);
  double work = 0, largest = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    const double u = t["t"][i] / T, rise = L * (std::cos(end) - std::cos(begin));
    const double w = L * std::cos(begin) + rise * (u - std::sin(kTwoPi * u) / kTwoPi),
                 w_d = rise * (1 - std::cos(kTwoPi * u)) / T, w_dd = rise * kTwoPi * std::sin(kTwoPi * u) / (T * T);
    // w = L cos(q)
    const double q = std::acos(w / L), s = std::sin(q), c = std::cos(q), q_d = -w_d / (L * s),
                 q_dd = -(w_dd + L * c * q_d * q_d) / (L * s);
    // kinetic energy M(q) q_d^2/2, potential energy V(q)
    const double M = 2 * n * (m * L * L * s * s / 4 + I) + (2 * m * squares + W * n * n) * L * L * c * c,
                 M_q = (2 * n * m * L * L / 4 - (2 * m * squares + W * n * n) * L * L) * 2 * s * c,
                 V_q = (W * n + m * n * n) * g * L * c, V = (W * n + m * n * n) * g * L * s;
    const double force = -(M * q_dd + M_q * q_d * q_d / 2 + V_q) / (L * s);
    CAPTURE(i, force);
    CHECK(std::abs(t["force"][i] - force) < 1e-8 * std::abs(force));
    if (i == 0) work = -V;
    largest = std::max(largest, std::abs(t["work"][i] - (V + M * q_d * q_d / 2 + work)));
  }
  CHECK(largest < 1e-8 * std::abs(t["work"].back()));
}

// 1/2 I(theta) theta'^2 = E, E' = (T(theta) - c theta') theta', by Runge-Kutta of order four with I and T in closed form.
TEST_CASE("two-cylinder engine: its speed is that of one equation of motion", "[verification][scene]") {
  constexpr double r = 0.04, l = 0.13, area = 50e-4, ambient = 1e5, J = 0.3, c = 0.3, m_rod = 0.5, m_piston = 0.4;
  const Table t = ran("two_cylinder_engine");
  REQUIRE(t.n_rows() == 12 * 72 + 1);
  const double bar[][2] = {{0, 38},    {15, 48},   {30, 36},    {60, 14},    {100, 5.5},  {140, 3.2},
                           {180, 1.6}, {220, 1.1}, {360, 1.05}, {400, 0.95}, {540, 0.95}, {600, 1.6},
                           {640, 3.4}, {670, 8},   {700, 21},   {720, 38}};
  SplinePoints points;
  for (const auto& [deg, p] : bar) points.emplace_back(deg * kPi / 180, p * 1e5);
  const LawPtr<MotionLaw> gas = laws::spline(points, {.ends = SplineEnds::periodic, .outside = SplineOutside::repeat});
  struct At {
    double inertia, torque;
  };
  const auto at = [&](double theta) {
    const double s = r * std::sin(theta), q = std::sqrt(l * l - s * s), y = r * std::cos(theta);
    const double piston = -s - s * y / q, turn = -y / q, rod_x = (-s + piston) / 2, rod_y = y / 2;  // by theta
    const double one = m_piston * piston * piston + m_rod * (rod_x * rod_x + rod_y * rod_y + l * l / 12 * turn * turn);
    const double p = gas->at(theta).y + gas->at(theta + kTwoPi).y - 2 * ambient;
    return At{J + 2 * one, -area * p * piston};
  };
  double theta = 0, w = 1500.0 / 60 * kTwoPi, E = 0.5 * at(0).inertia * w * w, most = 0, least = 1e9, sum = 0;
  const auto rate = [&](double angle, double energy) {
    const At a = at(angle);
    const double speed = std::sqrt(2 * energy / a.inertia);
    return std::pair(speed, (a.torque - c * speed) * speed);
  };
  constexpr int kParts = 40;
  const double h = t["t"][1] / kParts;
  double error = 0;
  for (std::size_t row = 1; row < t.n_rows(); ++row) {
    for (int k = 0; k < kParts; ++k) {
      const auto a = rate(theta, E), b = rate(theta + h / 2 * a.first, E + h / 2 * a.second),
                 d = rate(theta + h / 2 * b.first, E + h / 2 * b.second),
                 e = rate(theta + h * d.first, E + h * d.second);
      theta += h / 6 * (a.first + 2 * b.first + 2 * d.first + e.first);
      E += h / 6 * (a.second + 2 * b.second + 2 * d.second + e.second);
      w = rate(theta, E).first;
      if (row > 10 * 72) most = std::max(most, w), least = std::min(least, w), sum += w;
    }
    error = std::max(error, std::abs(t["speed"][row] - w));
  }
  CHECK(error < 1e-4);
  const double mean = sum / (2 * 72 * kParts);
  CHECK(t["mean"].back() == Approx(mean).epsilon(1e-4));
  CHECK(t["fluctuation"].back() == Approx((most - least) / mean).epsilon(1e-3));
  CHECK(mean == Approx(1500.0 / 60 * kTwoPi).epsilon(0.05));  // it runs, and the brake holds it
}

}  // namespace workshop_test
