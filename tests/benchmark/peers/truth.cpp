// SPDX-License-Identifier: BSD-3-Clause
#include "tests/benchmark/peers/truth.h"

#include <cmath>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>

#include "tests/benchmark/peers/chain_model.h"
#include "tests/benchmark/peers/extrapolate.h"

namespace lockstep::peers {

namespace {

const Real kPiReal = std::acos(-1.0L);

/// From `y` on, `steps` a report; positions at every stride-th report.
History march(const Mechanism& m, RealVector y, int steps, int stride, const RateOf& rate,
              const std::function<Positions(const RealVector&)>& positions) {
  History history;
  for (int i = 0; i <= kReports; i += stride) {
    if (i > 0) extrapolate(rate, y, Real(m.until) * stride / kReports, steps);
    history.push_back(positions(y));
  }
  return history;
}

History chain_history(const Mechanism& m, int steps, int stride) {
  ChainModel model(m);
  return march(
      m, RealVector(static_cast<std::size_t>(2 * m.n), 0), steps, stride,
      [&](const RealVector& y, RealVector& dy) { model.rate(y, dy); },
      [&](const RealVector& y) { return model.positions(y); });
}

// The uprights' angle from x: I theta'' = -W cos(theta), I = (N + 1)/3 + N, W = g ((N + 1)/2 + N).
History four_bars_history(const Mechanism& m, int steps, int stride) {
  const Real n = m.n, I = (n + 1) / 3 + n, W = 9.81L * ((n + 1) / 2 + n);
  return march(
      m, {kPiReal / 2, -1}, steps, stride,
      [=](const RealVector& y, RealVector& dy) {
        dy = {y[1], -W / I * std::cos(y[0])};
      },
      [&](const RealVector& y) {
        const double c = static_cast<double>(std::cos(y[0])), s = static_cast<double>(std::sin(y[0]));
        Positions x;
        for (int k = 0; k <= m.n; ++k) x.emplace_back(k + 0.5 * c, 0.5 * s, 0);
        for (int k = 0; k < m.n; ++k) x.emplace_back(k + 0.5 + c, s, 0);
        return x;
      });
}

History slider_crank_history(const Mechanism& m, int stride) {
  History history;
  for (int i = 0; i <= kReports; i += stride) {
    const Real turn = Real(kCrankSpeed) * Real(m.until) * i / kReports;
    const Real c = 0.15L * std::cos(turn), s = 0.15L * std::sin(turn), rod = std::sqrt(0.35L * 0.35L - s * s);
    const auto at = [](Real x, Real y) { return Vec3(static_cast<double>(x), static_cast<double>(y), 0); };
    history.push_back({at(c / 2, s / 2), at(c + rod / 2, s / 2), at(c + rod, 0)});
  }
  return history;
}

// Euler's equations about the tip: J w' = M - w x J w, with M = (0, 1, 0) x R^T (0, 0, -m g); e' = e (0, w)/2.
History heavy_top_history(const Mechanism& m, int steps, int stride) {
  const Real J1 = 0.234375L + 15, J2 = 0.46875L, J3 = 0.234375L + 15, mg = 15 * 9.81L;
  const auto rate = [=](const RealVector& y, RealVector& dy) {
    const Real e0 = y[0], e1 = y[1], e2 = y[2], e3 = y[3], a = y[4], b = y[5], c = y[6];
    const Real ee = e0 * e0 + e1 * e1 + e2 * e2 + e3 * e3;
    const Real g1 = -mg * 2 * (e1 * e3 - e0 * e2) / ee, g3 = -mg * (1 - 2 * (e1 * e1 + e2 * e2) / ee);
    dy = {(-e1 * a - e2 * b - e3 * c) / 2, (e0 * a + e2 * c - e3 * b) / 2, (e0 * b + e3 * a - e1 * c) / 2,
          (e0 * c + e1 * b - e2 * a) / 2,  (g3 - (J3 - J2) * b * c) / J1,  -(J1 - J3) * c * a / J2,
          (-g1 - (J2 - J1) * a * b) / J3};
  };
  return march(m, {1, 0, 0, 0, 0, 150, -4.61538L}, steps, stride, rate, [](const RealVector& y) {
    const Real e0 = y[0], e1 = y[1], e2 = y[2], e3 = y[3], ee = e0 * e0 + e1 * e1 + e2 * e2 + e3 * e3;
    return Positions{{static_cast<double>(2 * (e1 * e2 - e0 * e3) / ee),
                      static_cast<double>(1 - 2 * (e1 * e1 + e3 * e3) / ee),
                      static_cast<double>(2 * (e2 * e3 + e0 * e1) / ee)}};
  });
}

/// Row by row of a csv whose times contain the reports.
History from_file(const Mechanism& m, const std::string& name, int stride,
                  const std::function<Positions(const std::function<double(const char*)>&)>& positions) {
  const auto columns = read_columns(data_file(name));
  const std::vector<double>& t = columns.at("t");
  History history;
  std::size_t row = 0;
  for (int i = 0; i <= kReports; i += stride) {
    const double wanted = m.until * i / kReports;
    while (row < t.size() && t[row] < wanted - 1e-9 * m.until) ++row;
    if (row == t.size() || std::abs(t[row] - wanted) > 1e-9 * m.until)
      throw std::runtime_error(name + ".csv has no row for t = " + std::to_string(wanted) + " s");
    history.push_back(positions([&](const char* column) { return columns.at(column)[row]; }));
  }
  return history;
}

// Mass centres from the joints' angles; the numbers are those of the IFToMM problem A03.
Positions andrews_positions(const std::function<double(const char*)>& y) {
  const auto along = [](const Vec3& x, double angle, double a, double b) {
    return Vec3(x[0] + a * std::cos(angle) - b * std::sin(angle), x[1] + a * std::sin(angle) + b * std::cos(angle), 0);
  };
  const Vec3 O = Vec3::Zero(), A{-0.06934, -0.00227, 0}, B{-0.03635, 0.03273, 0};
  const double beta = y("beta"), delta = y("delta"), epsilon = y("epsilon");
  const Vec3 F = along(O, beta, 0.007, 0), G = along(A, delta, 0.04, 0), H = along(A, epsilon, 0, -0.04);
  return {along(O, beta, 0.00092, 0),
          along(F, beta + y("theta"), -0.0115, 0),
          along(B, y("gamma"), 0.01043, -0.01874),
          along(G, y("phi") + delta, 0, -0.00579),
          along(A, delta, 0.02308, 0.00916),
          along(H, y("omega") + epsilon, 0.00579, 0),
          along(A, epsilon, -0.00449, -0.01228)};
}

// Rod k is from corner k-1 to corner k; corners 2, 3 and 4 are columns, corner 1 turns about y by a.
Positions bricard_positions(const std::function<double(const char*)>& y) {
  const double a = y("a");
  const std::vector<Vec3> P = {{0, 0, 0},
                               {std::cos(a), 0, -std::sin(a)},
                               {y("P2x"), y("P2y"), y("P2z")},
                               {y("P3x"), y("P3y"), y("P3z")},
                               {y("P4x"), y("P4y"), y("P4z")},
                               {0, 0, 1}};
  Positions x;
  for (std::size_t k = 1; k < P.size(); ++k) x.push_back((P[k - 1] + P[k]) / 2);
  return x;
}

// Shaft, slider, and two rods of 0.3 kg with 5 kg at their ends, hung at 0.05 m from the axis, alpha below the level.
Positions flyball_positions(const std::function<double(const char*)>& y) {
  const double psi = y("psi"), alpha = y("alpha"), centre = (0.3 * 0.5 + 5 * 1.0) / 5.3;
  const double out = 0.05 + centre * std::cos(alpha), up = 1 - centre * std::sin(alpha);
  return {{0, 0, 0.5},
          {0, 0, y("s")},
          {out * std::cos(psi), out * std::sin(psi), up},
          {-out * std::cos(psi), -out * std::sin(psi), up}};
}

}  // namespace

double largest_distance(const Positions& a, const Positions& b) {
  double largest = a.size() == b.size() ? 0.0 : std::nan("");
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) {
    const double d = (a[i] - b[i]).norm();
    if (!(d <= largest)) largest = d;
  }
  return largest;
}

