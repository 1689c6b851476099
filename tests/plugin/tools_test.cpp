// SPDX-License-Identifier: BSD-3-Clause
// The programs that `lockstep` calls: those of its libexec folder, any lockstep-NAME on the PATH, and what is said where one
// is missing.
#include <filesystem>
#include <fstream>
#include <string>

#include "framework/tools/program/tools.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace tools_test {

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;

TEST_CASE("every command of another program has its help, and appears in that of lockstep", "[runner]") {
  CHECK(call("help").text == call("--help").text);
  CHECK(call("help statics").text == call("statics --help").text);
  const std::string help = call("--help").text, manual = call("man").text;
  for (const Verb& verb : verbs()) {
    if (verb.program.empty()) continue;
    INFO(verb.name);
    CHECK(contains(help, "\n  " + std::string(verb.name) + " "));
    CHECK(contains(manual, "\n.SS \"lockstep " + std::string(verb.name)));
    const Called own = call(std::string(verb.name) + " --help");
    CHECK(own.exit == 0);
    CHECK(contains(own.text, std::string(verb.help)));
  }
}

TEST_CASE("each command appears in the manual once, and a flag may be written with a value", "[runner]") {
  const std::string manual = call("man").text, head = "\n.SS \"lockstep run ";
  CHECK(manual.find(head) != std::string::npos);
  CHECK(manual.find(head) == manual.rfind(head));
  const Called certified =
      call("run '" + kFourBar + "' --certify=true --until 0.05 --budget 2s --record certified.csv");
  INFO(certified.text);
  CHECK(contains(certified.text, "verified digits, log10(scale / difference), by "));
}

TEST_CASE("a missing program is reported with the way to install it", "[runner]") {
  const std::string nowhere = "LOCKSTEP_EXEC_PATH=/nowhere";
  check_refused(
      call("statics '" + kFourBar + "'", nowhere), 2,
      {"'statics' needs the program lockstep-analyses, which is neither '/nowhere/lockstep-analyses' nor on the PATH",
       "--target lockstep_analyses"});
  check_refused(call("run '" + kFourBar + "' --certify", nowhere), 2,
                {"--certify needs the program lockstep-measuring"});
  CHECK(call("check '" + kFourBar + "'", nowhere).exit == 0);
  const std::string folder = kRunnerFolder + "/refused";
  fs::create_directories(folder + "/lockstep-analyses");  // a folder cannot be started
  check_refused(call("statics '" + kFourBar + "'", "LOCKSTEP_EXEC_PATH='" + folder + "'"), 2,
                {"/refused/lockstep-analyses' cannot be started: Permission denied"});
  const Called completed = call("complete statics --", nowhere);
  CHECK(completed.exit == 0);
  CHECK(completed.text.empty());
  CHECK_FALSE(contains(call("man", nowhere).text, "lockstep statics"));
}

TEST_CASE("an external program is a command", "[runner]") {
  const std::string folder = kRunnerFolder + "/own";
  fs::create_directories(folder);
  std::ofstream(folder + "/lockstep-hello") << "#!/bin/sh\necho hello \"$@\"\nexit 7\n";
  fs::permissions(folder + "/lockstep-hello", fs::perms::owner_all);
  const Called own = call("hello you --too", "PATH=\"$PATH:" + folder + "\"");
  CHECK(own.exit == 7);
  CHECK(own.text == "hello you --too\n");
  check_refused(call("hello"), 2, {"unknown command \"hello\""});
  fs::remove_all(folder);
}

TEST_CASE("words of commands of other programs are completed", "[runner]") {
  CHECK(contains(call("complete stat").text, "statics"));
  CHECK(contains(call("complete statics --near").text, "--nearest"));
}

}  // namespace tools_test
