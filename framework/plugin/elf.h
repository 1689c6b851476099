// Data of a named symbol in a shared library's file, by the ELF format (System V ABI, chapters 4 and 5), nothing
// opened.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace lockstep {

/// The bytes of the symbol as they stand in the file, at most `most`; empty when the file exports no such data. Throws
/// PluginError when it cannot be read or is no shared library of this kind of machine.
std::vector<unsigned char> exported_data(const std::string& path, const std::string& symbol, std::size_t most);

}  // namespace lockstep
