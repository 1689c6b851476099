// SPDX-License-Identifier: BSD-3-Clause
// The verbs of `lockstep` and of the programs beside it, in libexec/lockstep beside the folder of this program, or on the
// PATH: how one of these takes over.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace lockstep {

/// A verb of lockstep, whichever program has its command.
struct Verb {
  std::string_view name;     ///< "run"; "plugins list"
  std::string_view program;  ///< "sweep": the file lockstep-sweep; "": lockstep itself
  std::string_view group, help;
};
/// All of them, group by group, as help lists them.
std::span<const Verb> verbs();
/// Null where there is none of this name.
const Verb* verb_of(std::string_view name);

/// Where the words call another program, it takes over this process. Returns an Exit where it cannot be started, and
/// nothing where the words are for `lockstep` itself.
std::optional<int> call_tool(int argc, const char* const* argv);

/// What all tools in libexec print if they are asked for their part of the manual ("man-verbs"), or for the schemas of
/// their results ("results"), one after another. Throws FileError if one of them fails.
std::string ask_tools(const char* question);

}  // namespace lockstep
