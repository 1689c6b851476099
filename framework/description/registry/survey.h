// The plugins that can be loaded by name, and why others cannot.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <lockstep/registry.h>

namespace lockstep {

/// One file of the search path.
struct PluginCandidate {
  enum class State { loaded, refused, hidden };
  std::string name;                                         ///< by which it is requested
  std::string folder, path;                                 ///< where it was found
  std::string file;                                         ///< with links followed
  State state = State::refused;                             ///< hidden: a file of the same name comes before it
  std::string why;                                          ///< refused: the reason; hidden: the file that is used
  std::string build;                                        ///< what it was built with, as far as it can be read
  std::vector<std::pair<std::string, std::string>> brings;  ///< kind and name: {"link", "cam_follower"}
};

/// Loads every file of the folders (plugin_folders() when there are none) that may be loaded, each on top of `base`
/// alone, and reports the result. Errors of the files are reported, not thrown.
LOCKSTEP_API std::vector<PluginCandidate> survey_plugins(const Registry& base, std::vector<std::string> folders = {});

}  // namespace lockstep
