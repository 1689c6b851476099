// SPDX-License-Identifier: BSD-3-Clause
// The verbs that measure, called as a person calls them: chart, advise, run --certify.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

#include <lockstep/recorder.h>
#include <lockstep/version.h>
#include "framework/tools/charts/gnuplot.h"
#include "tests/support/catch.h"
#include "tests/support/gnuplot_here.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"
#include "tests/support/worst.h"

namespace benchmark_test {

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;

namespace {

const std::string& kFolder = kRunnerFolder;
using Result = Called;

// A particle of 1 kg on a ring of 2 m, no gravity, 3 m/s: x = 2 cos 1.5 t, y = 2 sin 1.5 t, held by 4.5 N.
std::string ring(const std::string& run) {
  return scene_file(
      "ring",
      R"("title": "a stone on a string", "bodies": [{"name": "stone", "particle": 1, "position": [2, 0, 0], "velocity": [0, 3, 0]}],
    "links": [{"name": "L", "type": "distance", "p": "stone", "s": "ground", "at_p": [2, 0, 0], "at_s": [0, 0, 0], "length": 2}],
    "run": {"until": 2, "output": 0.05, "record": ["stone.x", "stone.y", "stone.z", {"F": "L.force_on_p_world_x"}])" +
          run + "}");
}

// An option for work that takes seconds of CPU time; builds other than Release need ten times as many.
std::string budget(int seconds) {
#ifndef NDEBUG
  seconds *= 10;
#endif
  return " --budget " + std::to_string(seconds);
}

// The command that advise prints, without the program's name.
std::string advised(const std::string& text) {
  const std::size_t begin = text.find("lockstep run ");
  REQUIRE(begin != std::string::npos);
  return text.substr(begin + 9, text.find('\n', begin) - begin - 9);
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  char date[16];
  std::tm day{};
  gmtime_r(&now, &day);
  return {date, std::strftime(date, sizeof date, "%Y-%m-%d", &day)};
}

double error_of(const Table& table) {
  double most = 0;
  for (std::size_t i = 0; i < table.n_rows(); ++i) {
    const double t = table["t"][i];
    keep_worst(most,
               std::hypot(table["stone.x"][i] - 2 * std::cos(1.5 * t), table["stone.y"][i] - 2 * std::sin(1.5 * t)));
  }
  return most;
}

}  // namespace

TEST_CASE("the method that advise recommends meets the error", "[benchmark]") {
  const std::string path = ring("");
  for (const char* error : {"1e-3", "1e-7"}) {
    const Result r = call("advise '" + path + "' --error " + error + " --budget 20 --separately --quiet");
    INFO(r.text);
    REQUIRE(r.exit == 0);
    for (const char* word :
         {"  cheapest:\n    command  ", "  cheapest of each integrator, the recommended one first:\n",
          "\"integrator\":", "  reference solution  ", "  differs by at most  "})
      CHECK(contains(r.text, word));
    CHECK(contains(value_of(r.text, "wanted"), "position error of at most "));
    CHECK(std::count(r.text.begin(), r.text.end(), '\n') < 40);
    fs::remove(kFolder + "/advised.csv");
    const Result run = call(advised(r.text) + " --record advised.csv --quiet");
    INFO(run.text);
    REQUIRE(run.exit == 0);
    CHECK(error_of(read_csv(kFolder + "/advised.csv")) <= std::atof(error));
  }
}

TEST_CASE("advise measures the named methods with their keys, and reports if none meets the error", "[benchmark]") {
  const std::string path = ring("");
  const Result r =
      call("advise '" + path + "' --integrators dopri5:fixed=true,semi_implicit_euler --formulations omega " +
           "--stabilisations project --solvers sparse --error 1e-5 --budget 20 --verbose");
  INFO(r.text);
  CHECK(r.exit == 0);
  CHECK_FALSE(contains(r.text, "rk4"));
  CHECK_FALSE(contains(r.text, "dense"));
  CHECK(contains(r.text, "--integrator dopri5:fixed=true --step "));
  CHECK(contains(r.text, "\"type\":\"dopri5\""));
  CHECK(contains(r.text, "  dopri5:fixed=true"));  // each run, as it ended
  CHECK(call(advised(r.text) + " --quiet").exit == 0);
  const Result never =
      call("advise '" + path + "' --integrators semi_implicit_euler --steps 0.02:0.01 --error 1e-9 --quiet");
  INFO(never.text);
  CHECK(never.exit == 1);
  CHECK(value_of(never.text, "wanted") == "position error of at most 1e-09 m: no run met it");
  CHECK_FALSE(contains(never.text, "best run"));  // all are wrong
  CHECK(value_of(never.text, "next") == "allow a larger error, other methods or finer settings");  // none is unfinished
  const Result below_rounding = call("advise '" + path + "' --integrators rk4 --steps 0.02:0.01 --error 1e-20 --quiet");
  INFO(below_rounding.text);
  CHECK(below_rounding.exit == 1);
  CHECK_FALSE(contains(below_rounding.text, "best run"));
  CHECK(contains(value_of(below_rounding.text, "next"), "allow a larger error"));
}

TEST_CASE("advise recommends no run that `run` reports as wrong", "[benchmark]") {
  const Result r = call("advise '" + ring(R"(, "energy_limit": 1e-9)") +
                        "' --integrators dopri5 --error 1e-2 --budget 20 --json --quiet");
  INFO(r.text);
  REQUIRE(r.exit == 0);
  const nlohmann::json j = nlohmann::json::parse(r.text);
  const auto is_wrong = [](const nlohmann::json& run) { return run.contains("wrong"); };
  CHECK(std::any_of(j["runs"].begin(), j["runs"].end(), is_wrong));
  CHECK(call(advised(j["cheapest"]["command"].get<std::string>() + "\n") + " --quiet").exit == 0);
}

TEST_CASE("invalid words of the measuring commands are usage errors", "[benchmark]") {
  const std::string path = ring("");
  for (const auto& [words, said] : std::vector<std::pair<std::string, std::string>>{
           {"--integrators rk5", "--integrators: unknown integrator \"rk5\"; did you mean \"rk4\"?"},
           {"--integrators dopri5:speed=3", "\"speed=3\" in \"dopri5:speed=3\" sets no key of dopri5; known: fixed"},
           {"--solvers fast", "--solvers: unknown solver \"fast\"; known: "},
           {"--formulations x", "--formulations: unknown \"x\"; known: omega,"},
           {"--stabilisations glue", "--stabilizations: unknown \"glue\"; known: project,"},
           {"--tolerances few", "--tolerances: \"few\" is not a range; write it as COARSE:FINE"},
           {"--steps 3", "--steps: 3 s is longer than the "},
           {"--budget 0.1", "--budget: the value is 0.1; it must be at least 1 s"},
           {"--budget 3m", "--budget: \"3m\" is not a time; write it as in --budget 60"}}) {
    INFO(words);
    check_refused(call("chart '" + path + "' " + words), 2, {said});
  }
  check_refused(call("advise '" + path + "' --error none"), 2, {"--error: \"none\" is not a number"});
  check_refused(call("advise '" + path + "' --of beauty"), 2, {"--of: unknown \"beauty\"; known: position,"});
  check_refused(call("run '" + path + "' --budget 5"), 2, {"--budget requires --certify"});
  CHECK(contains(call("run '" + path + "' --integrator dopri5:fixd=true").text, "did you mean \"fixed\"?"));
}

TEST_CASE("chart leaves every error of every combination in its table", "[benchmark]") {
  fs::remove_all(kFolder + "/charts");
  const Result r =
      call("chart '" + ring("") + "' --integrators rk4,dopri5 --tolerances 1e-3:1e-6 --steps 0.02:0.0025 " +
           "--budget 60 --out charts");
  INFO(r.text);
  REQUIRE(r.exit == 0);
  std::ifstream file(kFolder + "/charts/ring_chart.csv");
  std::string line;
  std::getline(file, line);
  for (const char* column : {"position error [m]", "velocity error [m/s]", "energy error [J]", "reaction error [N]",
                             "cpu [s]", "evaluations", "counts", "front", "failure"})
    CHECK(contains(line, column));
  std::size_t n_front = 0, n_lines = 0;
  while (std::getline(file, line)) {
    ++n_lines;
    n_front += contains(line, ",1,1,") ? 1 : 0;
  }
  CHECK(n_lines >= 2 * 2 * 3);  // formulations, stabilisations and a run at least of each
  CHECK(n_front >= 1);
  const std::size_t best = r.text.find("  least CPU time with each ("),
                    cheapest = r.text.find("  recommended (within 20 % of the cheapest, ");
  REQUIRE(best != std::string::npos);
  REQUIRE(cheapest != std::string::npos);
  CHECK_FALSE(contains(r.text, "stabilization  "));  // one spelling
  CHECK(row_of(r.text.substr(best), "by") == "by value below 1e-3 m below 1e-6 m below 1e-9 m");
  for (const char* by : {"integrator", "solver", "formulation"})
    CHECK_FALSE(row_of(r.text.substr(best, r.text.find("\n  files", best) - best), by).empty());
  CHECK(row_of(r.text.substr(cheapest), "error below [m]").starts_with("error below [m] integrator"));
  CHECK_FALSE(row_of(r.text.substr(cheapest, best - cheapest), "1e-06").empty());
  testing::require_gnuplot();
  CHECK(contains(r.text, "ring_chart.png, ring_chart.svg"));
  CHECK(contains(value_of(r.text, "runs"), " valid"));
  CHECK(contains(r.text, "seven coordinates per body"));
  for (const char* picture : {"", "_evaluations", "_formulations", "_stabilizations", "_solvers"})
    CHECK(fs::file_size(kFolder + "/charts/ring_chart" + picture + ".png") > 10000);
}

// Runs that fail have errors of 1e10 m and more, and still the small numbers of others are no rounding.
TEST_CASE("limits and tolerances of a chart are printed however small", "[benchmark]") {
  const Result r = call("chart '" + std::string(paths::kScenes) + "/double_pendulum.json" +
                        "' --until 5 --integrators dop853,rk4 --solvers schur" + budget(10) + " --out small");
  INFO(r.text);
  REQUIRE(r.exit == 0);
  const std::string cheapest = r.text.substr(r.text.find("  recommended ("));
  CHECK_FALSE(row_of(cheapest, "0.001").empty());
  for (const char* limit : {"1e-06", "1e-09"}) CHECK(contains(row_of(cheapest, limit), " not used 1e-"));  // no solver
  std::ifstream file(kFolder + "/small/double_pendulum_chart.csv");
  const std::string all(std::istreambuf_iterator<char>(file), {});
  CHECK(contains(all, "dop853,joint,project,schur,1e-06,"));  // first the formulation of the scene
}

// Without loops, the key `stages` changes nothing in joint coordinates.
TEST_CASE("keys without effect do not make separate methods, and advise leaves them at their defaults", "[benchmark]") {
  const Result r = call("advise '" + std::string(paths::kScenes) + "/double_pendulum.json" +
                        "' --until 2 --error 1e-6 --integrators dop853,dop853:stages=plain,dop853:stages=manifold "
                        "--formulations auto --budget 10 --json --quiet");
  INFO(r.text);
  REQUIRE(r.exit == 0);
  const nlohmann::json j = nlohmann::json::parse(r.text);
  for (const auto& run : j["runs"]) CHECK(run["integrator"] == "dop853");
  CHECK(j["cheapest"]["formulation"] == "auto");  // as it would be set
  CHECK(j["cheapest"]["formulation_used"] == "joint");
  CHECK(j["cheapest"]["solver"] == "-");
  CHECK(j["cheapest"]["integrator"] == "dop853");
  CHECK(j["each"].size() == 1);
}

TEST_CASE("quaternions are measured in space, and so does the advised command", "[benchmark]") {
  const Result r = call("advise '" + std::string(paths::kScenes) +
                        "/double_pendulum.json' --until 0.5 --error 1e-4 --integrators dop853 --formulations "
                        "quaternion --stabilizations project --budget 10 --json --quiet");
  INFO(r.text);
  REQUIRE(r.exit == 0);
  const nlohmann::json j = nlohmann::json::parse(r.text);
  CHECK(j["cheapest"]["formulation"] == "quaternion");
  CHECK(contains(j["cheapest"]["command"].get<std::string>(), " --planar off"));
}

// Explicit methods need 20 000 steps for this second, and their references more than their part of the budget.
TEST_CASE("advise answers for a stiff scene within a small budget", "[benchmark]") {
  const std::string path = kFolder + "/stiff.json";
  std::ofstream(path) << R"({"lockstep": 1, "gravity": [0, -9.81, 0], "bodies": [
      {"name": "arm", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}},
      {"name": "carriage", "sphere": {"mass": 1, "radius": 0.05}, "position": [0.5, 0, 0]}],
      "joints": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0, 0, 0]},
                 {"name": "B", "type": "prismatic", "p": "carriage", "s": "arm", "at": [0.5, 0, 0], "axis": "x"}],
      "forces": [{"name": "mount", "type": "spring_damper", "p": "carriage", "s": "ground", "at_p": [0.5, 0, 0],
                  "at_s": [0, 0, 0], "stiffness": 1e7, "damping": 1e6, "free_length": 0.5}],
      "run": {"until": 2}})";
  const Result r = call("advise '" + path + "' --error 1e-6" + budget(6) + " --json --quiet");
  INFO(r.text);
  REQUIRE(r.exit == 0);
  const nlohmann::json j = nlohmann::json::parse(r.text);
  CHECK(j["cheapest"]["integrator"] == "radau5");
  CHECK(j["cheapest"]["stabilization"] == "project");
  CHECK(j["cheapest"]["confirmed"] == true);
}

