// SPDX-License-Identifier: BSD-3-Clause
// The system fails under the program: writing, fsync, rename and kill -9. It ends by a documented exit code with a
// sentence, old results are never lost, and what was computed is gone on with.
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "framework/tools/program/run_checkpoint.h"
#include "tests/faults/failing.h"

namespace faults_test {

using namespace failing;

TEST_CASE("a disk that is full, cannot be synchronised or forbids the name costs no old result", "[faults]") {
  const std::string scene = arm_scene("disk", kShort), old = kFolder + "/disk.csv";
  for (const std::string verb : {"run", "sweep --jobs 1 --vary gravity.2=-9.81,-1.62"}) {
    const std::string words = verb + " '" + scene + "' --record '" + old + "'";
    const std::vector<long> counts = counts_of(words);
    for (std::size_t kind = 1; kind < 4; ++kind) {
      CHECK(counts[kind] > 0);
      for (long k = 1; k <= counts[kind]; ++k) {
        std::ofstream(old) << "t,old\n0,1\n";
        fs::remove(old + ".partial");
        const Called r = with_failing(kCalls[kind] + ":" + std::to_string(k), words);
        INFO(verb << ", " << kCalls[kind] << ":" << k << ", exit code " << r.exit << ":\n" << r.text);
        CHECK(r.exit == 8);
        CHECK(contains(r.text, "disk.csv"));
        CHECK(bytes_of(old) == "t,old\n0,1\n");
        check_rows(old + ".partial");
      }
    }
  }
  fs::remove(old + ".partial");
}

TEST_CASE("a checkpoint on a full disk is reported, and an existing one remains whole", "[faults]") {
  const std::string scene = arm_scene("checkpoint", kShort), table = kFolder + "/checkpoint.csv";
  const std::string saved = kFolder + "/checkpoint.saved";
  const std::string words = "run '" + scene + "' --record '" + table + "' --checkpoint '" + saved + "' --every 1e-9s";
  const std::vector<long> counts = counts_of(words);
  const std::string whole = bytes_of(table);
  CHECK_FALSE(fs::exists(saved));
  long resumed = 0;
  for (std::size_t kind = 1; kind < 4; ++kind) {
    long of_checkpoints = 0;
    for (long k = 1; k <= counts[kind]; ++k) {
      for (const std::string& name : {table, table + ".partial", saved}) fs::remove(name);
      const Called r = with_failing(kCalls[kind] + ":" + std::to_string(k), words);
      INFO(kCalls[kind] << ":" << k << ", exit code " << r.exit << ":\n" << r.text);
      CHECK(r.exit == 8);
      CHECK((contains(r.text, "checkpoint '") || contains(r.text, "checkpoint.csv")));
      of_checkpoints += contains(r.text, "checkpoint '") ? 1 : 0;
      CHECK_FALSE(fs::exists(saved + ".partial"));
      if (!fs::exists(saved)) continue;
      const Called again = call("resume '" + saved + "'");
      INFO(again.text);
      CHECK(again.exit == 0);
      CHECK((bytes_of(table) == whole));
      ++resumed;
    }
    INFO(kCalls[kind]);
    CHECK(of_checkpoints >= 3);
  }
  CHECK(resumed >= 3);
}

TEST_CASE("a resumed sweep accepts only a table with its columns", "[faults]") {
  const std::string scene = arm_scene("columns", kShort), table = kFolder + "/columns.csv";
  const std::string words = "sweep --jobs 1 --vary gravity.2=-9.81,-1.62 '" + scene + "' --record '" + table + "'";
  const std::vector<long> counts = counts_of(words);
  fs::remove(table);
  CHECK(with_failing("rename:" + std::to_string(counts[3]), words).exit == 8);
  const std::string rows = bytes_of(table + ".partial");
  REQUIRE(rows.starts_with("run,"));
  std::ofstream(table + ".partial", std::ios::trunc | std::ios::binary) << "row," << rows.substr(4);
  const Called other = call(words + " --resume");
  INFO(other.text);
  CHECK(other.exit == 8);
  CHECK(contains(other.text, "does not hold the rows of this sweep"));
  CHECK(bytes_of(table + ".partial").starts_with("row,"));
  std::ofstream(table + ".partial", std::ios::trunc | std::ios::binary) << rows;
  CHECK(call(words + " --resume").exit == 0);
  CHECK(bytes_of(table).starts_with("run,"));
}

TEST_CASE("a run that kill -9 ends at any time resumes from its checkpoint to the same table", "[faults]") {
  struct Kind {
    const char *name, *run;
  };
  const Kind kinds[] = {
      {"again_rk4",
       R"("until": 6000, "output": 0.2, "integrator": "rk4", "step": 0.01, "record": ["arm.angle_z", "energy.total"])"},
      {"again_dop853",
       R"("until": 12000, "output": 0.4, "integrator": "dop853", "tolerance": 1e-9, "record": ["arm.angle_z", "A.force_on_p_world_y"])"}};
  const int rounds = std::getenv("LOCKSTEP_FAULTS") != nullptr ? 20 : 3;
  for (const Kind& kind : kinds) {
    const std::string scene = arm_scene(kind.name, kind.run), base = kFolder + "/" + kind.name;
    const std::string file = base + ".csv", saved = base + ".checkpoint";
    const auto begin = std::chrono::steady_clock::now();
    REQUIRE(call("run '" + scene + "' --no-picture --record '" + file + "'").exit == 0);
    const std::chrono::duration<double> length = std::chrono::steady_clock::now() - begin;
    const std::string whole = bytes_of(file);
    REQUIRE(whole.size() > 100000);
    long resumed = 0;
    for (int k = 0; k < rounds; ++k)
      for (const char* signal : {"KILL", "TERM"}) {
        for (const std::string& name : {file, file + ".partial", saved}) fs::remove(name);
        // From its first checkpoint on, twice before its end, however fast the machine is.
        const std::string wait = std::to_string(length.count() * (0.01 + 0.4 * k / rounds));
        const auto ended = [&](const std::string& words) {
          return shell("lockstep " + words + " & p=$!; while [ ! -e '" + saved + "' ] && kill -0 $p 2>/dev/null; do " +
                       "sleep 0.005; done; sleep " + wait + "; kill -" + signal + " $p 2>/dev/null; wait $p");
        };
        ended("run '" + scene + "' --no-picture --record '" + file + "' --checkpoint '" + saved + "' --every 0.02s");
        if (fs::exists(saved)) ended("resume '" + saved + "'");
        while (fs::exists(saved)) {
          const Called r = call("resume '" + saved + "'");
          INFO(kind.name << ", " << signal << " after " << wait << " s:\n" << r.text);
          REQUIRE(r.exit == 0);
          CHECK(contains(r.text, "resumed    at t = "));
          ++resumed;
        }
        if (!fs::exists(file)) continue;  // ended before its first checkpoint
        CHECK((bytes_of(file) == whole));
        CHECK_FALSE(fs::exists(file + ".partial"));
      }
    CHECK(resumed >= rounds);
  }
}

// A crank and rocker in space with a spring that comes and goes; all that watches a run is on.
TEST_CASE("additions of the program to a run are resumed with it", "[faults]") {
  const auto scene_with = [](const std::string& name, const std::string& method) {
    fs::create_directories(kFolder);
    const std::string path = kFolder + "/" + name + ".json";
    std::ofstream(path) << R"({"lockstep": 1, "gravity": [0.3, -9.81, 0], "planar": "off",
  "bodies": [
    {"name": "crank", "rod": {"mass": 0.5, "from": [0, 0, 0], "to": [0.06, 0.08, 0], "radius": 0.01}},
    {"name": "coupler", "rod": {"mass": 1.2, "from": [0.06, 0.08, 0], "to": [0.3, 0.25, 0], "radius": 0.01}},
    {"name": "rocker", "rod": {"mass": 0.9, "from": [0.28, 0, 0], "to": [0.3, 0.25, 0], "radius": 0.01}}],
  "markers": [{"name": "tip", "body": "rocker", "world_at": [0.3, 0.25, 0]},
              {"name": "hook", "body": "ground", "world_at": [0.6, 0.3, 0]}],
  "links": [
    {"name": "A", "type": "revolute", "p": "crank", "s": "ground", "at": [0, 0, 0], "start": {"velocity": {"rz": 9}}},
    {"name": "B", "type": "revolute", "p": "coupler", "s": "crank", "at": [0.06, 0.08, 0]},
    {"name": "C", "type": "revolute", "p": "rocker", "s": "coupler", "at": [0.3, 0.25, 0]},
    {"name": "D", "type": "revolute", "p": "rocker", "s": "ground", "at": [0.28, 0, 0]}],
  "forces": [{"name": "spring", "type": "spring_damper", "p": "tip", "s": "hook", "stiffness": 2, "damping": 0.01,
              "free_length": 0.2}],
  "events": [
    {"name": "off", "when": {"channel": "crank.y", "crosses": 0, "direction": "falling"}, "once": false, "deactivate": ["spring"]},
    {"name": "on", "when": {"channel": "crank.y", "crosses": 0, "direction": "rising"}, "once": false, "activate": ["spring"]}],
  "run": {)" << method << R"(, "output": 0.1, "record": ["rocker.angle_z", "C.force_on_p_world_x", "energy.total"]}})";
    return path;
  };
  const std::pair<const char*, const char*> kinds[] = {
      {"added_rk4", R"("until": 60, "integrator": "rk4", "step": 0.001)"},
      {"added_dop853", R"("until": 60, "integrator": "dop853", "tolerance": 1e-10)"}};
  for (const auto& [name, method] : kinds) {
    const std::string file = kFolder + "/" + name + ".csv", saved = kFolder + "/" + name + ".checkpoint";
    const std::string words = "run '" + scene_with(name, method) + "' --json --at-jumps --record '" + file + "'";
    for (const std::string& old : {file, file + ".partial", saved}) fs::remove(old);
    const auto numbers_of = [](const Called& r) {
      nlohmann::json j = nlohmann::json::parse(r.text);
      for (const char* own : {"seconds", "command", "files", "resumed_at", "assembled", "notes"}) j.erase(own);
      return j;
    };
    const Called whole = call(words + " 2>/dev/null");
    INFO(name << "\n" << whole.text);
    const nlohmann::json expected = numbers_of(whole);
    CHECK(expected["energy"]["instants"].size() >= 1);
    const std::string rows = bytes_of(file);
    fs::remove(file);
    shell("lockstep " + words + " --checkpoint '" + saved +
          "' --every 0.02s >/dev/null 2>&1 & for k in $(seq 1000); do sleep 0.01; [ -s '" + saved +
          "' ] && break; done; sleep 0.05; kill -TERM $!; wait $!");
    REQUIRE(fs::exists(saved));
    RunCheckpoint checkpoint = RunCheckpoint::read(saved);
    CHECK(checkpoint.seconds > 0);
    checkpoint.seconds = 1000;  // those of the rest are added
    checkpoint.write(saved);
    // The second without the gnuplot that may have been there when it began.
    const Called rest =
        call("resume '" + saved + "' 2>/dev/null", name == std::string("added_rk4") ? "" : "PATH=/nowhere");
    INFO(rest.text);
    CHECK(rest.exit == whole.exit);
    CHECK(numbers_of(rest) == expected);
    CHECK(nlohmann::json::parse(rest.text)["seconds"].get<double>() > 1000);
    CHECK((bytes_of(file) == rows));
  }
}

