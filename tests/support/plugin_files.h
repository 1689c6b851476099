// SPDX-License-Identifier: BSD-3-Clause
// Files of plugins made from good ones, for tests of the loader.
#pragma once

#include <string>

#include <lockstep/author/plugin.h>
#include <lockstep/author/registry.h>

namespace lockstep::testing {

extern const std::string kModules;  ///< folder of the test's own plugins
std::string test_plugin(const std::string& name);   ///< the file of one of them
std::string built_plugin(const std::string& name);  ///< the file of one of plugins/

std::string bytes_of(const std::string& path);
/// Writes `bytes` to <build>/test_plugins/<folder>/<name>; the path.
std::string plugin_file(const std::string& folder, const std::string& name, const std::string& bytes);

/// Where the record stands in the bytes of the plugin at `path`.
std::size_t place_of_record(const std::string& path);
/// The bytes of the plugin at `path` with another record in them.
template <class Change>
std::string with_record(const std::string& path, Change&& change);
std::string with_record_bytes(const std::string& path, const lockstep_abi_record&);
lockstep_abi_record record_in(const std::string& path);
/// Every `from` replaced by `to`, of the same length.
std::string replaced(std::string bytes, const std::string& from, const std::string& to);

/// What load_plugin() answers: the message of its PluginError, or "loaded". The registry it is given stays empty unless
/// it loads.
std::string answer_of(const std::string& plugin, const std::vector<std::string>& folders = {});

template <class Change>
std::string with_record(const std::string& path, Change&& change) {
  lockstep_abi_record record = record_in(path);
  change(record);
  return with_record_bytes(path, record);
}

}  // namespace lockstep::testing
