// The seal of a plugin: a checksum of what is loaded of its file, kept in its record (abi.h). It tells a damaged file
// from a sound one before any of its code runs; it is no signature: whoever can write the file can seal it too.
#pragma once

#include <string>

#include "framework/description/registry/abi.h"
#include "framework/description/registry/elf.h"

namespace lockstep {

/// Writes the seal into the file; again and again gives the same file. Throws PluginError when it is no plugin for this
/// lockstep, FileError when it cannot be written.
LOCKSTEP_API void seal_plugin(const std::string& path);

/// The record as it stands in a file that was read. Throws PluginError: no plugin, or a record of another size.
lockstep_abi_record record_of(const SharedFile&);

/// False for a plugin that was never sealed. Throws PluginError when the seal is broken.
bool check_seal(const SharedFile&, const lockstep_abi_record&);

}  // namespace lockstep
