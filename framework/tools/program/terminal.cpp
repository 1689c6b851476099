#include "framework/tools/program/terminal.h"

#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace lockstep {

const char* error_mark() {
  const auto set = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && *value != 0;
  };
  const char* terminal = std::getenv("TERM");
  const bool coloured =
      isatty(STDERR_FILENO) != 0 && !set("NO_COLOR") && terminal != nullptr && std::string_view(terminal) != "dumb";
  return coloured ? "\033[1;31mlockstep:\033[0m" : "lockstep:";
}

}  // namespace lockstep
