// SPDX-License-Identifier: BSD-3-Clause
#include "samples/shared/output.h"

#include <cstdlib>
#include <filesystem>

#include "samples/shared/paths.h"

namespace lockstep::samples {

std::string output(const std::string& file) {
  const char* asked = std::getenv("LOCKSTEP_OUTPUT");
  const std::filesystem::path folder = asked && *asked ? asked : paths::kOutput;
  std::filesystem::create_directories(folder);
  return (folder / file).string();
}

}  // namespace lockstep::samples
