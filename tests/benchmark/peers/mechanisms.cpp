// SPDX-License-Identifier: BSD-3-Clause
#include "tests/benchmark/peers/mechanisms.h"

#include <cmath>

#include <lockstep/math.h>

namespace lockstep::peers {

namespace {

const Vec3 kDown{0, -kGravity, 0};

Mat3 turned_about_z(double angle) {
  Mat3 R;
  R << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
  return R;
}

Vec3 point(const BodyMotion& b, const Vec3& local) { return b.x + b.R * local; }

/// Largest of the distances given so far; a NaN stays.
class Largest {
 public:
  void add(const Vec3& a, const Vec3& b) {
    const double d = (a - b).norm();
    if (!(d <= value_)) value_ = d;
  }
  double value() const { return value_; }

 private:
  double value_ = 0;
};

Motions four_bars_start(int n) {
  Motions bodies(static_cast<std::size_t>(2 * n + 1));
  for (int k = 0; k <= n; ++k) {
    BodyMotion& upright = bodies[k];
    upright = {{double(k), 0.5, 0}, turned_about_z(kHalfTurn / 2), {0.5, 0, 0}, {0, 0, -1}};
  }
  for (int k = 0; k < n; ++k) {
    BodyMotion& bar = bodies[n + 1 + k];
    bar.x = {k + 0.5, 1, 0};
    bar.v = {1, 0, 0};
  }
  return bodies;
}

Motions slider_crank_start() {
  Motions bodies(3);
  const double v = kCrankSpeed * kCrank / 2;
  bodies[0].x = {kCrank / 2, 0, 0};
  bodies[0].v = {0, v, 0};
  bodies[0].w = {0, 0, kCrankSpeed};
  bodies[1].x = {kCrank + kRod / 2, 0, 0};
  bodies[1].v = {0, v, 0};
  bodies[1].w = {0, 0, -kCrankSpeed * kCrank / kRod};
  bodies[2].x = {kCrank + kRod, 0, 0};
  return bodies;
}

}  // namespace

Mechanism pendulum() { return {"pendulum", Kind::chain, 1, 10, kDown}; }
Mechanism chain(int n) { return {"chain-" + std::to_string(n), Kind::chain, n, 1, kDown}; }
Mechanism spatial_chain(int n) {
  return {"spatial-chain-" + std::to_string(n), Kind::spatial_chain, n, 1, {0, -0.8 * kGravity, -0.6 * kGravity}};
}
Mechanism four_bars(int n) { return {"nfourbar-" + std::to_string(n), Kind::four_bars, n, 10, kDown}; }
Mechanism slider_crank() { return {"slider-crank", Kind::slider_crank, 1, 1, kDown}; }
Mechanism heavy_top() { return {"heavy-top", Kind::heavy_top, 1, 1, {0, 0, -kGravity}}; }

const std::vector<Mechanism>& all_mechanisms() {
  static const std::vector<Mechanism> all = {pendulum(),
                                             chain(1),
                                             chain(10),
                                             spatial_chain(10),
                                             heavy_top(),
                                             slider_crank(),
                                             four_bars(2),
                                             {"andrews", Kind::andrews, 1, 0.05, Vec3::Zero()},
                                             {"bricard", Kind::bricard, 1, 10, kDown},
                                             {"flyball", Kind::flyball, 1, 10, {0, 0, -kGravity}},
                                             four_bars(40),
                                             chain(100),
                                             spatial_chain(100),
                                             chain(1000),
                                             spatial_chain(1000)};
  return all;
}

bool is_described(const Mechanism& m) {
  return m.kind != Kind::andrews && m.kind != Kind::bricard && m.kind != Kind::flyball;
}

bool has_loops(const Mechanism& m) {
  return m.kind == Kind::four_bars || m.kind == Kind::slider_crank || m.kind == Kind::andrews ||
         m.kind == Kind::bricard;
}

int n_bodies(const Mechanism& m) {
  switch (m.kind) {
    case Kind::chain:
    case Kind::spatial_chain:
      return m.n;
    case Kind::four_bars:
      return 2 * m.n + 1;
    case Kind::slider_crank:
      return 3;
    case Kind::heavy_top:
      return 1;
    case Kind::andrews:
      return 7;
    case Kind::bricard:
      return 5;
    case Kind::flyball:
      return 4;
  }
  return 0;
}

bool turns_about_y(const Mechanism& m, int k) { return m.kind == Kind::spatial_chain && k % 2 == 1; }

Mass mass_of(const Mechanism& m, int body) {
  if (m.kind == Kind::heavy_top) return {15, {0.234375, 0.46875, 0.234375}};
  if (m.kind != Kind::slider_crank) return {1, {1e-2, 1.0 / 12, 1.0 / 12}};
  const double L = 2 * half_length(m, body), J = body == 2 ? 1e-3 : L * L / 12;
  return {1, {1e-4, J, J}};
}

double half_length(const Mechanism& m, int body) {
  if (m.kind != Kind::slider_crank) return 0.5;
  return body == 0 ? kCrank / 2 : body == 1 ? kRod / 2 : 0;
}

Motions start_of(const Mechanism& m) {
  if (m.kind == Kind::four_bars) return four_bars_start(m.n);
  if (m.kind == Kind::slider_crank) return slider_crank_start();
  Motions bodies(static_cast<std::size_t>(n_bodies(m)));
  if (m.kind == Kind::heavy_top) {
    bodies[0].x = {0, 1, 0};
    bodies[0].w = kTopSpin;
    bodies[0].v = cross(kTopSpin, bodies[0].x);
  } else {
    for (std::size_t k = 0; k < bodies.size(); ++k) bodies[k].x = {double(k) + 0.5, 0, 0};
  }
  return bodies;
}

// T = sum (m v^2 + w J w)/2
double kinetic_energy(const Mechanism& m, const Motions& bodies) {
  double T = 0;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const Mass mass = mass_of(m, static_cast<int>(k));
    const Vec3 w = bodies[k].R.transpose() * bodies[k].w;
    T += 0.5 * mass.mass * bodies[k].v.squaredNorm() + 0.5 * w.dot(mass.J.cwiseProduct(w));
  }
  return T;
}

