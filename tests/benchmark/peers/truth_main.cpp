// SPDX-License-Identifier: BSD-3-Clause
// truth FOLDER [NAME...]: computes the truths and keeps them there, says how well each is known, and fails when one is
// not known to 1e-10 m or disagrees with a trusted csv or with a second model.
#include <cmath>
#include <cstdio>
#include <vector>

#include <Eigen/Dense>

#include "tests/benchmark/peers/extrapolate.h"
#include "tests/benchmark/peers/truth.h"

using namespace lockstep;
using namespace lockstep::peers;

namespace {

bool fits(const std::string& what, double distance, double limit = 1e-10) {
  std::printf("%-58s %.1e m%s\n", what.c_str(), distance, distance <= limit ? "" : "  TOO FAR");
  return distance <= limit;
}

/// The planar chain again, by another model: angles against the x axis, dense mass matrix
/// M_ij = m_ij cos(u_i - u_j), m_ij = n - 1 - max(i, j) + (1/2, or 1/3 for i = j); at the end of the run.
Positions dense_chain(int n, int steps) {
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  const auto rate = [n](const RealVector& u, RealVector& du) {
    Matrix M(n, n);
    Vector f(n);
    const auto at = [&](int i) { return u[i]; };
    for (int i = 0; i < n; ++i) {
      f[i] = -9.81L * std::cos(at(i)) * (n - 1 - i + 0.5L);
      for (int j = 0; j < n; ++j) {
        const Real m = Real(n - 1 - std::max(i, j)) + (i == j ? 1.0L / 3 : 0.5L);
        M(i, j) = m * std::cos(at(i) - at(j));
        f[i] -= m * std::sin(at(i) - at(j)) * at(n + j) * at(n + j);
      }
    }
    const Vector a = M.ldlt().solve(f);
    for (int i = 0; i < n; ++i) {
      du[i] = at(n + i);
      du[n + i] = a[i];
    }
  };
  RealVector u(static_cast<std::size_t>(2 * n), 0);
  extrapolate(rate, u, 1, steps);
  Positions centres;
  Vec3 joint = Vec3::Zero();
  for (int i = 0; i < n; ++i) {
    const double angle = static_cast<double>(u[i]);
    const Vec3 d{std::cos(angle), std::sin(angle), 0};
    centres.push_back(joint + d / 2);
    joint += d;
  }
  return centres;
}

/// A trusted csv, where one is there: its row of the end of our run against one point of ours.
bool fits_file(const std::string& name, double t, const std::vector<std::string>& columns, const Vec3& point) {
  std::map<std::string, std::vector<double>> file;
  try {
    file = read_columns(data_file(name));
  } catch (const std::exception&) {
    std::printf("%-58s not there\n", (name + ".csv").c_str());
    return true;
  }
  for (std::size_t row = 0; row < file.at("t").size(); ++row) {
    if (std::abs(file.at("t")[row] - t) > 1e-9) continue;
    Vec3 trusted = point;
    for (std::size_t i = 0; i < columns.size(); ++i) trusted[static_cast<int>(i)] = file.at(columns[i])[row];
    return fits("  against " + name + ".csv at its end", (trusted - point).norm());
  }
  return false;
}

bool fits_second(const Mechanism& m, const History& truth) {
  const Positions& end = truth.back();
  if (m.name == "pendulum") return fits_file("rod_pendulum", 10, {"xc", "yc"}, end[0]);
  if (m.name == "chain-10")
    return fits_file("chain_10", 1, {"tipx", "tipy"},
                     [&] {
                       Vec3 joint =
                           Vec3::Zero();  // the tip: every rod ends as far beyond its centre as it began before it
                       for (const Vec3& x : end) joint = 2 * x - joint;
                       return joint;
                     }()) &&
           fits("  against a dense model", largest_distance(end, dense_chain(10, 100)));
  if (m.name == "chain-100") return fits("  against a dense model", largest_distance(end, dense_chain(100, 60)));
  if (m.name == "heavy-top") return fits_file("heavy_top", 1, {"xc", "yc", "zc"}, end[0]);
  if (m.kind == Kind::four_bars) return fits_file("nfourbar_" + std::to_string(m.n), 10, {"B0x", "B0y"}, 2 * end[0]);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: %s FOLDER [NAME...]\n", argv[0]), 2;
  Truths truths(argv[1]);
  bool good = true;
  for (const Mechanism& m : all_mechanisms()) {
    bool wanted = argc == 2;
    for (int i = 2; i < argc; ++i) wanted |= m.name == argv[i];
    if (!wanted) continue;
    const History& truth = truths.of(m);
    History even;
    for (std::size_t i = 0; i < truth.size(); i += 2) even.push_back(truth[i]);
    good &= fits(m.name + ": moves with steps twice as long by",
                 largest_distance(compute_truth(m, truth_steps(m), 2), even));
    good &= fits_second(m, truth);
  }
  return good ? 0 : 1;
}
