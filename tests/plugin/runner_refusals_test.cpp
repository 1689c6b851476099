// SPDX-License-Identifier: BSD-3-Clause
// What the command line refuses: the option or the name, its value, and what to write in its place.
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <lockstep/author/memory.h>
#include <lockstep/error.h>
#include "framework/tools/simulation/checkpoint.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace runner_refusals_test {

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;

namespace {

/// Words of the command line, "@" the four-bar; and words that stand in what is said.
struct Refused {
  std::string words;
  int exit;
  std::vector<std::string> said;
};

void check_refusals(const std::vector<Refused>& all) {
  for (const Refused& one : all) {
    std::string words = one.words;
    for (std::size_t at = words.find('@'); at != std::string::npos; at = words.find('@', at + kFourBar.size()))
      words.replace(at, 1, "'" + kFourBar + "'");
    const Called called = call(words);
    INFO(one.words);
    INFO(called.text);
    CHECK(called.exit == one.exit);
    for (const std::string& word : one.said) {
      INFO("missing: " << word);
      CHECK(contains(called.text, word));
    }
  }
}

/// A file of the folder in which the program runs.
void write(const std::string& name, const std::string& text) {
  fs::create_directories(kRunnerFolder);
  std::ofstream(kRunnerFolder + "/" + name) << text;
}

}  // namespace

TEST_CASE("impossible options are rejected with the option, the value and the right form", "[runner]") {
  write("requires.json", R"({"lockstep": 1, "requires": ["bump"], "bodies": [{"name": "a", "particle": 1}]})");
  write("follower.json", R"({"lockstep": 1, "bodies": [{"name": "a", "particle": 1}],
    "joints": [{"name": "ride", "type": "cam_follower", "p": "a", "s": "ground"}]})");
  check_refusals({
      {"check follower.json", 3, {"unknown type", "plugin cam_follower adds this joint: load it by --plugin cam_follower"}},
      {"describe", 2, {"describe: a name is missing, as in `lockstep describe revolute`"}},
      {"describe revolut", 2, {"describe: unknown name \"revolut\"", "did you mean \"revolute\""}},
      {"describe bump", 2, {"describe: unknown name \"bump\"; plugin bump adds this law: load it by --plugin bump"}},
      {"describe cranc --scene @", 2, {"no parameter or point \"cranc\"", "did you mean"}},
      {"run @ --picture A.rz", 2, {"--picture A.rz: expected X:Y", "--picture crank.x:crank.y"}},
      {"run @ --picture none:nothing", 2, {"--picture none:nothing: \"none\" is not recorded"}},
      {"run @ --json --record -", 2, {"--json: standard output takes the table", "write one of the two to a file"}},
      {"run @ --report -", 2, {"--report: the report needs a file", "--report out.html"}},
      {"run @ --record table.csv --report table.csv",
       2,
       {"the report would replace 'table.csv'", "name it table.html"}},
      {"run @ --record - --checkpoint run.checkpoint",
       2,
       {"--checkpoint: rows written to '", "record them to a file (--record)"}},
      {"run @ --record table.csv --checkpoint table.csv",
       2,
       {"--checkpoint: the checkpoint would replace 'table.csv'", "name another file"}},
      {"run @ --checkpoint run.checkpoint --every 0s", 2, {"--every: the value is 0s", "greater than 0"}},
      {"check @ --channels --of cranc",
       2,
       {"--of: no body, marker, joint or force is called \"cranc\"", "did you mean \"crank\""}},
      {"statics @ --all none", 2, {"--all: \"none\" is not a whole number from 1 to 1000000"}},
      {"statics @ --all 3 --record rest.csv", 2, {"--all prints every equilibrium", "leave out --vary and --record"}},
      {"statics @ --json --vary run.step=1,2",
       2,
       {"--json: with --vary the result is CSV", "leave out one of the two"}},
      {"statics @ --vary run.integrator=rk4,dopri5",
       2,
       {"--vary: \"run.integrator\" has no numbers", "varies numbers only"}},
      {"modes @ --count 0", 2, {"--count: \"0\" is not a number of modes", "--count 10"}},
      {"modes @ --at -1", 2, {"--at: the value is -1", "0 or greater"}},
      {"matrices @ --out /dev/null/here", 8, {"folder '/dev/null/here' cannot be created", "name another"}},
      {"kinematics @ --output 1e-12", 2, {"--output: 1e-12 s over", "use a longer interval"}},
      {"sweep @ --vary run.step=1,2 --step 3", 2, {"--step: \"run.step\" varies", "leave one of the two out"}},
      {"sweep @ --vary planar=off,z --full", 2, {"--planar: \"planar\" varies", "leave one of the two out"}},
      {"sweep @ --vary run.step=1e-3,2e-3 --histories /dev/null/here",
       8,
       {"folder '/dev/null/here' cannot be created", "check --histories"}},
      {"chart @ --budget 0.5", 2, {"--budget: the value is 0.5", "at least 1 s"}},
      {"chart @ --tolerances 1e-3:x", 2, {"--tolerances: \"1e-3:x\" is not a range", "COARSE:FINE"}},
      {"atlas @ --vary run.step=1,2", 2, {"--vary: a map has two axes", "give --vary twice"}},
      {"atlas @ --vary run.step=1,2 --vary run.integrator=rk4,dopri5",
       2,
       {"\"run.integrator\": an axis of a map needs numbers", "--integrators"}},
      {"atlas @ --vary run.step=2,1 --vary run.tolerance=1,2",
       2,
       {"\"run.step\": an axis of a map needs at least two increasing values"}},
      {"atlas @ --vary run.step=1,2 --vary run.tolerance=1,2 --step 3", 2, {"--step: \"run.step\" varies"}},
      {"atlas @ --vary run.until=1,2 --vary run.tolerance=1,2 --until 3", 2, {"--until: \"run.until\" varies"}},
      {"run requires.json --set requires.0=drag", 2, {"\"requires.0\" cannot be set", "give plugins by --plugin"}},
      {"sweep requires.json --vary requires.0=bump,drag",
       2,
       {"\"requires.0\" cannot vary", "plugins and columns are the same"}},
  });
}

