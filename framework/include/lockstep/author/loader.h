// SPDX-License-Identifier: BSD-3-Clause
// Loading of plugins.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <lockstep/detail/export.h>

struct lockstep_abi_record;

namespace lockstep {

class Registry;

// The search path of plugins, the same for the program and for every other host.

/// The folders that are searched when none are given: those of LOCKSTEP_PLUGIN_PATH (separated by ':'); then
/// ../plugins, relative to the folder of the running program and to that of the library; then lockstep/plugins in the
/// folder of the library, as in an installation.
LOCKSTEP_API std::vector<std::string> plugin_folders();

/// Name of the plugin in a file: "cam_follower" of "plugins/libcam_follower.so".
LOCKSTEP_API std::string plugin_name(const std::string& path);

/// Whether a text is a plain name, not a path: letters, digits, "_", "-", "+", "." (not at the beginning). A scene may
/// name plugins only in this way.
LOCKSTEP_API bool is_bare_name(const std::string& name);

/// The file of a plugin, with symbolic links followed. A name without '/' is searched in `folders` (plugin_folders() if
/// empty), and the first file of that name is used. Throws PluginError if it is outside of these folders, or if users
/// other than you, root and the owner of this library can change it or its folder. A path is not checked in this way.
LOCKSTEP_API std::string find_plugin(const std::string& name_or_path, std::vector<std::string> folders);

/// Size and checksum of a plugin's file when it was read.
struct PluginStamp {
  std::uint64_t size = 0;                                                    ///< bytes
  std::uint64_t checksum = 0;                                                ///< FNV-1a, 64 bits, of all bytes
  friend bool operator==(const PluginStamp&, const PluginStamp&) = default;  ///< whether both agree
};

// Loads plugins: finds the file, reads its build record, opens it and adds the types that it registers.

/// Loads a plugin into the registry and returns the path of its file. "cam_follower", "plugins/cam_follower" and
/// "plugins/cam_follower.so" are all accepted, also with "lib" before the name. The file is found by find_plugin(), so
/// never pass on a path that came from a scene. On an error the registry is unchanged. The plugin stays loaded for the
/// life of the process, because objects run its code. Throws PluginError: not found (with the folders), not a plugin,
/// cut, built differently (with the first field that differs), nothing registered, a name that is taken, or an error of
/// the plugin. Size and checksum of the file are kept before it is opened. A file whose stamp has changed when it is
/// loaded again, or differs from `expected`, is an error.
LOCKSTEP_API std::string load_plugin(Registry&, const std::string& name_or_path,
                                     const std::vector<std::string>& folders = {},
                                     const std::optional<PluginStamp>& expected = {});

/// The checks of load_plugin() before it opens a file: a whole shared library for this machine, with a record that fits
/// this build. None of its code runs. Throws PluginError. It does not find other damage: compare the returned size and
/// checksum with those of a sound file.
LOCKSTEP_API PluginStamp check_plugin_file(const std::string& path);

/// The record in the file of a plugin, read without opening the file as a library. Throws PluginError.
LOCKSTEP_API lockstep_abi_record read_abi(const std::string& path);

/// A record in words: "ABI 3, gcc 12.2.0, libstdc++ 12, Eigen 3.4.0, alignment 16".
LOCKSTEP_API std::string abi_words(const lockstep_abi_record&);

/// The difference between the records `plugin` and `host`, and what to do, in one sentence; "" if they fit.
LOCKSTEP_API std::string abi_difference(const lockstep_abi_record& plugin, const lockstep_abi_record& host);

}  // namespace lockstep