// Its error halves with its step, to the finest one that it was given.
TEST_CASE("a chart does not report never for a method whose error still falls", "[benchmark]") {
  const Result r = call("chart '" + ring("") +
                        "' --integrators rk4,semi_implicit_euler --formulations omega --stabilizations project "
                        "--solvers schur --steps 0.02:0.005 --budget 20 --out falling");
  INFO(r.text);
  REQUIRE(r.exit == 0);
  const std::size_t best = r.text.find("  least CPU time with each (");
  REQUIRE(best != std::string::npos);
  const std::size_t euler = r.text.find("semi_implicit_euler", best);
  REQUIRE(euler != std::string::npos);
  CHECK(contains(r.text.substr(euler, r.text.find('\n', euler) - euler), " > "));
  CHECK_FALSE(contains(r.text, "never"));
  CHECK(contains(r.text, "> T: no run met it, the longest took T"));
}

// Projection gives the positions of a prescribed motion at any step, and coarse runs are wrong by their energy.
TEST_CASE("a method is not given up while its runs are wrong by energy alone", "[benchmark]") {
  const std::string few =
      "'" + std::string(paths::kScenes) + "/four_bar.json' --formulations omega --solvers schur " + "--quiet --budget ";
  const Result advice = call("advise " + few + "20 --integrators dopri5 --stabilizations project --error 1e-6 --json");
  INFO(advice.text);
  REQUIRE(advice.exit == 0);
  const nlohmann::json j = nlohmann::json::parse(advice.text);
  CHECK(std::ranges::any_of(j["runs"], [](const auto& run) { return run.contains("wrong"); }));
  CHECK(j["cheapest"]["confirmed"] == true);
  const Result chart = call("chart " + few + "3 --integrators dopri5,semi_implicit_euler --out prescribed");
  INFO(chart.text);
  REQUIRE(chart.exit == 0);
  for (const char* value : {"  dopri5 ", "  semi_implicit_euler ", "  project "}) {
    const std::size_t at = chart.text.find(value, chart.text.find("  least CPU time with each ("));
    REQUIRE(at != std::string::npos);
    CHECK_FALSE(contains(chart.text.substr(at, chart.text.find('\n', at) - at), "never"));
  }
  CHECK(contains(chart.text, "the motion is fully prescribed: lockstep kinematics or inverse computes it"));
  std::ifstream file(kFolder + "/prescribed/four_bar_chart.csv");
  const std::string all(std::istreambuf_iterator<char>(file), {});
  CHECK(all.find(",project,") < all.find(",none,"));  // the base is the scene's own
  if (!find_gnuplot().empty()) {
    std::ifstream picture(kFolder + "/prescribed/four_bar_chart.svg");
    CHECK(contains(std::string(std::istreambuf_iterator<char>(picture), {}), "nothing is integrated"));
  }
}

