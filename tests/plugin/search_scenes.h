// SPDX-License-Identifier: BSD-3-Clause
// Scenes of which searches and sensitivities are tested.
#pragma once

#include <string>

#include "tests/support/program.h"

namespace search_scenes {

using lockstep::testing::scene_file;

// A point mass m = 2 kg at r = 0.3 m, driven at constant speed; with gravity its pin carries m r w^2 + m g at the bottom.
// Rows are a third of a revolution apart, so that they miss the bottom.
inline std::string rotor() {
  return scene_file("rotor", R"--(
  "parameters": {"speed": "10 rad/s", "r": "300 mm"}, "gravity": [0, -9.81, 0],
  "bodies": [{"name": "mass", "mass": 2, "inertia": [0.01, 0.01, 0.01], "position": ["=r", 0, 0]}],
  "joints": [{"name": "A", "type": "revolute", "p": "mass", "s": "ground", "at": [0, 0, 0],
              "drive": {"axis": "rz", "law": {"type": "ramp", "slope": "=speed"}}}],
  "run": {"until": 2, "output": 0.23, "tolerance": 1e-9,
          "record": [{"F": "=norm(A.force_on_p_world)"}, {"phi": "A.rz"}]
})--");
}

// A particle that is still at 0 m, with the speed L/(1 s) for 1 s; formulas of parameters alone need no motion.
inline std::string formulas() {
  return scene_file("formulas", R"--(
  "parameters": {"p": 0.5, "q": 0.5, "L": "1 m", "u": "2 m/s"}, "gravity": [0, 0, 0],
  "bodies": [{"name": "b", "particle": 1, "velocity": ["=L/(1 s)", "=u", 0]}],
  "run": {"until": 1, "output": 0.5, "record": [{"x": "b.x"}, {"miss": "=b.y - 2 m"}]}, "require": ["=b.x < 1.5 m", "=p < 0.8"])--");
}

}  // namespace search_scenes
