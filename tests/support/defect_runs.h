// SPDX-License-Identifier: BSD-3-Clause
// Runs of the scenes of tests/verification/defects by the program.
#pragma once

#include <string>

#include <lockstep/recorder.h>
#include "tests/support/open_defect.h"
#include "tests/support/program.h"

namespace lockstep::testing {

inline std::string quoted(const std::string& path) { return "'" + path + "'"; }
inline std::string defect(const std::string& name) { return quoted(defect_scene(name)); }
inline Table table_of(const std::string& csv) { return read_csv(kRunnerFolder + "/" + csv + ".csv"); }

/// `run` of a scene, with these words; the table has the name.
inline Called run_named(const std::string& scene, const std::string& name, const std::string& words = {}) {
  return call("run " + scene + " --no-picture --record " + name + ".csv " + words);
}

}  // namespace lockstep::testing
