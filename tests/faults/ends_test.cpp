// SPDX-License-Identifier: BSD-3-Clause
// The program is ended, or what it writes to is full: by signals, a closed terminal, a limit to the size of files, a
// full standard output. Old results stay, what was computed stays beside them, and the exit code is a documented one.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "framework/tools/program/tools.h"
#include "tests/faults/failing.h"
#include "tests/support/open_defect.h"

namespace ends_test {

using namespace failing;

namespace {

// Of a run that never ends by itself.
std::string endless_scene(const std::string& name) {
  return arm_scene(name, R"("until": 1e6, "output": 0.01, "integrator": "rk4", "step": 0.01, "record": ["arm.x"])");
}

// A program of these words that the signal ends as soon as the file holds something; the exit code is its.
std::string ended_by(const std::string& signal, const std::string& words, const std::string& file) {
  return "lockstep " + words + " & p=$!; while [ ! -s '" + file +
         "' ] && kill -0 $p 2>/dev/null; do sleep 0.02; done; " + "sleep 0.2; kill -" + signal + " $p; wait $p";
}

}  // namespace

TEST_CASE("a run or sweep that a signal ends at any time leaves whole lines and the old results", "[faults]") {
  std::signal(SIGHUP, SIG_DFL);  // under nohup it is ignored, by the programs too
  const std::string scene = endless_scene("killed");
  const std::string old = kFolder + "/killed.csv", partial = old + ".partial";
  const std::string sweep = "sweep --jobs 2 --vary gravity.2=-9.81:-1:100000 --until 10";
  const int rounds = std::getenv("LOCKSTEP_FAULTS") != nullptr ? 40 : 3;
  for (const std::string& verb : {std::string("run --quiet"), sweep + " --quiet"})
    for (const char* signal : {"KILL", "TERM", "HUP"})
      for (int k = 0; k < rounds; ++k) {
        std::ofstream(old) << kOld;
        fs::remove(partial);
        const std::string wait = std::to_string(0.02 + 0.17 * k + 0.013 * (k % 7));
        const Called r = shell("lockstep " + verb + " '" + scene + "' --record '" + old + "' & sleep " + wait +
                               "; kill -" + signal + " $!; wait $!");
        INFO(verb << ", " << signal << " after " << wait << " s, exit code " << r.exit << ":\n" << r.text);
        // Killed, or before the program had its handlers ready by the signal itself; else in good order.
        const int number = signal == std::string("KILL") ? 9 : signal == std::string("TERM") ? 15 : 1;
        CHECK((r.exit == 128 + number || (number != 9 && r.exit == 130)));
        CHECK(bytes_of(old) == kOld);
        check_rows(partial, number == 9);
        if (r.exit == 130) CHECK(fs::exists(partial));
        if (r.exit == 130) CHECK(contains(r.text, "in " + partial));
      }
  fs::remove(partial);
}

// Of many rows and of few: steps a thousand times shorter.
TEST_CASE("the file of a run grows every second", "[faults]") {
  const std::string few =
      arm_scene("few_rows", R"("until": 1e3, "output": 0.01, "integrator": "rk4", "step": 1e-5, "record": ["arm.x"])");
  for (const std::string& scene : {endless_scene("many_rows"), few}) {
    const std::string file = kFolder + "/every_second.csv", partial = file + ".partial";
    fs::remove(partial);
    const Called r =
        shell("lockstep run '" + scene + "' --quiet --record '" + file + "' & sleep 3; kill -KILL $!; wait $!");
    const std::chrono::duration<double> age = fs::file_time_type::clock::now() - fs::last_write_time(partial);
    INFO(scene << '\n' << r.text);
    CHECK(r.exit == 128 + 9);
    CHECK(age.count() < 2.5);  // a second, and what a busy machine takes
    check_rows(partial, true);
    const std::string rows = bytes_of(partial);
    CHECK(std::count(rows.begin(), rows.end(), '\n') > 10);
  }
}

TEST_CASE("pictures and reports of a run that is interrupted replace no older ones", "[faults]") {
  const std::string scene = endless_scene("pages"), base = kFolder + "/pages";
  const std::vector<std::string> old = {base + ".csv", base + ".svg", base + ".png", base + ".html"};
  const std::string sweep = "sweep --jobs 1 --vary gravity.2=-9.81:-1:10000 --until 100";
  for (const std::string& verb : {std::string("run"), sweep}) {
    for (const std::string& file : old) std::ofstream(file) << kOld;
    for (const char* left : {".csv.partial", ".partial.html"}) fs::remove(base + left);
    const std::string words = verb + " '" + scene + "' --record '" + old[0] + "' --report '" + old[3] + "'";
    const Called r = shell(ended_by("TERM", words, base + ".csv.partial"));
    INFO(words << ", exit code " << r.exit << ":\n" << r.text);
    CHECK(r.exit == 130);
    for (const std::string& file : old) CHECK(bytes_of(file) == kOld);
    check_rows(base + ".csv.partial");
    CHECK(contains(bytes_of(base + ".partial.html"), "<html"));
    CHECK(contains(r.text, base + ".partial.html"));
  }
  fs::remove(base + ".csv.sweep");
}

// As when its window is closed: neither of its streams can be written any more.
TEST_CASE("a run or sweep whose terminal is closed ends by 130 and leaves its results", "[faults]") {
  std::signal(SIGHUP, SIG_DFL);  // under nohup it is ignored, by the programs too
  const std::string scene = endless_scene("closed"), old = kFolder + "/closed.csv", partial = old + ".partial";
  for (const std::string verb : {"run", "run --json", "sweep --jobs 1 --vary gravity.2=-9.81:-1:10000 --until 100"}) {
    std::ofstream(old) << kOld;
    fs::remove(partial);
    const std::string words = verb + " '" + scene + "' --record '" + old + "' > /dev/full 2> /dev/full";
    const Called r = shell(ended_by("HUP", words, partial));
    INFO(words << ", exit code " << r.exit << ":\n" << r.text);
    CHECK(r.exit == 130);
    CHECK(bytes_of(old) == kOld);
    CHECK(bytes_of(partial).size() > 10);
    check_rows(partial);
  }
}

TEST_CASE("a file that reaches the limit of its size is an error of files, with whole lines", "[faults]") {
  const std::string scene = endless_scene("limit"), old = kFolder + "/limit.csv", partial = old + ".partial";
  std::ofstream(old) << kOld;
  fs::remove(partial);
  // The limit applies to the counts of gcov too (tests/coverage): a cut one would spoil all later ones, so none is written.
  const Called r = shell("ulimit -f 200; GCOV_PREFIX=/dev/null timeout 60 lockstep run '" + scene +
                         "' --quiet --record '" + old + "'");
  INFO(r.exit << ":\n" << r.text);
  CHECK(r.exit == 8);
  CHECK(contains(r.text, "limit.csv.partial' cannot be written"));
  CHECK(bytes_of(old) == kOld);
  check_rows(partial);
  // Those that fit are there: a row has less than 100 bytes, a block of the limit 512 or 1024.
  const std::string rows = bytes_of(partial);
  REQUIRE(rows.size() > 200 * 512 - 100);
  CHECK(rows.back() == '\n');
}

TEST_CASE("every command that prints reports a full standard output", "[faults]") {
  const std::string scene = arm_scene("full", kShort);
  std::vector<std::string> all = {"check '" + scene + "'",
                                  "check --json '" + scene + "'",
                                  "list",
                                  "schema",
                                  "describe revolute",
                                  "assemble '" + scene + "'",
                                  "run '" + scene + "' --record '" + kFolder + "/full.csv'",
                                  "run '" + scene + "' --json --record '" + kFolder + "/full.csv'",
                                  "--help",
                                  "--version",
                                  "complete ''"};
  for (const Verb& verb : verbs()) all.push_back(std::string(verb.name) + " --help");
  CHECK(all.size() > 30);
  for (const std::string& words : all) {
    const Called r = shell("lockstep " + words + " > /dev/full");
    INFO(words << ": " << r.exit << '\n' << r.text);
    CHECK(r.exit == 8);
    CHECK(contains(r.text, "standard output"));
  }
}

// Nobody reads for half a second, so that what is printed waits in the pipe, where signals meet it.
TEST_CASE("text that a signal interrupts on its way to standard output is written again", "[defect][a small program]") {
  fs::create_directories(kFolder);
  const std::string file = kFolder + "/interrupted.txt", ended = kFolder + "/interrupted_exit.txt";
  const auto printed = [&](const std::string& wish) {
    shell("{ LOCKSTEP_FAIL='" + wish + "' LD_PRELOAD='" + kFailing + "' lockstep schema; echo $? > '" + ended +
          "'; } | { sleep 0.5; cat; } > '" + file + "'");
    return std::pair{bytes_of(ended), bytes_of(file)};
  };
  const auto [quiet, whole] = printed("");
  CHECK(quiet == "0\n");
  REQUIRE(whole.size() > 1 << 16);  // more than a pipe holds
  const auto [code, text] = printed("alarm:50");
  CAPTURE(code, whole.size(), text.size());
  CHECK(whole.starts_with(text.substr(0, 1 << 12)));
  expect_defect("signals during a write to standard output", "A small program",
                code == "8\n" && text.size() < whole.size(), code == "0\n" && text == whole);
}

TEST_CASE("signals while plugins are asked change nothing", "[faults]") {
  const std::string words = "plugins list --why";
  const Called quiet = with_failing("", words), disturbed = with_failing("alarm:1", words);
  CHECK(quiet.exit == 0);
  CHECK(contains(quiet.text, "bump"));
  CHECK(disturbed.exit == quiet.exit);
  CHECK(disturbed.text == quiet.text);
}

}  // namespace ends_test
