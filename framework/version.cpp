#include <lockstep/version.h>

namespace lockstep {

const char* library_version() { return kVersion; }

}  // namespace lockstep
