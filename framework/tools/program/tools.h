// The programs beside `lockstep`, in libexec/lockstep beside the folder of this program, or on the PATH: which verbs they have,
// and how one takes over.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace lockstep {

/// A verb of a program beside `lockstep`.
struct Tool {
  const char* verb;
  const char* program;  ///< "sweep": the file lockstep-sweep
  const char* help;
};
std::span<const Tool> tools();
/// Null where no tool has this verb.
const Tool* tool_of(std::string_view verb);

/// Where the words call a tool, it takes over this process. Returns an Exit where it is not there, and nothing where the
/// words are for `lockstep` itself.
std::optional<int> call_tool(int argc, const char* const* argv);

/// The manual's part on the verbs of all tools in libexec. Throws FileError where one of them fails.
std::string pages_of_tools();

}  // namespace lockstep