// V = -sum m g x
double potential_energy(const Mechanism& m, const Motions& bodies) {
  double V = 0;
  for (std::size_t k = 0; k < bodies.size(); ++k)
    V -= mass_of(m, static_cast<int>(k)).mass * m.gravity.dot(bodies[k].x);
  return V;
}

double largest_gap(const Mechanism& m, const Motions& bodies) {
  Largest gap;
  const auto end = [&](int k, double side) { return point(bodies[k], {side * half_length(m, k), 0, 0}); };
  if (m.kind == Kind::chain || m.kind == Kind::spatial_chain) {
    for (int k = 0; k < m.n; ++k) gap.add(end(k, -1), k > 0 ? end(k - 1, 1) : Vec3::Zero());
  } else if (m.kind == Kind::four_bars) {
    for (int k = 0; k <= m.n; ++k) {
      gap.add(end(k, -1), {double(k), 0, 0});
      if (k < m.n) gap.add(end(k, 1), end(m.n + 1 + k, -1));
      if (k > 0) gap.add(end(k, 1), end(m.n + k, 1));
    }
  } else if (m.kind == Kind::slider_crank) {
    gap.add(end(0, -1), Vec3::Zero());
    gap.add(end(0, 1), end(1, -1));
    gap.add(end(1, 1), bodies[2].x);
    gap.add({bodies[2].x[0], 0, 0}, bodies[2].x);
  } else if (m.kind == Kind::heavy_top) {
    gap.add(point(bodies[0], {0, -1, 0}), Vec3::Zero());
  }
  return gap.value();
}

}  // namespace lockstep::peers
