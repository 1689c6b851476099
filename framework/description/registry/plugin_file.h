// A plugin's file, read and checked before anything of it is opened.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <lockstep/loader.h>

namespace lockstep {

/// What was read of a plugin's file.
struct CheckedFile {
  PluginStamp stamp;
  std::optional<std::string> data;  ///< of the symbol; nothing when it exports no such data
};

/// The bytes of a data symbol that a shared library exports. First, every table
/// that the system's loader trusts is checked: segments, dynamic table, strings, symbols, hash tables, versions,
/// relocations and functions that it calls. Code and data are not. Throws PluginError with the file, what is wrong, its
/// value and the limit.
CheckedFile exported_data(const std::string& path, std::string_view symbol);

}  // namespace lockstep
