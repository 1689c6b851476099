// Where plugins may come from. One search path for the program and for every other host.
#pragma once

#include <string>
#include <vector>

#include "framework/foundation/support/export.h"

namespace lockstep {

/// Where plugins are looked for when no folder is given: those of LOCKSTEP_PLUGIN_PATH (separated by ':'); then
/// ../plugins beside the folder of the running program, and beside the library's; then lib/lockstep/plugins of an
/// installation.
LOCKSTEP_API std::vector<std::string> plugin_folders();

/// "cam_follower" of "plugins/libcam_follower.so"
LOCKSTEP_API std::string plugin_name(const std::string& path);

/// Whether it can be nothing but a name: letters, digits, "_", "-", "+", "." (not at the beginning). A scene may ask
/// for a plugin by such a name only.
LOCKSTEP_API bool is_bare_name(const std::string& name);

/// The file of the plugin, links followed. A name without '/' is looked for in `folders` (plugin_folders() when there
/// are none), and the first file of that name is the one: refused when it leads out of all the folders, or when someone
/// else than you, root or the owner of this library could change it or its folder. A path is taken as it is: whoever
/// gives it says that this file may be loaded. Throws PluginError.
LOCKSTEP_API std::string find_plugin(const std::string& name_or_path, std::vector<std::string> folders);

/// Everything in the folders that ends as a plugin does, in the order of the search.
struct FoundFile {
  std::string folder, path;  ///< as found
  std::string file;          ///< with links followed
  std::string problem;       ///< why find_plugin() would refuse it; "" when it would not
};
std::vector<FoundFile> files_in(const std::vector<std::string>& folders);

}  // namespace lockstep