TEST_CASE("problems that end a run, a sweep or a plugin's template are named", "[runner]") {
  const std::string particle = R"("bodies": [{"name": "a", "particle": 1, "velocity": [1, 0, 0]}], )";
  write("ends.json",
        R"({"lockstep": 1, )" + particle +
            R"("events": [{"name": "end", "at": 0.2, "stop": true}], "run": {"until": 1, "record": ["a.x"]}})");
  write("damped.json", R"({"lockstep": 1, )" + particle +
                           R"("run": {"until": 1, "integrator": {"type": "generalized_alpha", "rho_infinity": 2}}})");
  write("none.csv.sweep", "nonsense");
  write("list.json", "[1, 2]");
  write("includes.json", R"({"lockstep": 1, "include": [{"scene": "list.json"}]})");
  for (int k = 0; k <= 65; ++k)
    write("deep_" + std::to_string(k) + ".json",
          "{\"lockstep\": 1, \"include\": [{\"scene\": \"deep_" + std::to_string(k + 1) + ".json\"}]}");
  write("below.json", R"({"lockstep": 1, "bodies": [{"name": "a", "particle": 1, "position": [0, 0, -1]}], "links": [
    {"name": "S", "type": "stop", "p": "a", "s": "ground", "at_s": [0, 0, 0], "coordinate": "z", "low": 0}], "run": {"until": 1}})");
  write("rope.json", R"({"lockstep": 1, "bodies": [{"name": "a", "particle": 1, "position": [0, 0, -1]}], "links": [
    {"name": "S", "type": "distance", "p": "a", "s": "ground", "at_s": [0, 0, 0], "length": 0.5,
     "unilateral": {"side": "below"}}], "run": {"until": 1}})");
  write("inside.json", R"({"lockstep": 1, "bodies": [{"name": "a", "particle": 1, "position": [0, 0, -1]}], "links": [
    {"name": "S", "type": "point_on_plane", "p": "a", "s": "ground", "at_s": [0, 0, 0], "unilateral": {}}], "run": {"until": 1}})");
  write("folder.json", R"({"lockstep": 1, "include": [{"scene": "."}]})");
  write("sparse.so", "");
  fs::resize_file(kRunnerFolder + "/sparse.so", (std::uintmax_t{1} << 30) + 1);
  const auto checkpoint = [](const std::string& name, const std::string& kind, const std::string& word) {
    Snapshot s;
    s.put_text(kind);
    if (kind == "run") s.put(1);
    s.put_text(word), s.put_text(kRunnerFolder), s.put_text("");
    s.put_bits(0), s.put_bits(0), s.put(0), s.put_part({});
    write_checkpoint(kRunnerFolder + "/" + name, s);
  };
  checkpoint("host.saved", "simulation", "");
  checkpoint("words.saved", "run", "--nonsense");
  checkpoint("kind.csv.sweep", "run", "");
  checkpoint("other.csv.sweep", "sweep", "sweep other.json");
  check_refusals({
      {"check folder.json", 3, {"include[0].scene: \".\" is not a regular file"}},
      {"run @ --plugin ./sparse.so", 4, {"sparse.so' has 1073741825 bytes", "at most 2^30"}},
      {"resume host.saved", 2, {"checkpoint 'host.saved' is of a simulation in C++", "Simulation::load"}},
      {"resume words.saved", 2, {"the command line in the checkpoint cannot be read", "--nonsense"}},
      {"sweep ends.json --vary run.tolerance=1e-6,1e-7 --resume --record kind.csv",
       8,
       {"the sweep of 'kind.csv.sweep' cannot be continued: the file is not of a sweep", "leave out --resume"}},
      {"sweep ends.json --vary run.tolerance=1e-6,1e-7 --resume --record other.csv",
       8,
       {"its command was `lockstep sweep other.json`", "leave out --resume to begin again"}},
      {"modes ends.json --at 0.5", 3, {"the run ended at t = 0.2 s, by 'end'", "give a time --at before it"}},
      {"check damped.json", 3, {"run.integrator.rho_infinity: it is 2", "between 0 (full damping) and 1 (none)"}},
      {"check includes.json", 3, {"include[0].scene: \"list.json\" is not an object"}},
      {"check deep_0.json", 3, {"scenes include one another more than 64 deep"}},
      {"run below.json",
       5,
       {"the start lies 1 m beyond the stop 'S': the coordinate is -1 m, its limit is 0 m",
        "widen its range (\"low\", \"high\")", "or start within it"}},
      {"run inside.json",
       5,
       {"the start lies 1 m on the wrong side of the one-sided joint 'S'",
        "move its bodies apart, or reverse the side (\"side\": \"below\")"}},
      {"run rope.json",
       5,
       {"joint 'S'\n  hint: move its bodies closer together, or reverse the side (\"side\": \"above\")"}},
      {"atlas @ --vary run.tolerance=1e-6,1e-5 --vary run.until=1,2 --integrators rk4 --budget 2s",
       2,
       {"no method can run this scene", "\"rk4\" has fixed steps and no step is given"}},
      {"linearize @ --json --csv numbers", 2, {"--json and --csv", "give one of the two"}},
      {"sweep ends.json --vary run.tolerance=1e-6,1e-7 --resume --record absent.csv",
       8,
       {"there is no sweep to continue", "'absent.csv.sweep' is missing", "leave out --resume"}},
      {"sweep ends.json --vary run.tolerance=1e-6,1e-7 --resume --record none.csv",
       8,
       {"checkpoint 'none.csv.sweep' is not a checkpoint", "is not a checkpoint"}},
      {"sweep - --vary run.tolerance=1e-6,1e-7 --resume < ends.json",
       2,
       {"--resume: scene and table must be readable again", "give files for both"}},
      {"new-plugin link revolute", 2, {"\"revolute\" is already a joint of lockstep", "use another name"}},
      {"new-plugin law motion", 2, {"the class of \"motion\" would be MotionLaw", "use another name"}},
      {"new-plugin link mine --into /dev/null/here",
       8,
       {"/dev/null/here/mine: cannot be created", "give --into a writable"}},
  });
}

