// SPDX-License-Identifier: BSD-3-Clause
// The plugins that can be loaded by name, and the reasons why others cannot.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <lockstep/author/loader.h>
#include <lockstep/author/registry.h>

namespace lockstep {

/// Whether the library loads the plugin of this name for its own laws or integrators (LOCKSTEP_BUILTINS=OFF).
bool is_part_of_library(std::string_view plugin);

/// One file of the search path.
struct PluginCandidate {
  enum class State { loaded, refused, hidden };
  std::string name;                                         ///< by which it is requested
  std::string folder, path;                                 ///< where it was found
  std::string file;                                         ///< with symbolic links followed
  State state = State::refused;                             ///< hidden: a file of the same name comes before it
  std::string why;                                          ///< refused: the reason; hidden: the file that is used
  PluginStamp stamp;                                        ///< of a file that was read
  std::string build;                                        ///< what it was built with, as far as it can be read
  std::vector<std::pair<std::string, std::string>> brings;  ///< kind and name: {"joint", "cam_follower"}
};

/// All files in these folders with the ending of a plugin, in the order in which find_plugin() considers them; `why`: why
/// it would refuse them, "" when it would not.
std::vector<PluginCandidate> files_in(const std::vector<std::string>& folders);

/// Loads the file of a candidate on top of `base` alone, and fills in what follows from it; an error becomes its `why`.
/// Code of a damaged file may end the process.
LOCKSTEP_API void ask_plugin(PluginCandidate&, const Registry& base);

/// Reports on every file of the folders. `ask` is called for those that may be loaded, and does what ask_plugin() does.
LOCKSTEP_API std::vector<PluginCandidate> survey_plugins(const std::vector<std::string>& folders,
                                                         const std::function<void(PluginCandidate&)>& ask);

}  // namespace lockstep
