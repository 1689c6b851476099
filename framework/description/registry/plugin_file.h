// A plugin's file, read and checked before anything of it is opened.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace lockstep {

/// The bytes of a data symbol that a shared library exports; nothing when it exports no such data. First, every table
/// that the system's loader trusts is checked: segments, dynamic table, strings, symbols, hash tables, versions,
/// relocations and functions that it calls. Code and data are not. Throws PluginError with the file, what is wrong, its
/// value and the limit.
std::optional<std::string> exported_data(const std::string& path, std::string_view symbol);

}  // namespace lockstep
