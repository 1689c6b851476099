// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/import/urdf.h"

#include <lockstep/author/registry.h>
#include <lockstep/scene.h>
#include "framework/description/scene/json.h"
#include "tests/fuzz/answered.h"
#include "tests/fuzz/targets.h"

namespace lockstep::fuzz {

namespace {

const Registry& types_for_robots() {
  static const Registry registry = builtin_registry();
  return registry;
}

}  // namespace

void urdf(Bytes bytes) {
  for (const bool floating : {false, true})
    answered([&] {
      const ImportedRobot robot = read_urdf(text_of(bytes), "fuzz.urdf", floating);
      const Scene scene = scene_from_text(write_json(robot.scene), "fuzz.json");
      const State start = build_mechanism(scene, types_for_robots()).system.start();
      for (Eigen::Index i = 0; i < start.q.size(); ++i) must_be_finite(start.q[i], "a coordinate of a robot");
    });
}

}  // namespace lockstep::fuzz