TEST_CASE("plugins reject impossible numbers by key, value and limit", "[runner]") {
  const auto drive = [](const std::string& law) {
    return "{\"lockstep\": 1, " + kArm + "\"requires\": [\"bump\"], \"links\": [{" + kHinge +
           ", \"drive\": {\"axis\": \"rz\", \"law\": " + law + "}}]}";
  };
  const auto cam = [](const std::string& keys) {
    return "{\"lockstep\": 1, " + kArm + "\"requires\": [\"cam_follower\"], \"links\": [{\"name\": \"C\", \"type\": " +
           "\"cam_follower\", \"p\": \"arm\", \"s\": \"ground\", \"at\": [0, 0, 0], " + keys + "}]}";
  };
  write("flat_bump.json", drive(R"({"type": "bump", "height": 1, "at": 1, "width": 0})"));
  write("no_cam.json", cam(R"("base": 0, "lift": 1)"));
  write("no_lobe.json", cam(R"("base": 1, "lift": 1, "lobes": 0)"));
  check_refusals({
      {"check flat_bump.json", 3, {"drive.law (bump of plugin bump).width: is 0 s", "above zero"}},
      {"check no_cam.json",
       3,
       {"joint 'C' (cam_follower of plugin cam_follower), base: is 0 m", "a radius above zero"}},
      {"check no_lobe.json",
       3,
       {"joint 'C' (cam_follower of plugin cam_follower), lobes: is 0", "a cam has at least one"}},
  });
}

