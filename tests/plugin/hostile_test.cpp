// SPDX-License-Identifier: BSD-3-Clause
// Files that are no plugins, damaged ones, and plugins that register badly: each is refused by a PluginError that says
// why, and the host goes on.
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>

#include <lockstep/author/loader.h>
#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/paths.h"
#include "tests/support/plugin_files.h"
#include "tests/support/program.h"

namespace hostile_test {

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;

namespace {

const std::string kProbe = kModules + "/probe.so";

std::string changed(std::size_t at, const std::string& bytes) {
  std::string all = bytes_of(kProbe);
  REQUIRE(at + bytes.size() <= all.size());
  return all.replace(at, bytes.size(), bytes);
}

std::string two_bytes(unsigned value) { return {static_cast<char>(value & 255), static_cast<char>(value >> 8)}; }

std::string hostile(const std::string& name, const std::string& bytes) {
  return plugin_file("hostile", name + ".so", bytes);
}

template <class Change>
std::string foreign(const std::string& name, Change&& change) {
  return hostile(name, with_record(kProbe, change));
}

struct Case {
  std::string name, says;
  std::function<std::string()> make;  // the file
};

void check(const Case& c) {
  const std::string file = c.make();
  const std::string answer = answer_of(file);
  INFO(c.name << ": " << answer);
  CHECK(contains(answer, c.says));
  CHECK(contains(answer, file.substr(file.rfind('/') + 1).substr(0, 4)));  // names the file or the plugin
}

// How rude.so registers; which one is read from the environment, so that one file serves all.
std::string rude(const std::string& how, const Registry& base = builtin_registry()) {
  setenv("LOCKSTEP_TEST_RUDE", how.c_str(), 1);
  Registry registry = base;
  std::string answer = "loaded";
  try {
    load_plugin(registry, kModules + "/rude.so");
  } catch (const PluginError& error) {
    answer = error.what();
    CHECK(registry.laws.names() == base.laws.names());  // nothing of it stays
  }
  unsetenv("LOCKSTEP_TEST_RUDE");
  return answer;
}

}  // namespace

TEST_CASE("files that are no plugin for this host are rejected, each with its reason", "[plugin][hostile]") {
  const std::string sound = bytes_of(kProbe);
  const std::vector<Case> cases = {
      {"empty file", "it is empty", [] { return hostile("none", ""); }},
      {"a text", "it does not begin with an ELF header", [] { return hostile("text", "#!/bin/sh\necho no\n"); }},
      {"only the first four bytes", "the file is truncated: 4 bytes, but its headers require at least 64",
       [&] { return hostile("magic", sound.substr(0, 4)); }},
      {"cut in the header", "the file is truncated: ", [&] { return hostile("cut40", sound.substr(0, 40)); }},
      {"cut in the middle", "the file is truncated: ", [&] { return hostile("half_of", sound.substr(0, 8000)); }},
      {"32 bits", "another word size", [] { return hostile("bits32", changed(4, "\1")); }},
      {"other byte order", "another word size or byte order", [] { return hostile("order", changed(5, "\2")); }},
      {"other architecture", "it is made for S/390, this host is ",
       [] { return hostile("s390", changed(18, two_bytes(22))); }},
      {"other system", "ELF file OS ABI invalid", [] { return hostile("system", changed(7, "\x09")); }},
      {"a program", "cannot be opened: ", [] { return hostile("program", changed(16, two_bytes(2))); }},
      {"no segments", "cannot be opened: ", [] { return hostile("bare", changed(56, two_bytes(0))); }},
      {"segments beyond the end",
       "the file is truncated: ", [] { return hostile("beyond", changed(32, std::string("\0\0\0\1\0\0\0\0", 8))); }},
      {"a library without a record", "is not a lockstep plugin: it has no record \"lockstep-abi\"",
       [] { return kModules + "/stranger.so"; }},
      {"a record that is none", "it has no record",
       [] { return foreign("magicless", [](auto& r) { r.magic[0] = 'x'; }); }},
      {"a shorter record", "with a record of 100 bytes",
       [] { return foreign("shorter", [](auto& r) { r.size = 100; }); }},
      {"other ABI", "built for ABI 2 with ", [] { return foreign("abi_2", [](auto& r) { r.abi = 2; }); }},
      {"other compiler", " with tcc ",
       [] { return foreign("compiler", [](auto& r) { std::strcpy(r.compiler, "tcc"); }); }},
      {"other series of the compiler", "built for ABI ",
       [] { return foreign("series", [](auto& r) { r.compiler_version[0] += 1; }); }},
      {"other C++", "built for C++ 201703", [] { return foreign("cxx17", [](auto& r) { r.cxx_level = 201703; }); }},
      {"other standard library", "the standard library libother",
       [] { return foreign("stdlib", [](auto& r) { std::strcpy(r.library, "libother"); }); }},
      {"old strings", "(old strings)", [] { return foreign("strings", [](auto& r) { r.library_abi = 0; }); }},
      {"other Eigen", "built for Eigen 3.3.", [] { return foreign("eigen", [](auto& r) { r.eigen_version[1] = 3; }); }},
      {"other alignment", "built for alignment 64",
       [] { return foreign("align", [](auto& r) { r.alignment = 64, r.static_alignment = 64; }); }},
      {"other alignment of objects", "(objects 8)",
       [] { return foreign("objects", [](auto& r) { r.static_alignment = 8; }); }},
      {"other index", "built for Eigen's index of 4",
       [] { return foreign("index", [](auto& r) { r.index_size = 4; }); }},
      {"debug library", "settings debug-library",
       [] { return foreign("debug", [](auto& r) { std::strcpy(r.flags, "debug-library "); }); }},
      {"fast-math", "built with -ffast-math, which this lockstep does not accept; rebuild it without",
       [] { return foreign("fast", [](auto& r) { std::strcpy(r.flags, "fast-math "); }); }},
      {"no exceptions", "settings no-exceptions no-rtti",
       [] { return foreign("noexcept", [](auto& r) { std::strcpy(r.flags, "no-exceptions no-rtti "); }); }},
      {"a record without a register function", "it exports no \"lockstep_register_plugin\"",
       [] { return kModules + "/mute.so"; }},
      {"nothing to register", "it registers no type", [] { return kModules + "/empty.so"; }},
      {"gives up half way", "plugin 'half': the other half is missing", [] { return kModules + "/half.so"; }},
      {"a library that it needs is not there", "libgcc_x.so.1",
       [] { return hostile("orphan", replaced(bytes_of(kProbe), "libgcc_s.so.1", "libgcc_x.so.1")); }},
      {"a file with the name of what is built in", "this name stands for lockstep's own types",
       [] { return hostile("built in", bytes_of(kProbe)); }},
      {"a folder", "is a folder, not a regular file",
       [] {
         const std::string path = kModules + "/hostile/folder.so";
         fs::remove_all(path);
         fs::create_directories(path);
         return path;
       }},
      {"a pipe", "is a pipe, not a regular file",
       [] {
         const std::string path = kModules + "/hostile/pipe.so";
         fs::create_directories(kModules + "/hostile");
         fs::remove_all(path);
         REQUIRE(mkfifo(path.c_str(), 0644) == 0);
         return path;
       }},
      {"a device", "is a device, not a regular file",
       [] {
         const std::string path = kModules + "/hostile/device.so";
         fs::create_directories(kModules + "/hostile");
         fs::remove_all(path);
         fs::create_symlink("/dev/null", path);
         return path;
       }},
  };
  const char* before = std::getenv("LOCKSTEP_TEST_PROBE");  // the probe itself may have run in another test
  const std::string trace = before == nullptr ? "" : before;
  unsetenv("LOCKSTEP_TEST_PROBE");
  for (const Case& c : cases) check(c);
  CHECK(std::getenv("LOCKSTEP_TEST_PROBE") == nullptr);  // no code of the changed probes has run
  if (!trace.empty()) setenv("LOCKSTEP_TEST_PROBE", trace.c_str(), 1);
  CHECK(answer_of(kProbe) == "loaded");  // and the host goes on
  fs::remove_all(kModules + "/hostile");
}

TEST_CASE("an unreadable file is rejected", "[plugin][hostile]") {
  if (geteuid() == 0) {
    WARN("skipped: root may read everything");
    return;
  }
  const std::string file = hostile("secret", bytes_of(kProbe));
  fs::permissions(file, fs::perms::none);
  CHECK(contains(answer_of(file), "cannot be opened (Permission denied)"));
  fs::remove(file);
}

TEST_CASE("a plugin that registers badly leaves nothing behind", "[plugin][hostile]") {
  CHECK(rude("") == "loaded");
  CHECK(rude("twice") == "plugin 'rude': law 'rude_law' is already registered; choose another name");
  CHECK(rude("taken") ==
        "plugin 'rude': law 'sine' (plugin rude) is already registered (built in); choose another name");
  CHECK(contains(rude("nameless"), "plugin 'rude': a law has no name"));
  CHECK(contains(rude("no maker"), "plugin 'rude': law 'unmade' has no maker"));
  CHECK(contains(rude("bad key"), "plugin 'rude': law 'odd' cannot be registered"));
  CHECK(rude("std") == "plugin 'rude': its LOCKSTEP_PLUGIN function threw: no such cam");
  CHECK(rude("int") ==
        "plugin 'rude': its LOCKSTEP_PLUGIN function threw: an object of type int, which is not a std::exception");
  CHECK(rude("no words") ==
        "plugin 'rude': its LOCKSTEP_PLUGIN function threw: an object of type (anonymous namespace)::Silent without a "
        "message");
  CHECK(rude("foreign") == "plugin 'rude': its LOCKSTEP_PLUGIN function threw: something that is not a C++ exception");
  CHECK(contains(rude("bell"), "its help is not a plain line of text"));
  CHECK(contains(rude("latin"), "its name is not a plain line of text"));
  CHECK(contains(rude("key bell"), "the name of its key number 0 is not a plain line of text"));
  CHECK(rude("error") == "plugin 'rude': a model that cannot be");
  CHECK(rude("nested") == "plugin 'rude': cam.csv cannot be read: line 3 has no number");
  Registry with_probe = builtin_registry();
  load_plugin(with_probe, kProbe);
  CHECK(message_of<PluginError>([&] {
          load_plugin(with_probe, kProbe);
        }).ends_with("plugin 'probe': it is already loaded into this registry; load it once"));
  CHECK(rude("as probe", with_probe) ==
        "plugin 'rude': law 'probe_law' (plugin rude) is already registered (plugin probe); choose another name");
}

TEST_CASE("a plugin cannot claim to be built in", "[plugin][hostile]") {
  setenv("LOCKSTEP_TEST_RUDE", "built in", 1);
  Registry registry;
  load_plugin(registry, kModules + "/rude.so");
  unsetenv("LOCKSTEP_TEST_RUDE");
  REQUIRE(registry.laws.find("rude_law") != nullptr);
  CHECK(registry.laws.find("rude_law")->origin == "rude");
}

TEST_CASE("two registries in one process do not see each other", "[plugin]") {
  Registry one = builtin_registry(), other = builtin_registry();
  load_plugin(one, kProbe);
  CHECK(one.laws.find("probe_law") != nullptr);
  CHECK(other.laws.find("probe_law") == nullptr);
  const Registry copy = one;
  load_plugin(other, kModules + "/rude.so");
  CHECK(one.laws.find("rude_law") == nullptr);
  CHECK(copy.laws.find("rude_law") == nullptr);
  CHECK(other.laws.find("rude_law") != nullptr);
  CHECK(other.laws.find("probe_law") == nullptr);
}

TEST_CASE("a plugin stays one when it is stripped", "[plugin]") {
  const std::string file = plugin_file("stripped", "probe.so", bytes_of(kProbe));
  INFO("strip comes with the compilers (Debian: binutils)");
  REQUIRE(shell("strip --version").exit == 0);
  CHECK(shell("strip '" + file + "'").exit == 0);
  CHECK(bytes_of(file).size() < bytes_of(kProbe).size());
  CHECK(answer_of(file) == "loaded");
}

}  // namespace hostile_test
