#include <cstdio>
#include <cstring>

#include "framework/version.h"
#if __has_include("framework/lockstep.h")
#include "framework/lockstep.h"
#endif

int main() {
  std::printf("headers %s, library %s\n", lockstep::kVersion, lockstep::library_version());
  return std::strcmp(lockstep::kVersion, lockstep::library_version()) == 0 ? 0 : 1;
}
