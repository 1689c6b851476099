// SPDX-License-Identifier: BSD-3-Clause
// Forces of plugins whose energies are no numbers, and plugins that change while a run waits.
#include <filesystem>
#include <fstream>
#include <string>

#include <lockstep/author/loader.h>
#include <lockstep/author/registry.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/plugin_files.h"
#include "tests/support/program.h"
#include "tests/support/run_with_registry.h"
#include "tests/support/thrown.h"

namespace refused_plugins_test {

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;

TEST_CASE("a force of a plugin whose energy is no number is named, with the energy and the time",
          "[plugin][user_code]") {
  Registry registry = builtin_registry();
  load_plugin(registry, test_plugin("naughty"));
  const auto run = [&](const std::string& does, const std::string& record) {
    const std::string path =
        scene_file("energy", kArm + R"("forces": [{"name": "K", "type": "naughty_force", "p": "arm", "at": [0, 0, 0],
      "does": ")" + does + R"("}], "run": {"integrator": "rk4", "step": 0.01, "until": 0.2, "record": [)" +
                                 record + "]}");
    return thrown_by([&] { run_with_registry(registry, path); });
  };
  const std::string whose = "force 'K' (naughty_force of plugin naughty): its energy is not finite: ";
  check_words(run("nan potential", R"("energy.total")"), {"NonFiniteError: t = 0.05", whose + "potential() is nan"});
  check_words(run("nan dissipation", R"("energy.balance")"),
              {"NonFiniteError: t = 0.0", whose + "dissipation() is nan"});
  check_words(run("nan supply", R"("energy.balance")"), {"NonFiniteError: t = 0.0", whose + "supply() is nan"});
  for (const char* does : {"nan potential", "nan dissipation", "nan supply"}) CHECK(run(does, "") == "nothing");
  CHECK(run("", R"("energy.total", "energy.balance")") == "nothing");

  const std::string scene = kRunnerFolder + "/energy.json";  // the program asks for energies on its own
  scene_file("energy", kArm + R"("forces": [{"name": "K", "type": "naughty_force", "p": "arm", "at": [0, 0, 0],
      "does": "nan potential"}], "run": {"until": 0.2, "output": 0.01})");
  const Called r = call("run '" + scene + "' --record energy.csv --plugin '" + test_plugin("naughty") + "'");
  INFO(r.text);
  CHECK(r.exit != 0);
  CHECK(contains(r.text, whose + "potential() is nan"));
}

TEST_CASE("the table that was saved is reported after the error of code that threw", "[plugin][user_code]") {
  const std::string scene = kRunnerFolder + "/throws.json";
  scene_file("throws", kArm + R"("forces": [{"name": "K", "type": "naughty_force", "p": "arm", "at": [0, 0, 0],
      "does": "std"}], "run": {"until": 0.2, "output": 0.01, "record": ["arm.x"]})");
  const Called r = call("run '" + scene + "' --record throws.csv --plugin '" + test_plugin("naughty") + "'");
  INFO(r.text);
  CHECK(r.exit != 0);
  REQUIRE(contains(r.text, "  saved: "));
  CHECK(contains(r.text, " threw: no more\n  saved: "));
}

TEST_CASE("a run is not gone on with when a plugin of it was changed since", "[runner]") {
  const std::string sound = bytes_of(test_plugin("naughty"));
  const std::string plugin = plugin_file("waiting", "naughty.so", sound);
  const std::string file = kRunnerFolder + "/waiting.csv", saved = kRunnerFolder + "/waiting.checkpoint";
  for (const std::string& old : {file, file + ".partial", saved}) fs::remove(old);
  const std::string scene =
      scene_file("waiting", kArm + R"("forces": [{"name": "K", "type": "naughty_force", "p": "arm", "at": [0, 0, 0]}],
    "run": {"until": 1e5, "output": 0.05, "integrator": "rk4", "step": 0.01, "record": ["arm.x"]})");
  shell("lockstep run '" + scene + "' --plugin '" + plugin + "' --no-picture --quiet --record '" + file +
        "' --checkpoint '" + saved + "' --every 0.02s & for k in $(seq 1000); do sleep 0.01; [ -s '" + saved +
        "' ] && break; done; kill -TERM $!; wait $!");
  REQUIRE(fs::exists(saved));
  const auto put = [&](const std::string& bytes) { std::ofstream(plugin, std::ios::binary) << bytes; };
  put(sound + "one byte more at its end, which no loader reads");
  const Called changed = call("resume '" + saved + "'");
  INFO(changed.text);
  CHECK(changed.exit == 8);
  CHECK(contains(changed.text, "checkpoint '" + saved + "': a plugin of scene '" + scene +
                                   "' has changed; restore it, or run again"));
  CHECK(fs::exists(saved));
  CHECK(fs::exists(file + ".partial"));
  put(sound);  // as it was: it goes on
  const Called again = shell("lockstep resume '" + saved + "' & sleep 0.5; kill -TERM $!; wait $!; [ -e '" + saved +
                             "' ] && echo saved again");
  INFO(again.text);
  CHECK_FALSE(contains(again.text, "was changed since"));
  CHECK(contains(again.text, "saved again"));
  for (const std::string& old : {file, file + ".partial", saved}) fs::remove(old);
}

}  // namespace refused_plugins_test
