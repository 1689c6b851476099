// SPDX-License-Identifier: BSD-3-Clause
// A four-bar as a scene gives it, with its crank along x and not assembled.
#pragma once

#include <string>

namespace lockstep::testing {

/// More keys of its links, each with a comma before it; whether C closes the loop.
struct FourBarKeys {
  std::string A{}, B{}, D{};
  bool closed = true;
};

/// The scene's "bodies" and "links": crank 0.3 m at the origin, rocker 0.8 m at (1, 0), coupler 0.9 m; hinges A, B, C, D.
inline std::string four_bar(const FourBarKeys& keys) {
  const std::string C = R"({"name": "C", "type": "revolute", "p": "coupler", "s": "rocker",
     "at_p": [1.1, 0.4123105625617661, 0], "at_s": [1.1, 0.7937253933193772, 0]}, )";
  return R"("bodies": [
    {"name": "crank", "rod": {"mass": 1, "from": [0, 0, 0], "to": [0.3, 0, 0]}},
    {"name": "coupler", "rod": {"mass": 1, "from": [0.3, 0, 0], "to": [1.1, 0.4123105625617661, 0]}},
    {"name": "rocker", "rod": {"mass": 1, "from": [1, 0, 0], "to": [1.1, 0.7937253933193772, 0]}}],
  "links": [
    {"name": "A", "type": "revolute", "p": "crank", "s": "ground", "at": [0, 0, 0])" +
         keys.A + R"(},
    {"name": "B", "type": "revolute", "p": "coupler", "s": "crank", "at_p": [0.3, 0, 0], "at_s": [0.3, 0, 0])" +
         keys.B + "}, " + (keys.closed ? C : "") +
         R"({"name": "D", "type": "revolute", "p": "rocker", "s": "ground", "at": [1, 0, 0])" + keys.D + "}]";
}

}  // namespace lockstep::testing
