// SPDX-License-Identifier: BSD-3-Clause
// Scenes in files: a folder of a test's own, and what comes with lockstep to build them with.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <lockstep/author/registry.h>

namespace lockstep::testing {

/// What comes with lockstep; made once.
inline const Registry& builtin() {
  static const Registry kRegistry = builtin_registry();
  return kRegistry;
}

/// A folder of this name and process, which goes with the object.
class SceneFolder {
 public:
  explicit SceneFolder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() / ("lockstep_" + name + "_test_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~SceneFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  SceneFolder(const SceneFolder&) = delete;
  SceneFolder& operator=(const SceneFolder&) = delete;
  /// The path of a file there.
  std::string path(const std::string& name) const { return (path_ / name).string(); }
  /// Writes a file; returns its path.
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
    return path(name);
  }

 private:
  std::filesystem::path path_;
};

}  // namespace lockstep::testing
