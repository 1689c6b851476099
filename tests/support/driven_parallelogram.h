// SPDX-License-Identifier: BSD-3-Clause
// A planar parallelogram whose crank a law drives, as a scene gives it.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <string>

namespace lockstep::testing {

/// Cranks of 0.1 m and 0.5 kg at the origin and at (0.3, 0), turned by `angle`, rad; a coupler of 0.3 m and 1.2 kg; hinges A,
/// B, C, D. `law` drives A. `run`: members of the scene's "run".
inline std::string driven_parallelogram(double angle, const std::string& law, const std::string& run) {
  const double x = 0.1 * std::cos(angle), y = 0.1 * std::sin(angle);
  const auto rod = [](const char* name, double mass, double x0, double y0, double x1, double y1) {
    return fmt::format(
        R"({{"name": "{}", "rod": {{"mass": {}, "from": [{:.17g}, {:.17g}, 0], "to": [{:.17g}, {:.17g}, 0],
      "axial_inertia": 1e-4}}}})",
        name, mass, x0, y0, x1, y1);
  };
  const auto hinge = [](const char* name, const char* p, const char* s, double x0, double y0, const std::string& more) {
    return fmt::format(R"({{"name": "{}", "type": "revolute", "p": "{}", "s": "{}", "at": [{:.17g}, {:.17g}, 0]{}}})",
                       name, p, s, x0, y0, more);
  };
  return R"({"lockstep": 1, "gravity": [0, -9.81, 0], "bodies": [)" + rod("crank", 0.5, 0, 0, x, y) + ", " +
         rod("coupler", 1.2, x, y, x + 0.3, y) + ", " + rod("rocker", 0.5, 0.3, 0, x + 0.3, y) + R"(], "links": [)" +
         hinge("A", "crank", "ground", 0, 0, R"(, "drive": {"axis": "rz", "law": )" + law + "}") + ", " +
         hinge("B", "coupler", "crank", x, y, "") + ", " + hinge("C", "rocker", "coupler", x + 0.3, y, "") + ", " +
         hinge("D", "rocker", "ground", 0.3, 0, "") + R"(], "run": {)" + run + "}}";
}

}  // namespace lockstep::testing
