// SPDX-License-Identifier: BSD-3-Clause
// Which random mechanisms are tried: [from, to), by LOCKSTEP_SEEDS="FROM:TO".
#pragma once

#include <cstdio>
#include <cstdlib>

#include "tests/support/catch.h"

namespace lockstep::differential {

struct Seeds {
  unsigned from = 1, to;
};

/// From 1 to `to`, unless LOCKSTEP_SEEDS gives others.
inline Seeds seeds_up_to(unsigned to) {
  Seeds s{.to = to};
  if (const char* given = std::getenv("LOCKSTEP_SEEDS"); given && std::sscanf(given, "%u:%u", &s.from, &s.to) != 2)
    FAIL("LOCKSTEP_SEEDS is \"FROM:TO\", not \"" << given << '"');
  return s;
}

}  // namespace lockstep::differential