TEST_CASE("files that cannot be written are rejected with the file and the next move", "[runner]") {
  write(
      "robot.urdf",
      "<robot name='r'><link name='base'/><link name='arm'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' "
      "iyy='1' iyz='0' izz='1'/></inertial></link><joint name='hinge' type='continuous'><parent link='base'/>"
      "<child link='arm'/></joint></robot>");
  write("there.json", "{}");
  check_refusals({
      {"import robot.urdf --out there.json", 2, {"--out: 'there.json' exists", "name another file"}},
      {"import robot.urdf --out /dev/null/scene.json", 8, {"file '/dev/null/scene.json.partial' cannot be written"}},
      {"run @ --record /dev/null/here/table.csv", 8, {"folder '/dev/null/here' cannot be created", "name another"}},
  });
}

TEST_CASE("neither a checkpoint nor a report replaces what is no regular file", "[runner]") {
  const std::string pipe = kRunnerFolder + "/pipe", device = kRunnerFolder + "/device";
  fs::create_directories(kRunnerFolder);
  fs::remove(pipe), fs::remove(device);
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  check_refusals({{"run @ --checkpoint pipe", 8, {"checkpoint 'pipe' would replace", "a pipe; give a file name"}}});
  check_words(message_of<FileError>([&] { write_checkpoint(pipe, {}); }),
              {"pipe' would replace a folder, a device or a pipe", "give a file name"});
  CHECK(fs::is_fifo(pipe));
  CHECK_FALSE(fs::exists(pipe + ".partial"));
  fs::remove(pipe);
  if (::mknod(device.c_str(), S_IFCHR | 0600, makedev(1, 3)) != 0) {  // that of /dev/null
    WARN("skipped: only root makes devices");
    return;
  }
  check_refusals({{"run @ --until 0.1 --no-picture --report device", 0, {}},
                  {"run @ --until 0.1 --no-picture --checkpoint device", 8, {"checkpoint 'device' would replace"}}});
  CHECK(fs::is_character_file(device));
  CHECK_FALSE(fs::exists(device + ".partial"));
  fs::remove(device);
}

}  // namespace runner_refusals_test
