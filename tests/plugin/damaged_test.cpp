// SPDX-License-Identifier: BSD-3-Clause
// Plugins that end the process that opens them, that change while a host runs, that were built otherwise, and those that
// read files.
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include <lockstep/author/loader.h>
#include <lockstep/error.h>
#include "framework/foundation/support/hash.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/paths.h"
#include "tests/support/plugin_files.h"
#include "tests/support/program.h"
#include "tests/support/thrown.h"

namespace damaged_test {

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;

namespace {

std::string empty_folder(const std::string& name) {
  fs::remove_all(kModules + "/" + name);
  fs::create_directories(kModules + "/" + name);
  return kModules + "/" + name;
}

// What `plugins list` says of the files of this folder, by their names.
std::map<std::string, nlohmann::json> listed(const std::string& folder, const std::string& before = {}) {
  const Called r = call("plugins list --json", before + " LOCKSTEP_PLUGIN_PATH='" + folder + "'");
  INFO(r.text);
  REQUIRE(r.exit == 0);
  std::map<std::string, nlohmann::json> all;
  const auto json = nlohmann::json::parse(r.text);
  for (const auto& p : json["plugins"])
    if (p["folder"] == folder) all[p["name"]] = p;
  return all;
}

}  // namespace

TEST_CASE("a plugin that ends the process that opens it is listed with what happened", "[plugin][damaged]") {
  const std::string folder = empty_folder("deadly");
  const std::string file = plugin_file("deadly", "deadly.so", bytes_of(test_plugin("deadly")));
  plugin_file("deadly", "zeal.so", bytes_of(test_plugin("probe")));
  struct Case {
    const char *how, *says;
  };
  for (const auto& [how, says] : {Case{"segv", "SIGSEGV (Segmentation fault)"},
                                  {"ill", "SIGILL (Illegal instruction)"},
                                  {"abort", "SIGABRT (Aborted): a constructor of a global object may have thrown"},
                                  {"alarm", "no answer within 10 s"},
                                  {"exit", "exit code 3 without an answer"},
                                  {"quiet", "exit code 0 without an answer"},
                                  {"late", "SIGABRT (Aborted): a constructor of a global object may have thrown"}}) {
    INFO(how);
    auto all = listed(folder, std::string("LC_ALL=C LOCKSTEP_TEST_DEADLY=") + how);
    REQUIRE(all.size() == 2);
    CHECK(all["deadly"]["state"] == "rejected");
    CHECK(all["deadly"]["size"] == std::filesystem::file_size(file));  // read without opening it
    CHECK(all["deadly"]["checksum"] != "0000000000000000");
    CHECK(contains(all["deadly"]["build"].get<std::string>(), "ABI "));
    CHECK(all["deadly"]["why"] == "plugin file '" + file + "' ended the process that opened it: " + says +
                                      "; the file is damaged, or its code is wrong; build or install it again");
    CHECK(all["zeal"]["state"] == "loads");  // the list goes on
    CHECK(all["zeal"]["brings"][0]["name"] == "probe_law");
  }
  CHECK(listed(folder, "LOCKSTEP_TEST_DEADLY=memory")["deadly"]["why"] ==
        "plugin file '" + file + "': opening it threw: std::bad_alloc");
  CHECK(listed(folder)["deadly"]["brings"][0]["name"] == "deadly_law");
  const Called why = call("plugins list --why", "LOCKSTEP_TEST_DEADLY=segv LOCKSTEP_PLUGIN_PATH='" + folder + "'");
  INFO(why.text);
  CHECK(contains(why.text, "deadly           rejected"));
  CHECK(contains(why.text, file));
  CHECK(contains(why.text, "SIGSEGV"));
}

// LOCKSTEP_MUTANTS: how many; plugin.mutants.long tries 300.
TEST_CASE("no changed byte of a plugin ends the list", "[plugin][damaged]") {
  const char* wish = std::getenv("LOCKSTEP_MUTANTS");
  const int n = wish == nullptr ? 20 : std::atoi(wish), n_batch = 20;
  const std::string sound = bytes_of(built_plugin("cam_follower"));
  constexpr std::size_t kLoaded = 1 << 17;  // what lies behind may be words for debuggers
  int n_loaded = 0, n_refused = 0, n_ended = 0;
  for (int first = 0; first < n; first += n_batch) {
    const std::string folder = empty_folder("bytes");
    plugin_file("bytes", "sound.so", sound);
    for (int seed = first; seed < first + n_batch; ++seed) {
      std::mt19937_64 bits(static_cast<unsigned>(seed));
      std::string bytes = sound;
      bytes[bits() % std::min<std::size_t>(bytes.size(), kLoaded)] ^= static_cast<char>(1 + bits() % 255);
      plugin_file("bytes", "seed" + std::to_string(seed) + ".so", bytes);
    }
    const auto all = listed(folder);
    CHECK(all.size() == n_batch + 1);
    CHECK(all.at("sound")["state"] == "loads");
    for (const auto& [name, p] : all) {
      if (name == "sound") continue;
      const std::string why = p["why"];
      INFO(name << ": " << why);
      CHECK((p["state"] == "loads") == why.empty());
      if (why.empty())
        ++n_loaded;
      else
        ++(contains(why, "ended the process") ? n_ended : n_refused);
      if (!why.empty()) CHECK(contains(why, name));
    }
  }
  WARN(n << " changed files: " << n_loaded << " load, " << n_refused << " are refused, " << n_ended
         << " end the process that opens them");
  CHECK(n_loaded > 0);
  CHECK(n_refused + n_ended > 0);
  fs::remove_all(kModules + "/bytes");
}

TEST_CASE("the checksum of files is FNV-1a", "[plugin][damaged]") {  // values of its authors
  CHECK(hash_of("") == 0xcbf29ce484222325u);
  CHECK(hash_of("a") == 0xaf63dc4c8601ec8cu);
  CHECK(hash_of("foobar") == 0x85944171f73967e8u);
  CHECK(hash_of("bar", hash_of("foo")) == hash_of("foobar"));
}

TEST_CASE("size and checksum of a plugin are kept before it is opened", "[plugin][damaged]") {
  empty_folder("kept");
  const std::string sound = bytes_of(test_plugin("probe")), longer = sound + "one byte more, which no loader reads";
  const std::string file = plugin_file("kept", "kept.so", sound);
  const PluginStamp stamp = check_plugin_file(file);
  CHECK(stamp.size == sound.size());
  CHECK(stamp.checksum == hash_of(sound));
  CHECK(listed(kModules + "/kept")["kept"]["size"] == sound.size());

  plugin_file("kept", "kept.so", longer);  // between the check and the load
  unsetenv("LOCKSTEP_TEST_PROBE");
  const std::string other = thrown_by([&] {
    Registry registry;
    load_plugin(registry, file, {}, stamp);
  });
  check_words(
      other, {"PluginError: plugin 'kept': " + file + " has " + std::to_string(longer.size()) + " bytes with checksum ",
              ", expected " + std::to_string(sound.size()) + " bytes with checksum ",
              "; install the file again, or update the expected stamp"});
  CHECK(std::getenv("LOCKSTEP_TEST_PROBE") == nullptr);  // none of its code ran

  plugin_file("kept", "kept.so", sound);
  Registry first, second, third;
  load_plugin(first, file, {}, stamp);
  load_plugin(second, file);  // as it was
  fs::remove(file);           // the code stays mapped
  plugin_file("kept", "kept.so", longer);
  const std::string changed = thrown_by([&] { load_plugin(third, file); });
  check_words(changed,
              {"plugin 'kept': " + file + " has " + std::to_string(longer.size()) + " bytes",
               "this process loaded it with " + std::to_string(sound.size()) + " bytes", "; restart the process"});
  CHECK(third.laws.names().empty());
}

TEST_CASE("a plugin built without lockstep's flags is rejected in one sentence", "[plugin][damaged]") {
  for (const char* name : {"unset", "unlinked"}) {
    const std::string answer = answer_of(test_plugin(name));
    INFO(answer);
    CHECK(contains(answer, std::string("plugin '") + name + "'"));
    CHECK_FALSE(contains(answer, "_ZN"));
    CHECK(contains(answer,
                   "rebuild the plugin against this lockstep, by lockstep_add_plugin() or with the flags of "
                   "lockstep.pc"));
  }
  CHECK(contains(answer_of(test_plugin("unset")),
                 "built for settings malloc-already-aligned, this host is settings none"));
  CHECK(contains(answer_of(test_plugin("unlinked")), "it needs 'lockstep::gone_since("));
}

TEST_CASE("files of laws, joints and forces of plugins are looked for in the scene's folder", "[plugin][damaged]") {
  const std::string folder = kRunnerFolder + "/with_files";
  fs::create_directories(folder + "/data");
  std::ofstream(folder + "/data/word.txt") << "the_word_of_the_scene";
  std::ofstream(folder + "/data/table.csv") << "t,y\n0,0\n1,2\n2.5,3\n";
  fs::remove_all(kRunnerFolder + "/data");  // in the shell's folder there is none
  const auto refusal = [&](const std::string& link, const std::string& force) {
    std::ofstream(folder + "/scene.json") << R"({"lockstep": 1, "requires": ["reader"], )" << kArm << R"("links": [)"
                                          << link << R"(], "forces": [)" << force << "]}";
    return call("check with_files/scene.json", "LOCKSTEP_PLUGIN_PATH='" + kModules + "'").text;
  };
  const auto driven = [](const std::string& law) {
    return "{" + kHinge + R"(, "drive": {"axis": "rz", "law": {"type": ")" + law + "\"}}}";
  };
  const std::string word = R"(", "file": "data/word.txt)", table = R"(", "file": "data/table.csv)";
  const std::string link =
      R"({"name": "L", "type": "reading_link", "p": "arm", "s": "ground", "at": [0, 0, 0], "file": "data/word.txt"})";
  const std::string force =
      R"({"name": "F", "type": "reading_force", "p": "arm", "at": [0, 0, 0], "file": "data/word.txt"})";
  check_words(refusal(driven("reading_law" + word), ""), {"file: holds the_word_of_the_scene"});
  check_words(refusal(link, ""), {"file: holds the_word_of_the_scene"});
  check_words(refusal("", force), {"file: holds the_word_of_the_scene"});
  check_words(refusal(driven("table_law" + table), ""), {"file: ends at 2.5"});
}

}  // namespace damaged_test
