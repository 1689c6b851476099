// SPDX-License-Identifier: BSD-3-Clause
// The programs beside `lockstep`, in libexec/lockstep beside the folder of this program, or on the PATH: which verbs they have,
// and how one takes over.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace lockstep {

struct Command;

/// The commands' groups, as help lists them; the last is of those that it does not.
inline constexpr std::string_view kRun = "Run a mechanism", kLook = "Look at a scene", kAnalyse = "Analyse",
                                  kCompare = "Compare and sweep", kExtend = "Extend and install";
inline constexpr std::string_view kGroups[] = {kRun, kLook, kAnalyse, kCompare, kExtend, ""};

/// A command of a program beside `lockstep`.
struct Tool {
  std::string_view verb;
  const char* program;  ///< "sweep": the file lockstep-sweep
  std::string_view group, help;
};
std::span<const Tool> tools();
/// Null where no tool has this verb.
const Tool* tool_of(std::string_view verb);
/// Its own help, or that of the tool of its name; "" for one that no page shows.
std::string_view help_of(const Command&);
/// Its own group, or that of the tool of its name.
std::string_view group_of(const Command&);

/// Where the words call a tool, it takes over this process. Returns an Exit where it is not there, and nothing where the
/// words are for `lockstep` itself.
std::optional<int> call_tool(int argc, const char* const* argv);

/// What all tools in libexec print if they are asked for their part of the manual ("man-verbs"), or for the schemas of
/// their results ("results"), one after another. Throws FileError if one of them fails.
std::string ask_tools(const char* question);

}  // namespace lockstep