TEST_CASE("a checkpoint is rejected when the scene, its table or the file itself have changed", "[faults]") {
  const std::string scene =
      arm_scene("changed", R"("until": 1e5, "output": 0.05, "integrator": "rk4", "step": 0.01, "record": ["arm.x"])");
  const std::string file = kFolder + "/changed.csv", saved = kFolder + "/changed.checkpoint";
  for (const std::string& name : {file, file + ".partial", saved}) fs::remove(name);
  shell("lockstep run '" + scene + "' --no-picture --quiet --record '" + file + "' --checkpoint '" + saved +
        "' --every 0.02s & sleep 0.5; kill -KILL $!; wait $!");
  REQUIRE(fs::exists(saved));
  const auto refused = [&](const std::string& part) {
    const Called r = call("resume '" + saved + "'");
    INFO(r.text);
    CHECK(r.exit == 8);
    CHECK(contains(r.text, part));
  };
  const std::string of_scene = bytes_of(scene), of_file = bytes_of(saved), of_rows = bytes_of(file + ".partial");
  const auto put = [](const std::string& name, const std::string& bytes) {
    std::ofstream(name, std::ios::binary) << bytes;
  };
  put(scene, of_scene + " ");
  refused("scene '" + scene + "', or a file that it reads, has changed");
  put(scene, of_scene);
  std::string rows = of_rows;
  rows[of_rows.find('\n') + 3] ^= 1;
  put(file + ".partial", rows);
  refused("the rows before the checkpoint are missing or changed in '" + file + ".partial' and '" + file + "'");
  put(file + ".partial", of_rows);
  std::string damaged = of_file;
  damaged[damaged.size() / 2] ^= 4;
  put(saved, damaged);
  refused("is damaged");
  put(saved, of_file.substr(0, of_file.size() / 3));
  refused("is truncated or damaged");
  CHECK(bytes_of(file + ".partial") == of_rows);
  CHECK(call("run '" + scene + "' --record '" + file + "' --checkpoint '" + file + "'").exit == 2);
  CHECK(call("run '" + scene + "' --record '" + file + "' --checkpoint '" + scene + "'").exit == 2);
  CHECK(call("run '" + scene + "' --record - --checkpoint '" + saved + "'").exit == 2);
  for (const std::string& name : {file + ".partial", saved}) fs::remove(name);
}

