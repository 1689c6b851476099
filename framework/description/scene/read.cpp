// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/scene/read.h"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <new>
#include <system_error>

#include <lockstep/error.h>

namespace lockstep {

Value read_json_file(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (fs::is_directory(path, error)) throw FileError("cannot read '" + path + "': it is a folder; name a file in it");
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file && errno == ENOMEM) throw std::bad_alloc();
  if (!file)
    throw FileError("cannot read '" + path + "': " + std::generic_category().message(errno) + "; check the path");
  std::string text;
  std::string block(65536, '\0');
  while (file && text.size() <= kMostBytes) {  // one block beyond the limit is enough for read_json to refuse
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    text.append(block, 0, static_cast<std::size_t>(file.gcount()));
  }
  if (file.bad()) throw FileError("cannot read '" + path + "' to its end: " + std::generic_category().message(errno));
  return read_json(text, path);
}

}  // namespace lockstep
