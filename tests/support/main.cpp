#define CATCH_CONFIG_RUNNER  // version 2 puts its implementation here
#include "tests/support/catch.h"

int main(int argc, char* argv[]) { return Catch::Session().run(argc, argv); }
