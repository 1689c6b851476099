// SPDX-License-Identifier: BSD-3-Clause
#include "tests/fuzz/scratch_file.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>

namespace lockstep::fuzz {

namespace {

// The file of a process, removed at its end.
class Scratch {
 public:
  explicit Scratch(const std::string& ending)
      : path_((std::filesystem::temp_directory_path() / ("lockstep_fuzz_" + std::to_string(getpid()) + ending))
                  .string()) {}
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace

std::string scratch_file(Bytes bytes, const std::string& ending) {
  static std::map<std::string, Scratch> files;
  const Scratch& file = files.try_emplace(ending, ending).first->second;
  std::ofstream(file.path(), std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return file.path();
}

}  // namespace lockstep::fuzz
