// SPDX-License-Identifier: BSD-3-Clause
// Plugins: found, read, checked before their code runs, taken whole or not at all.
#include <lockstep/author/loader.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <lockstep/author/plugin.h>
#include <lockstep/error.h>
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace loader_test {

using namespace lockstep;
using lockstep::testing::contains;
namespace fs = std::filesystem;

namespace {

const std::string kModules = std::string(paths::kBuild) + "/test_plugins";

std::string refusal(const std::string& plugin, const std::vector<std::string>& folders = {}) {
  Registry registry;
  try {
    load_plugin(registry, plugin, folders);
  } catch (const PluginError& error) {
    CHECK(registry.laws.names().empty());
    return error.what();
  }
  return "accepted";
}

// A copy of the probe whose record was changed by `change`.
template <class F>
std::string changed_copy(const std::string& name, F&& change) {
  std::ifstream in(kModules + "/probe.so", std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const lockstep_abi_record record = read_abi(kModules + "/probe.so");
  const std::size_t at = bytes.find(std::string(reinterpret_cast<const char*>(&record), sizeof record));
  REQUIRE(at != std::string::npos);
  lockstep_abi_record other = record;
  change(other);
  std::memcpy(bytes.data() + at, &other, sizeof other);
  const std::string path = kModules + "/" + name + ".so";
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

}  // namespace

TEST_CASE("a plugin of another compiler is rejected before its code runs", "[plugin]") {
  unsetenv("LOCKSTEP_TEST_PROBE");
  const std::string path = changed_copy("foreign", [](lockstep_abi_record& r) {
    const bool host_is_clang = std::string(r.compiler) == "clang";
    std::strcpy(r.compiler, host_is_clang ? "gcc" : "clang");
    r.compiler_version[0] = 14, r.compiler_version[1] = 0, r.compiler_version[2] = 6;
  });
  const std::string message = refusal(path);
  const lockstep_abi_record host = abi_of_this_build();
  CHECK(contains(message, "plugin 'foreign': built for ABI " + std::to_string(host.abi) + " with "));
  CHECK(contains(message, " 14.0.6, this host is ABI " + std::to_string(host.abi) + " with " + host.compiler));
  CHECK(contains(message, "; rebuild the plugin against this lockstep"));
  CHECK(std::getenv("LOCKSTEP_TEST_PROBE") == nullptr);
}

TEST_CASE("every field that must agree is compared", "[plugin]") {
  const lockstep_abi_record host = abi_of_this_build();
  CHECK(abi_difference(host, host).empty());
  const auto with = [&](auto change) {
    lockstep_abi_record other = host;
    change(other);
    return abi_difference(other, host);
  };
  CHECK(contains(with([](auto& r) { r.abi = 99; }), "ABI 99"));
  CHECK(contains(with([](auto& r) { r.cxx_level = 201703; }), "C++ 201703"));
  CHECK(contains(with([](auto& r) { r.library_version = 1; }), "the standard library"));
  CHECK_FALSE(contains(with([](auto& r) { r.library_version = 1; }), "old strings"));
  CHECK(contains(with([](auto& r) { r.library_abi = 0; }), "(old strings)"));
  CHECK(contains(with([](auto& r) { r.eigen_version[1] = 77; }), "Eigen 3.77"));
  CHECK(contains(with([](auto& r) { r.alignment = 64; }), "alignment 64"));
  CHECK(contains(with([](auto& r) { std::strcpy(r.flags, "fast-math "); }), "built with -ffast-math"));
  CHECK(with([](auto& r) { r.compiler_version[2] += 1; }).empty());  // the same series of the same compiler
}

TEST_CASE("a plugin is found by path and by name, and its types report their origin", "[plugin]") {
  const std::string own = kModules + "/own";  // a file that no other test has opened
  fs::create_directories(own);
  fs::copy_file(kModules + "/probe.so", own + "/probe.so", fs::copy_options::overwrite_existing);
  Registry registry;
  const std::string file = load_plugin(registry, "probe", {"/nowhere", own});
  CHECK(fs::equivalent(file, own + "/probe.so"));
  REQUIRE(registry.laws.find("probe_law") != nullptr);
  CHECK(registry.laws.find("probe_law")->origin == "probe");
  CHECK(registry.laws.make("probe_law", Params{}, nullptr, "law")->at(0).y == 7);
  CHECK(std::string(std::getenv("LOCKSTEP_TEST_PROBE")) == "ran");

  Registry other;  // two registries know nothing of each other
  load_plugin(other, kModules + "/probe");
  CHECK(other.laws.names() == registry.laws.names());
  CHECK_THROWS_WITH(load_plugin(other, kModules + "/probe.so"),
                    Catch::Matchers::Contains("plugin 'probe': it is already loaded into this registry"));

  setenv("LOCKSTEP_PLUGIN_PATH", kModules.c_str(), 1);
  Registry third;
  CHECK_NOTHROW(load_plugin(third, "probe"));
  unsetenv("LOCKSTEP_PLUGIN_PATH");
}

TEST_CASE("a file that is no plugin is rejected in one sentence", "[plugin]") {
  CHECK(contains(refusal("no_such_plugin", {"/nowhere"}), "plugin 'no_such_plugin' not found; looked in /nowhere"));
  CHECK(contains(refusal("./no_such_plugin"), "there is no such file"));
  CHECK(contains(refusal(kModules + "/stranger.so"), "is not a lockstep plugin"));
  CHECK(contains(refusal(std::string(paths::kSource) + "/LICENSE"), "is not a shared library"));
  CHECK(contains(refusal(kModules + "/half.so"), "plugin 'half': the other half is missing"));
  std::ifstream in(kModules + "/probe.so", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  for (const std::size_t n : {std::size_t{0}, std::size_t{10}, std::size_t{100}, std::size_t{8000}}) {
    std::ofstream(kModules + "/cut.so", std::ios::binary) << bytes.substr(0, n);
    INFO(n);
    CHECK(contains(refusal(kModules + "/cut.so"), "cut"));
  }
}

}  // namespace loader_test
