// Loads plugins: finds the file, reads what it was built with, opens it and takes over what it registers.
#pragma once

#include <string>
#include <vector>

#include "framework/plugin/abi.h"
#include "framework/plugin/registry.h"

namespace lockstep {

/// Where plugins are looked for when no folder is given: those of LOCKSTEP_PLUGIN_PATH (separated by ':'); then
/// ../plugins beside the folder of the running program, and beside the library's; then lib/lockstep/plugins of an
/// installation.
LOCKSTEP_API std::vector<std::string> plugin_folders();

/// Loads "cam_follower", "plugins/cam_follower" or "plugins/cam_follower.so" ("lib" before the name is tried as well)
/// and returns the path of the file. A name without a '/' is looked for in `folders`, or in plugin_folders() when there
/// are none. All or nothing: on an error the registry is as it was. The plugin stays loaded for the life of the
/// process, because objects carry its code. Throws PluginError: not found (with the places), no plugin, built
/// differently (with the first field that differs), a name that is taken, or what the plugin itself threw.
LOCKSTEP_API std::string load_plugin(Registry&, const std::string& name_or_path,
                                     const std::vector<std::string>& folders = {});

/// The record in the file of a plugin, read without opening it as a library. Throws PluginError.
LOCKSTEP_API lockstep_abi_record read_abi(const std::string& path);

/// Empty when a plugin with record `plugin` fits `host`, else the sentence that says what differs and what to do.
LOCKSTEP_API std::string abi_difference(const lockstep_abi_record& plugin, const lockstep_abi_record& host);

}  // namespace lockstep