TEST_CASE("a sweep that kill -9 ends resumes at its last result, to the same table", "[faults]") {
  const std::string scene =
      arm_scene("rest", R"("until": 20, "output": 0.1, "integrator": "rk4", "step": 0.001, "record": ["arm.x"])");
  const std::string file = kFolder + "/rest.csv", partial = file + ".partial", mark = file + ".sweep";
  const std::string words =
      "sweep '" + scene + "' --quiet --jobs 2 --vary gravity.2=-9.81:-1:60 --record '" + file + "'";
  const auto without_cpu = [](const std::string& text) {  // the last cell but one
    std::string out;
    for (std::size_t at = 0, next; (next = text.find('\n', at)) != std::string::npos; at = next + 1) {
      const std::string line = text.substr(at, next - at);
      const std::size_t last = line.rfind(','), before = line.rfind(',', last - 1);
      out += line.substr(0, before) + line.substr(last) + "\n";
    }
    return out;
  };
  for (const std::string& name : {file, partial, mark}) fs::remove(name);
  REQUIRE(call(words).exit == 0);
  const std::string whole = without_cpu(bytes_of(file));
  CHECK_FALSE(fs::exists(mark));
  const Called none = call(words + " --resume");
  CHECK(none.exit == 8);
  CHECK(contains(none.text, "no sweep to continue"));
  for (const char* signal : {"KILL", "TERM"}) {
    fs::remove(file);
    // As soon as rows are there.
    shell("lockstep " + words + " & p=$!; while [ ! -s '" + partial +
          "' ] && kill -0 $p 2>/dev/null; do sleep 0.005; " + "done; kill -" + signal + " $p; wait $p");
    INFO(signal);
    REQUIRE(fs::exists(mark));
    std::ofstream(fs::exists(partial) ? partial : file, std::ios::app) << "7,-9";  // a torn row
    const Called other = call(words + " --until 1 --resume");
    CHECK(other.exit == 8);
    CHECK(contains(other.text, "its command was `lockstep sweep"));
    const Called r = shell("lockstep " + words + " --resume");
    INFO(r.text);
    CHECK(r.exit == 0);
    CHECK((without_cpu(bytes_of(file)) == whole));
    CHECK_FALSE(fs::exists(mark));
    CHECK_FALSE(fs::exists(partial));
  }
}

