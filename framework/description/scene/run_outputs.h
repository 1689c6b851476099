// SPDX-License-Identifier: BSD-3-Clause
// The output of a run of a scene besides its numbers: headers, rows at jumps, pictures.
#pragma once

#include <string>
#include <vector>

#include <lockstep/scene.h>

namespace lockstep {

/// A picture of one column against another.
struct PictureRequest {
  std::string x, y;  ///< names of columns; "t": the time
};

/// Keys of "run" that are about its files alone.
struct RunOutputs {
  bool units = true;      ///< the header of the CSV names them
  std::vector<PictureRequest> pictures{};
};

/// Of the object "run" of a scene, which may be null. `record`: what it records. Throws SceneError.
RunOutputs read_outputs(const Value& run, const std::vector<ChannelRequest>& record);
/// Of a scene.
LOCKSTEP_API RunOutputs outputs_of(const Scene&);

}  // namespace lockstep