double largest_distance(const History& a, const History& b) {
  double largest = a.size() == b.size() ? 0.0 : std::nan("");
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) {
    const double d = largest_distance(a[i], b[i]);
    if (!(d <= largest)) largest = d;
  }
  return largest;
}

int truth_steps(const Mechanism& m) {
  return m.kind == Kind::heavy_top || m.kind == Kind::four_bars || m.name == "pendulum" ? 4 : 1;
}

History compute_truth(const Mechanism& m, int steps, int stride) {
  switch (m.kind) {
    case Kind::chain:
    case Kind::spatial_chain:
      return chain_history(m, steps, stride);
    case Kind::four_bars:
      return four_bars_history(m, steps, stride);
    case Kind::slider_crank:
      return slider_crank_history(m, stride);
    case Kind::heavy_top:
      return heavy_top_history(m, steps, stride);
    case Kind::andrews:
      return from_file(m, "andrews_a03", stride, andrews_positions);
    case Kind::bricard:
      return from_file(m, "bricard", stride, bricard_positions);
    case Kind::flyball:
      return from_file(m, "flyball", stride, flyball_positions);
  }
  return {};
}

const History& Truths::of(const Mechanism& m) {
  History& history = known_[m.name];
  if (!history.empty()) return history;
  const std::string path = folder_ + "/truth-" + m.name + ".txt";
  History read(kReports + 1, Positions(static_cast<std::size_t>(n_bodies(m))));
  std::ifstream in(path);
  for (Positions& positions : read)
    for (Vec3& x : positions) in >> x[0] >> x[1] >> x[2];
  if (in) return history = std::move(read);
  history = compute_truth(m, truth_steps(m), 1);
  std::ofstream out(path);
  out.precision(17);
  for (const Positions& positions : history)
    for (const Vec3& x : positions) out << x[0] << ' ' << x[1] << ' ' << x[2] << '\n';
  return history;
}

std::map<std::string, std::vector<double>> read_columns(const std::string& path) {
  std::ifstream in(path);
  std::string line, cell;
  if (!std::getline(in, line)) throw std::runtime_error("cannot read " + path);
  std::vector<std::string> names;
  for (std::istringstream cells(line); std::getline(cells, cell, ',');) names.push_back(cell.substr(0, cell.find(' ')));
  std::map<std::string, std::vector<double>> columns;
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    for (std::size_t i = 0; std::getline(cells, cell, ',') && i < names.size(); ++i)
      columns[names[i]].push_back(std::stod(cell));
  }
  return columns;
}

std::string data_file(const std::string& name) { return std::string(LOCKSTEP_PEERS_DATA) + "/" + name + ".csv"; }

// (w^2/2) dI/dtheta + dV/dtheta at theta = 0 (the end of the run), where T = I(theta) w^2/2; by hand: at theta = 0 the
// odd part of I has no slope, and dV = g (r/2 + r/2) dtheta for the crank's and the rod's middle.
double slider_crank_torque() { return kGravity * kCrank; }

}  // namespace lockstep::peers
