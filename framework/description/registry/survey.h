// Every plugin that could be loaded by its name, and why others could not.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <lockstep/registry.h>

namespace lockstep {

/// One file of the search path.
struct PluginCandidate {
  enum class State { loaded, refused, hidden };
  std::string name;                                         ///< by which it is asked for
  std::string folder, path;                                 ///< where it was found
  std::string file;                                         ///< with links followed
  State state = State::refused;                             ///< hidden: a file of the same name comes before it
  std::string why;                                          ///< refused: the reason; hidden: the file that is taken
  std::string build;                                        ///< what it was built with, as far as it can be read
  std::vector<std::pair<std::string, std::string>> brings;  ///< kind and name: {"link", "cam_follower"}
};

/// Loads every file of the folders (plugin_folders() when there are none) that may be loaded, each beside the things of
/// `base` alone, and says how it went. Throws nothing of its own.
LOCKSTEP_API std::vector<PluginCandidate> survey_plugins(const Registry& base, std::vector<std::string> folders = {});

}  // namespace lockstep
