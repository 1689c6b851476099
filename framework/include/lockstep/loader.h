// Loading of plugins.
#pragma once

#include <string>
#include <vector>

#include <lockstep/export.h>
#include <lockstep/plugin.h>
#include <lockstep/registry.h>

namespace lockstep {

// Where plugins may come from. One search path for the program and for every other host.


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


// Loads plugins: finds the file, reads what it was built with, opens it and takes over what it registers.


/// Loads "cam_follower", "plugins/cam_follower" or "plugins/cam_follower.so" ("lib" before the name is tried as well)
/// and returns the path of the file. A name without a '/' is looked for in `folders`, or in plugin_folders() when there
/// are none; there it is refused when it could come from a stranger (description/registry/search.h). A path is your word that this
/// file may be loaded: hand no path on that came out of a scene. All or nothing: on an error the registry is as it was.
/// The plugin stays loaded for the life of the process, because objects carry its code. Throws PluginError: not found
/// (with the places), no plugin, damaged, built differently (with the first field that differs), a name that is taken,
/// or what the plugin itself threw.
LOCKSTEP_API std::string load_plugin(Registry&, const std::string& name_or_path,
                                     const std::vector<std::string>& folders = {});

/// All that load_plugin() looks at in a file before it opens it: that it is a shared library for this machine, whole and
/// sound in its structure; its record. None of its code runs. Throws PluginError. Code that was changed in a file of sound
/// structure is found by nobody: that is for package managers.
LOCKSTEP_API void check_plugin_file(const std::string& path);

/// The record in the file of a plugin, read without opening it as a library. Throws PluginError.
LOCKSTEP_API lockstep_abi_record read_abi(const std::string& path);

/// "ABI 3, gcc 12.2.0, libstdc++ 12, Eigen 3.4.0, alignment 16"
LOCKSTEP_API std::string abi_words(const lockstep_abi_record&);

/// Empty when a plugin with record `plugin` fits `host`, else the sentence that says what differs and what to do.
LOCKSTEP_API std::string abi_difference(const lockstep_abi_record& plugin, const lockstep_abi_record& host);

}  // namespace lockstep