TEST_CASE("a resumed sweep ends with 9 for the wrong runs of its first part", "[faults]") {
  const std::string scene = arm_scene(
      "off",
      R"("until": 400, "output": 1, "integrator": "rk4", "step": 0.1, "formulation": "omega", "stabilization": "none", "violation_limit": "1 um", "record": ["arm.x"])");
  const std::string file = kFolder + "/off.csv", partial = file + ".partial";
  const std::string words = "sweep '" + scene + "' --jobs 1 --vary gravity.2=-1:-0.5:300 --record '" + file + "'";
  for (const std::string& name : {file, partial, file + ".sweep"}) fs::remove(name);
  shell("lockstep " + words + " --quiet & for k in $(seq 1000); do sleep 0.02; [ \"$(wc -l < '" + partial +
        "')\" -gt 3 ] && break; done 2>/dev/null; kill -KILL $!; wait $!");
  REQUIRE(fs::exists(partial));
  const std::string kept = bytes_of(partial);
  CHECK(contains(kept, ",wrong\n"));
  const Called r = shell("lockstep " + words + " --resume");
  INFO(r.text);
  CHECK(r.exit == 9);
  CHECK(contains(r.text, "done before "));
  CHECK(contains(r.text, "300 wrong (energy, constraints or requirements)"));
  CHECK_FALSE(contains(bytes_of(file), ",ok\n"));
}

TEST_CASE("the page of a resumed sweep reports which runs have no curves", "[faults]") {
  const std::string scene =
      arm_scene("told", R"("until": 2, "output": 0.01, "integrator": "rk4", "step": 0.001, "record": ["arm.x"])");
  const std::string file = kFolder + "/told.csv", partial = file + ".partial", page = kFolder + "/told.html";
  const std::string words = "sweep '" + scene + "' --jobs 1 --vary gravity.2=-9.81:-1:60 --record '" + file +
                            "' --histories '" + kFolder + "/told' --report '" + page + "'";
  for (const std::string& name : {file, partial, file + ".sweep", page}) fs::remove(name);
  shell("lockstep " + words + " --quiet & for k in $(seq 1000); do sleep 0.02; [ \"$(wc -l < '" + partial +
        "')\" -gt 3 ] && break; done 2>/dev/null; kill -KILL $!; wait $!");
  REQUIRE(fs::exists(partial));
  const Called r = shell("lockstep " + words + " --resume");
  INFO(r.text);
  CHECK(r.exit == 0);
  const std::string fact = "runs before the interruption are in the folder only";
  CHECK(contains(bytes_of(page), fact));
  CHECK(contains(r.text, "the curves of "));
  CHECK(fs::exists(kFolder + "/told/01.csv"));
}

}  // namespace faults_test
