// SPDX-License-Identifier: BSD-3-Clause
// The commands of `lockstep` and of the programs that it calls: in libexec/lockstep next to its folder, or on the PATH.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace lockstep {

/// A command of lockstep, and the program that has it.
struct Verb {
  std::string_view name;     ///< "run"; "plugins list"
  std::string_view program;  ///< "sweep": the file lockstep-sweep; "": lockstep itself
  std::string_view group, help;
};
/// All of them, group by group, as help lists them.
std::span<const Verb> verbs();
/// Null if there is none of this name.
const Verb* verb_of(std::string_view name);

/// If the words call another program, it takes over this process. Returns an Exit if it cannot be started, and nothing
/// if the words are for `lockstep` itself.
std::optional<int> call_tool(int argc, const char* const* argv);

/// What all tools in libexec print of themselves, one after another: their part of the manual ("man-verbs"), or the
/// schemas of their results ("results"). Throws FileError if one of them fails.
std::string ask_tools(const char* question);

}  // namespace lockstep
