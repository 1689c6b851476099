// SPDX-License-Identifier: BSD-3-Clause
#define CATCH_CONFIG_RUNNER  // version 2 puts its implementation here
#include "tests/support/catch.h"

int main(int argc, char* argv[]) {
  Catch::Session session;
  session.configData().rngSeed = 1;  // each test case draws the same numbers, whichever ran before it
  return session.run(argc, argv);
}
