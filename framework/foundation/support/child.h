// SPDX-License-Identifier: BSD-3-Clause
// Another program as a process.
#pragma once

#include <string>
#include <vector>

#include <lockstep/detail/export.h>

namespace lockstep {

/// How a process ended, as waitpid() has it, and what it printed.
struct ChildEnd {
  int status = 0;
  std::string text;
};

/// Runs a program: its path, then its words. Its standard input is empty. `errors`: standard error is printed too, else it is
/// lost. Throws FileError where it cannot be started.
LOCKSTEP_API ChildEnd run_child(std::vector<std::string> words, const std::string& folder = ".", bool errors = false);

}  // namespace lockstep
