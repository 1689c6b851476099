// SPDX-License-Identifier: BSD-3-Clause
// Paths: one quantity against another.
#pragma once

#include <string>
#include <vector>

#include <lockstep/charts.h>

namespace lockstep {

/// A curve y(x) in one pair of axes, in the order of its points, with a mark at its first.
struct PathSpec {
  std::string title, x_label, y_label;
  std::vector<double> x{}, y{};    ///< what is not finite makes a gap
  bool equal_scales = false;       ///< a metre along x is as long as one along y
  int width = 1000, height = 700;  ///< pixels
};

/// Writes `<base>.svg` and `<base>.png` as write_chart does, with the same errors.
LOCKSTEP_API void write_path(const std::string& path, const PathSpec&);

}  // namespace lockstep
