// SPDX-License-Identifier: BSD-3-Clause
// A plugin's file, read before anything of it is opened.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <lockstep/author/loader.h>

namespace lockstep {

/// What was read of a plugin's file.
struct CheckedFile {
  PluginStamp stamp;
  std::optional<std::string> data;  ///< of the symbol; nothing when it exports no such data
};

/// Size and checksum of a file, whatever it holds. Throws PluginError when it is not a regular file or cannot be read.
PluginStamp stamp_of(const std::string& file);

/// The bytes of a data symbol that a shared library exports, without opening it. Throws PluginError with the file, what is
/// wrong, its value and the limit for a file that is cut, is no shared library or is made for another machine. Other
/// damage is not looked for, as in any library that the system loads.
CheckedFile exported_data(const std::string& path, std::string_view symbol);

}  // namespace lockstep
