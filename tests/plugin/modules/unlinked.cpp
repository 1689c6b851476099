// SPDX-License-Identifier: BSD-3-Clause
// A plugin that needs what no lockstep has.
#include <lockstep/author/plugin.h>

namespace lockstep {
LOCKSTEP_API double gone_since(const std::string& version);
}

LOCKSTEP_PLUGIN(registry) {
  if (lockstep::gone_since("0.0") > 0) registry.laws.set_origin("");
}