TEST_CASE("a chart gives the reason why a plane has no quaternions", "[benchmark]") {
  const Result r = call("chart '" + std::string(paths::kScenes) + "/four_bar.json' --until 0.2 --integrators " +
                        "dopri5 --tolerances 1e-3:1e-4 --budget 5 --quiet --out plane");
  INFO(r.text);
  REQUIRE(r.exit == 0);
  CHECK(contains(r.text, "  left out:\n"));
  CHECK(contains(r.text, "formulation quaternion has seven coordinates per body and does not support \"planar\""));
}

TEST_CASE("the picture of a chart gives the machine, the version and the date", "[benchmark]") {
  testing::require_gnuplot();
  const std::string svg = kFolder + "/caption/ring_chart.svg",
                    words = "chart '" + ring("") +
                            "' --integrators dopri5 --formulations omega --stabilizations project "
                            "--solvers schur --tolerances 1e-3:1e-4 --budget 5 --quiet --out caption";
  const auto picture = [&](const std::string& more) {
    fs::remove_all(kFolder + "/caption");
    const Result r = call(words + more);
    INFO(r.text);
    REQUIRE(r.exit == 0);
    std::ifstream file(svg);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const auto measured = [&] { return "lockstep " + std::string(library_version()) + ", " + today(); };
  const std::string before = measured(), usual = picture("");
  CHECK((contains(usual, before) || contains(usual, measured())));
  CHECK(contains(usual, ", Linux "));
  const std::string own = picture(" --caption 'measured at home'"), none = picture(" --caption ''");
  CHECK(contains(own, "measured at home"));
  CHECK_FALSE(contains(own, ", Linux "));
  CHECK_FALSE(contains(none, ", Linux "));
}

TEST_CASE("the certificate's digits are those of the closed form", "[benchmark]") {
  const Result r = call("run '" + ring(R"(, "integrator": "rk4", "step": 0.05)") + "' --certify --record ring.csv");
  INFO(r.text);
  REQUIRE(r.exit == 0);
  CHECK(contains(r.text, "tighter rk4 (step 0.0125 s)"));
  CHECK(contains(r.text, "stone.z"));
  const double error = error_of(read_csv(kFolder + "/ring.csv")), digits = std::log10(2 / error);
  // The line of stone.y: name, unit, scale, difference, digits against each repeat.
  const std::size_t at = r.text.rfind("  stone.y");
  REQUIRE(at != std::string::npos);
  char name[32], unit[32];
  double largest = 0, differs = 0, tighter = 0, other = 0;
  REQUIRE(std::sscanf(r.text.c_str() + at, "%31s %31s %lf %lf %lf %lf", name, unit, &largest, &differs, &tighter,
                      &other) == 6);
  CHECK(largest == Approx(2.0).epsilon(1e-2));
  CHECK(other == Approx(digits).margin(0.4));    // x and y together err sqrt(2) times as much at most
  CHECK(tighter == Approx(digits).margin(0.4));  // rk4 at a quarter of the step errs 256 times less
  const std::size_t z = r.text.rfind("  stone.z");
  CHECK(r.text.substr(z, r.text.find('\n', z) - z).find(" 0") != std::string::npos);
  CHECK(contains(r.text, "1 channel is only round-off"));

  const Result exact =
      call("run '" + ring(R"(, "integrator": "dop853", "tolerance": 1e-10)") + "' --certify --record ring.csv");
  INFO(exact.text);
  CHECK(exact.exit == 0);
  CHECK(contains(exact.text, "tighter dop853 (tolerance 1e-12) and dopri5 (tolerance 1e-12)"));
}

TEST_CASE("a named solver is measured and advised in omega, and joint coordinates have none to choose", "[benchmark]") {
  const std::string path = std::string(paths::kScenes) + "/rod_pendulum.json";
  const std::string few = " --until 1 --integrators dopri5 --stabilizations project --tolerances 1e-3:1e-6 --budget 10";
  const Result named =
      call("advise '" + path + "'" + few + " --formulations auto --solvers dense --error 1e-3 --quiet");
  INFO(named.text);
  REQUIRE(named.exit == 0);
  CHECK(contains(named.text, "--formulation omega --solver dense"));
  const Result by_itself = call("advise '" + path + "'" + few + " --formulations auto --error 1e-3 --quiet");
  INFO(by_itself.text);
  REQUIRE(by_itself.exit == 0);
  CHECK(contains(by_itself.text, "--formulation auto"));
  CHECK_FALSE(contains(by_itself.text, "--stabilization"));  // as in the scene
  CHECK_FALSE(contains(by_itself.text, "--solver"));
  CHECK(call(advised(by_itself.text) + " --quiet").exit == 0);
  const Result refused = call("run '" + path + "' --formulation joint --solver dense");
  INFO(refused.text);
  CHECK(refused.exit == 2);
  CHECK(contains(refused.text, "--solver: joint coordinates"));
}

TEST_CASE("joint coordinates with loops are charted with each stabilisation", "[benchmark]") {
  const Result r = call("chart '" + std::string(paths::kScenes) + "/nfourbar_2.json" +
                        "' --until 0.5 --integrators dopri5 --formulations joint --stabilizations none,project "
                        "--tolerances 1e-3:1e-4 --budget 10 --quiet --out loops");
  INFO(r.text);
  REQUIRE(r.exit == 0);
  std::ifstream file(kFolder + "/loops/nfourbar_2_chart.csv");
  const std::string all(std::istreambuf_iterator<char>(file), {});
  CHECK(contains(all, ",joint,none,"));
  CHECK(contains(all, ",joint,project,"));
}

TEST_CASE("a run without a verified digit is doubtful", "[benchmark]") {
  // A double pendulum that is let go level is chaotic: errors of 1e-4 fill the motion long before the end.
  const std::string path = kFolder + "/wild_pendulum.json";
  const auto write = [&](const char* until) {
    std::ofstream(path) << R"({"lockstep": 1, "gravity": [0, -9.81, 0], "bodies": [
      {"name": "a", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}},
      {"name": "b", "rod": {"mass": 1, "from": [1, 0, 0], "to": [2, 0, 0]}}],
      "links": [{"name": "A", "type": "revolute", "p": "a", "s": "ground", "at": [0, 0, 0]},
                {"name": "B", "type": "revolute", "p": "b", "s": "a", "at": [1, 0, 0]}],
      "run": {"tolerance": 1e-4, "output": 0.5, "record": ["b.x", "b.y", "b.z"], "until": )"
                        << until << "}}";
  };
  write("61");
  const Result lost = call("run '" + path + "' --certify");
  INFO(lost.text);
  CHECK(lost.exit == 11);
  CHECK(contains(lost.text, "--certify: no digit of b.x"));
  CHECK_FALSE(contains(lost.text, "b.z is verified"));  // zero throughout
  write("1");
  const Result kept = call("run '" + path + "' --certify");
  INFO(kept.text);
  CHECK(kept.exit == 0);
  CHECK_FALSE(contains(kept.text, "no digit of"));
}

TEST_CASE("a step of a fixed method is no limit for the adaptive one that is named", "[benchmark]") {
  const std::string path = ring(R"(, "integrator": "rk4", "step": 1e-4)");
  const Result r = call("run '" + path + "' --integrator dopri5 --tolerance 1e-6 --record ring.csv --verbose");
  INFO(r.text);
  REQUIRE(r.exit == 0);
  REQUIRE(contains(r.text, " s in "));
  CHECK(std::stoi(r.text.substr(r.text.find(" s in ") + 6)) < 1000);
}

}  // namespace benchmark_test
