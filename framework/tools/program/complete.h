// SPDX-License-Identifier: BSD-3-Clause
// Completions of a typed line: from the commands and options themselves, the registry, and the scene at hand.
#pragma once

#include <string>
#include <vector>

#include "framework/tools/program/commands.h"

namespace lockstep {

/// The completions of the last word of a line.
struct Completion {
  std::vector<std::string> words{};
  bool files = false;  ///< file names too
};

/// `words`: those of the line after the program's name; the last may be empty. Nothing is thrown: a scene that cannot
/// be read has no names.
Completion completion(const Program&, const std::vector<std::string>& words);

/// Called by shells: `lockstep complete WORDS`. A line per word, first ":files" if file names fit too.
int print_completions(const Program&, int argc, const char* const* argv);

}  // namespace lockstep
