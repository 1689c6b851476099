// SPDX-License-Identifier: BSD-3-Clause
// For tests that look at pictures.
#pragma once

#include "framework/tools/charts/gnuplot.h"
#include "tests/support/catch.h"

namespace lockstep::testing {

/// Fails the test where gnuplot is not installed.
inline void require_gnuplot() {
  INFO("gnuplot draws it, and tests/run installs that (Debian: gnuplot-nox)");
  REQUIRE(!find_gnuplot().empty());
}

}  // namespace lockstep::testing
