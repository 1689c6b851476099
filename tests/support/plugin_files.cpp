// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/plugin_files.h"

#include <spdlog/fmt/fmt.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <lockstep/author/loader.h>
#include <lockstep/error.h>
#include "tests/support/catch.h"
#include "tests/support/paths.h"

namespace lockstep::testing {

namespace fs = std::filesystem;

const std::string kModules = std::string(paths::kBuild) + "/test_plugins";

std::string test_plugin(const std::string& name) { return fmt::format("{}/{}.so", kModules, name); }
std::string built_plugin(const std::string& name) { return fmt::format("{}/{}.so", paths::kPlugins, name); }

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  REQUIRE(in);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string plugin_file(const std::string& folder, const std::string& name, const std::string& bytes) {
  const std::string path = kModules + "/" + folder + "/" + name;
  fs::create_directories(fs::path(path).parent_path());
  fs::remove_all(path);
  std::ofstream(path, std::ios::binary) << bytes;
  fs::permissions(path, fs::perms(0644));
  return path;
}

lockstep_abi_record record_in(const std::string& path) { return read_abi(path); }

std::size_t place_of_record(const std::string& path) {
  const lockstep_abi_record record = record_in(path);
  const std::size_t at = bytes_of(path).find(std::string(reinterpret_cast<const char*>(&record), sizeof record));
  REQUIRE(at != std::string::npos);
  return at;
}

std::string with_record_bytes(const std::string& path, const lockstep_abi_record& record) {
  std::string bytes = bytes_of(path);
  std::memcpy(bytes.data() + place_of_record(path), &record, sizeof record);
  return bytes;
}

std::string replaced(std::string bytes, const std::string& from, const std::string& to) {
  REQUIRE(from.size() == to.size());
  std::size_t n = 0;
  for (std::size_t at = 0; (at = bytes.find(from, at)) != std::string::npos; at += from.size(), ++n)
    bytes.replace(at, from.size(), to);
  REQUIRE(n > 0);
  return bytes;
}

std::string answer_of(const std::string& plugin, const std::vector<std::string>& folders) {
  Registry registry;
  try {
    load_plugin(registry, plugin, folders);
    return "loaded";
  } catch (const PluginError& error) {
    CHECK(registry.laws.names().empty());
    CHECK(registry.links.names().empty());
    return error.what();
  }
}

}  // namespace lockstep::testing
