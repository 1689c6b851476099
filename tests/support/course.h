// SPDX-License-Identifier: BSD-3-Clause
// Error of a method on a reference mechanism: against the step, and against the tolerance.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/paths.h"
#include "tests/support/run_with_registry.h"

namespace lockstep::test {

/// A scene with a trusted csv of the same name.
struct Course {
  std::string scene;
  double end;  ///< s; a row of the csv
  std::vector<std::string> columns;
};

inline const Course kTopCourse{"heavy_top", 0.2, {"xc", "yc", "zc", "qw", "qx", "qy", "qz", "Wx", "Wz"}};
inline const Course kDoublePendulumCourse{"double_pendulum", 1, {"q1", "q2", "q1_d", "q2_d"}};

/// Length of all columns' errors, the largest over all rows up to the end.
inline double error_on(const Course& course, const Registry& registry,
                       const std::function<void(RunSettings&)>& change) {
  const SceneRun run =
      run_with_registry(registry, std::string(paths::kScenes) + "/" + course.scene + ".json", [&](RunSettings& s) {
        s.until = course.end;
        change(s);
      });
  const Table truth = read_csv(std::string(paths::kSource) + "/tests/verification/data/" + course.scene + ".csv");
  double worst = 0;
  std::size_t row = 0;
  for (std::size_t i = 0; i < run.table.n_rows(); ++i) {
    while (row < truth.n_rows() && truth["t"][row] < run.table["t"][i] - 1e-9) ++row;
    if (row == truth.n_rows() || std::abs(truth["t"][row] - run.table["t"][i]) > 1e-9) continue;
    double error = 0;
    for (const std::string& c : course.columns) error = std::hypot(error, run.table[c][i] - truth[c][row]);
    if (!(error <= worst)) worst = error;  // a NaN stays
  }
  return worst;
}

/// Slope of the line through the points (log x, log y).
inline double slope(const std::vector<double>& x, const std::vector<double>& y) {
  const double n = static_cast<double>(x.size());
  double mx = 0, my = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) mx += std::log(x[i]) / n, my += std::log(y[i]) / n;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (std::log(x[i]) - mx) * (std::log(x[i]) - mx);
    xy += (std::log(x[i]) - mx) * (std::log(y[i]) - my);
  }
  return xy / xx;
}

}  // namespace lockstep::test
