// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/terminal.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "framework/foundation/support/lines.h"

namespace lockstep {

void tell(std::string_view words) {
  std::fwrite(words.data(), 1, words.size(), stderr);
  std::fflush(stderr);
}

const char* error_mark() {
  const auto set = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && *value != 0;
  };
  const char* terminal = std::getenv("TERM");
  const bool coloured =
      isatty(STDERR_FILENO) != 0 && !set("NO_COLOR") && terminal != nullptr && std::string_view(terminal) != "dumb";
  return coloured ? "\033[1;31merror:\033[0m" : "error:";
}

std::string in_lines(const Error& error) {
  std::string words = error.what();
  const Error::Kind kind = error.kind();
  const bool of_motion = kind == Error::Kind::assembly || kind == Error::Kind::solve || kind == Error::Kind::step ||
                         kind == Error::Kind::non_finite;
  if (const std::size_t at = words.find("; "); of_motion && at < words.find('\n')) words.replace(at, 2, "\n  hint: ");
  if (const std::size_t at = words.rfind("; solver: "); at != std::string::npos) words.replace(at, 2, "\n  ");
  return words;
}

void tell_error(std::string_view sentence) {
  std::string words;
  for (const std::string& line : lines_of(sentence))
    words += (line.starts_with(' ') ? "" : error_mark() + std::string(" ")) + line + "\n";
  tell(words);
}

}  // namespace lockstep
