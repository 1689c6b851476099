// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/solid.h>
#include "tests/fuzz/answered.h"
#include "tests/fuzz/scratch_file.h"
#include "tests/fuzz/targets.h"

namespace lockstep::fuzz {

void mesh(Bytes bytes) {
  for (const char* const ending : {".stl", ".obj"}) {
    const std::string file = scratch_file(bytes, ending);
    answered([&] {
      const TriangleMesh read = read_mesh(file);
      if (read.triangles.empty()) throw Broken{"a mesh without a triangle"};
      for (const auto& point : read.points)
        for (const float x : point) must_be_finite(x, "a point of a mesh");
      for (const auto& triangle : read.triangles)
        for (const std::uint32_t corner : triangle)
          if (corner >= read.points.size()) throw Broken{"a corner that is no point of its mesh"};
    });
  }
}

}  // namespace lockstep::fuzz
