// SPDX-License-Identifier: BSD-3-Clause
// A plugin's file, read before anything of it is opened.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <lockstep/author/loader.h>

namespace lockstep {

/// A part of a plugin's file.
struct CheckedFile {
  PluginStamp stamp;
  std::string data;  ///< from the first place of the magic bytes on; "" if the file does not have them
};

/// Size and checksum of a file, whatever it holds. Throws PluginError when it is not a regular file or cannot be read.
PluginStamp stamp_of(const std::string& file);

/// At most `most` bytes of a shared library, from the first place of these magic bytes on, without opening it. Throws
/// PluginError for a file that is cut, is no shared library or is made for another machine. Other damage is left to the
/// loader of the system.
CheckedFile data_from(const std::string& path, std::string_view magic, std::size_t most);

}  // namespace lockstep
