// SPDX-License-Identifier: BSD-3-Clause
// Where plugins may come from: folders, links, who may write there, and what a scene may ask for.
#include <lockstep/author/loader.h>

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/scene.h>
#include "framework/description/registry/survey.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/plugin_files.h"
#include "tests/support/program.h"
#include "tests/support/thrown.h"

namespace search_test {

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;

namespace {

const std::string kProbe = kModules + "/probe.so", kArea = kModules + "/search";

// A fresh folder with copies of the probe.
std::string folder(const std::string& name, const std::vector<std::string>& files) {
  const std::string path = kArea + "/" + name;
  if (fs::exists(path)) fs::permissions(path, fs::perms(0755));
  fs::remove_all(path);
  fs::create_directories(path);
  fs::permissions(path, fs::perms(0755));
  for (const std::string& file : files) plugin_file("search/" + name, file, bytes_of(kProbe));
  return path;
}

const PluginCandidate* find(const std::vector<PluginCandidate>& all, const std::string& path) {
  const auto it = std::find_if(all.begin(), all.end(), [&](const auto& c) { return c.path == path; });
  return it == all.end() ? nullptr : &*it;
}

std::string scene_asking(const std::string& what) {
  return scene_file("asking", "\"requires\": " + what + R"(,
    "bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}])");
}

}  // namespace

TEST_CASE("of two files of one name the first folder's is taken", "[plugin][search]") {
  const std::string a = folder("a", {"twin.so"}), b = folder("b", {"twin.so", "libtwin.so", "single.so"});
  CHECK(find_plugin("twin", {a, b}) == fs::canonical(a + "/twin.so"));
  CHECK(find_plugin("twin", {b, a}) == fs::canonical(b + "/twin.so"));
  CHECK(find_plugin("libtwin", {a, b}) == fs::canonical(b + "/libtwin.so"));
  CHECK(find_plugin("single", {a, b}) == fs::canonical(b + "/single.so"));
  CHECK(find_plugin("single.so", {a, b}) == fs::canonical(b + "/single.so"));
  const std::vector<PluginCandidate> all =
      survey_plugins({a, b}, [](PluginCandidate& c) { ask_plugin(c, Registry{}); });
  REQUIRE(all.size() == 4);
  REQUIRE(find(all, b + "/twin.so") != nullptr);
  CHECK(find(all, a + "/twin.so")->state == PluginCandidate::State::loaded);
  for (const char* hidden : {"/twin.so", "/libtwin.so"}) {
    CHECK(find(all, b + hidden)->state == PluginCandidate::State::hidden);
    CHECK(contains(find(all, b + hidden)->why, a + "/twin.so comes first and is used"));
  }
}

TEST_CASE("a symbolic link may not lead out of the plugin folders", "[plugin][search]") {
  const std::string inside = folder("inside", {"real.so"}), outside = folder("outside", {"stray.so"});
  fs::create_symlink("real.so", inside + "/alias.so");
  fs::create_symlink(outside + "/stray.so", inside + "/leak.so");
  fs::create_symlink("../outside/stray.so", inside + "/climb.so");
  fs::create_symlink("nowhere.so", inside + "/dangling.so");
  CHECK(answer_of("alias", {inside}) == "loaded");
  for (const char* name : {"leak", "climb"}) {
    const std::string answer = answer_of(name, {inside});
    CHECK(contains(
        answer, "is not loaded: it is a link out of the plugin folders, to " + fs::canonical(outside + "/stray.so").string()));
  }
  CHECK(contains(answer_of("dangling", {inside}), "is not loaded: it is a broken symbolic link"));
  CHECK(answer_of("leak", {inside, outside}) == "loaded");  // that folder is allowed as well
  CHECK(answer_of(inside + "/leak.so") == "loaded");        // a path is the user's own word
  CHECK(contains(answer_of("..", {inside}), "plugin '..' not found"));
}

TEST_CASE("a plugin that others could change is not loaded by name", "[plugin][search]") {
  const std::string open = folder("open", {"mine.so"}), file = open + "/mine.so";
  CHECK(answer_of("mine", {open}) == "loaded");
  fs::permissions(open, fs::perms(0777));
  CHECK(contains(answer_of("mine", {open}), "is writable by all users; chmod o-w it"));
  CHECK(contains(answer_of("mine", {open}), "its folder " + fs::canonical(open).string()));
  CHECK(answer_of(file) == "loaded");  // by its path the user takes it all the same
  fs::permissions(open, fs::perms(01777));
  CHECK(contains(answer_of("mine", {open}), "is writable by all users"));
  fs::permissions(open, fs::perms(0755));
  fs::permissions(file, fs::perms(0646));
  CHECK(contains(answer_of("mine", {open}), "the file is writable by all users"));
  fs::permissions(file, fs::perms(0644));
  if (geteuid() != 0) {
    WARN("owners were not tried: only root can give files away");
    return;
  }
  REQUIRE(chown(file.c_str(), 54321, 0) == 0);
  CHECK(contains(answer_of("mine", {open}), "the file belongs to user 54321, neither you nor root"));
  REQUIRE(chown(file.c_str(), 0, 54321) == 0);
  CHECK(answer_of("mine", {open}) == "loaded");
  fs::permissions(file, fs::perms(0664));
  CHECK(contains(answer_of("mine", {open}), "the file is writable by group 54321, which is not yours"));
}

TEST_CASE("folders of that name and empty entries of the path are no plugins", "[plugin][search]") {
  const std::string odd = folder("odd", {"sound.so"});
  fs::create_directories(odd + "/folder.so");
  CHECK(contains(answer_of("folder", {odd}), "is not loaded: it is a folder"));
  setenv("LOCKSTEP_PLUGIN_PATH", ("::" + odd + "::/nowhere:").c_str(), 1);
  const std::vector<std::string> folders = plugin_folders();
  unsetenv("LOCKSTEP_PLUGIN_PATH");
  REQUIRE(folders.size() >= 2);
  CHECK(folders[0] == odd);
  CHECK(folders[1] == "/nowhere");
  CHECK(std::find(folders.begin(), folders.end(), "") == folders.end());
  CHECK(std::find(folders.begin(), folders.end(), ".") == folders.end());
}

TEST_CASE("a scene asks for plugins by bare name only", "[plugin][search][scene]") {
  for (const char* good : {"cam_follower", "libcam.so", "a-b.c+1"}) CHECK(is_bare_name(good));
  for (const char* bad : {"", "./x", "../x", "/tmp/x.so", "a/b", "..", ".x", "a b", "x;y", "~x", "$x", "a\\b"})
    CHECK_FALSE(is_bare_name(bad));
  for (const char* bad : {"./probe", "../test_plugins/probe.so", "/tmp/probe.so", "..", "a\\u0000b"}) {
    const std::string path = scene_asking("[\"" + std::string(bad) + "\"]");
    const std::string answer = thrown_by([&] { read_scene(path); });
    INFO(answer);
    CHECK(contains(answer, "SceneError: "));
    CHECK(contains(answer, "asking.json:2:14"));
    CHECK(contains(answer, "is not a bare name"));
    const Called r = call("check '" + path + "'");
    CHECK(r.exit == 3);
    CHECK(contains(r.text, "asking.json:2:14"));
  }
}

TEST_CASE("a scene cannot bring a plugin along, the command line can", "[plugin][search][scene][runner]") {
  const std::string beside = folder("beside", {"companion.so"});
  const std::string scene = scene_asking(R"(["companion"])");
  const std::string copy = beside + "/scene.json";
  fs::copy_file(scene, copy, fs::copy_options::overwrite_existing);
  // neither the scene's own folder nor the one that the program is called in is a plugin folder
  const Called lost = shell("cd '" + beside + "' && lockstep check scene.json");
  INFO(lost.text);
  CHECK(lost.exit == 4);
  CHECK(contains(lost.text, "plugin 'companion' not found; looked in "));
  CHECK(call("check '" + copy + "' --plugin '" + beside + "/companion.so'").exit == 0);
  CHECK(shell("cd '" + beside + "' && lockstep check scene.json --plugin ./companion.so").exit == 0);
  CHECK(call("check '" + copy + "'", "LOCKSTEP_PLUGIN_PATH='" + beside + "'").exit == 0);
  check_refused(call("check '" + copy + "' --plugin companion"), 4, {"plugin 'companion' not found; looked in "});
  CHECK(call("check '" + copy + "' --plugin companion", "LOCKSTEP_PLUGIN_PATH='" + beside + "'").exit == 0);
}

TEST_CASE("plugins list reports the state of every file", "[plugin][search][runner]") {
  const std::string one = folder("one", {"fine.so", "damaged.so", "widely.so"}), two = folder("two", {"fine.so"});
  const std::string bytes = bytes_of(kProbe);
  plugin_file("search/one", "damaged.so", bytes.substr(0, 8000));
  plugin_file("search/one", "loose.so", bytes);
  fs::permissions(one + "/widely.so", fs::perms(0666));
  fs::create_symlink("/etc/passwd", one + "/passwords.so");
  const std::string path = "LOCKSTEP_PLUGIN_PATH='" + one + ":" + two + ":/nowhere'";

  const Called brief = call("plugins", path);
  INFO(brief.text);
  CHECK(brief.exit == 0);
  CHECK(std::count(brief.text.begin(), brief.text.end(), '\n') >= 8);  // six here, and the built plugins
  CHECK(contains(brief.text, "loads     law probe_law"));
  CHECK(
      contains(brief.text, "\n  rejected damaged:\n    plugin file '" + one +
                               "/damaged.so' is not a shared library that can be loaded here: the file is truncated"));
  CHECK(contains(brief.text, "\n    hint: rebuild it with lockstep_add_plugin\n"));
  CHECK(contains(brief.text, "\n  rejected passwords:\n    it is a link out of the plugin folders, to /etc/passwd"));
  CHECK(contains(brief.text, "\n  rejected widely:\n    the file is writable by all users"));
  CHECK(contains(brief.text, "loads     joint cam_follower"));

  const Called alone = call("plugins list '" + one + "/damaged.so'");
  INFO(alone.text);
  CHECK(contains(alone.text, "rejected damaged:\n    plugin file"));
  CHECK_FALSE(contains(alone.text, "probe_law"));
  CHECK(contains(call("plugins list '" + one + "/fine.so'").text, "loads  law probe_law"));
  CHECK(contains(call("plugins --help").text, "Usage: lockstep plugins list [OPTIONS]"));
  const Called why = call("plugins list --why", path);
  INFO(why.text);
  CHECK(contains(value_of(why.text, "missing folders"), "/nowhere"));
  CHECK(contains(why.text, one + "/fine.so comes first and is used"));
  CHECK(contains(row_of(why.text, "loose"), one + "/loose.so "));
  CHECK_FALSE(contains(why.text, "0000000000000000"));  // of a file that was not read
  CHECK(contains(row_of(why.text, "widely"), " " + std::to_string(bytes.size())));
  CHECK(contains(row_of(why.text, "loose"), "law probe_law"));
  CHECK(value_of(why.text, "this host") == abi_words(abi_of_this_build()));

  const auto json = nlohmann::json::parse(call("plugins list --json", path).text);
  CHECK(json["folders"][0] == one);
  std::size_t n_refused = 0, n_hidden = 0;
  for (const auto& p : json["plugins"]) {
    n_refused += p["state"] == "rejected" ? 1u : 0u;
    n_hidden += p["state"] == "hidden" ? 1u : 0u;
    if (p["name"] == "loose") CHECK(p["brings"][0]["name"] == "probe_law");
  }
  CHECK(n_refused == 3);
  CHECK(n_hidden == 1);
}

}  // namespace search_test
