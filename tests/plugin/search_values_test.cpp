// SPDX-License-Identifier: BSD-3-Clause
// The commands find and optimize, as a person calls them.
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/plugin/search_scenes.h"
#include "tests/support/catch.h"
#include "tests/support/defect_runs.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"
#include "tests/support/report_page.h"

namespace search_values_test {

using namespace lockstep::testing;
using namespace search_scenes;
using Json = nlohmann::json;
using std::numbers::pi;

namespace {

// A slider-crank without gravity: crank 1 kg and 0.1 m, rod 2 kg and 0.3 m, slider 3 kg, one revolution in 1 s. The
// counterweight is at 0.1 m, opposite to the crank.
std::string engine() {
  return scene_file("engine", R"--(
  "parameters": {"crank": "100 mm", "rod": "300 mm", "counterweight": "1 kg"},
  "points": {"A": [0, 0, 0], "B": ["=crank", 0, 0], "C": "=B + [rod, 0, 0]"}, "gravity": [0, 0, 0],
  "bodies": [{"name": "crank", "rod": {"mass": 1, "from": "A", "to": "B"}},
             {"name": "rod", "rod": {"mass": 2, "from": "B", "to": "C"}},
             {"name": "slider", "mass": 3, "inertia": [0.01, 0.01, 0.01], "position": "C"},
             {"name": "weight", "mass": "=counterweight", "inertia": [0.01, 0.01, 0.01], "position": "=A - [crank, 0, 0]"}],
  "joints": [{"name": "A", "type": "revolute", "p": "crank", "s": "ground", "at": "A",
              "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 6.283185307179586}}},
             {"name": "B", "type": "revolute", "p": "rod", "s": "crank", "at": "B"},
             {"name": "C", "type": "revolute", "p": "slider", "s": "rod", "at": "C"},
             {"name": "guide", "type": "prismatic", "p": "slider", "s": "ground", "at": "C", "axis": "x"},
             {"name": "welded", "type": "fixed", "p": "weight", "s": "crank", "at": "A"}],
  "run": {"until": 1, "output": 0.05, "tolerance": 1e-9,
          "record": [{"shaking": "=norm(A.force_on_p_world + guide.force_on_p_world)"}]
})--");
}

// A crank-rocker, one revolution in 1 s. P is a point of the coupler: px along BC, py across.
std::string four_bar() {
  return scene_file("path_generator", R"--(
  "parameters": {"base": "40 m", "crank": "10 m", "coupler": "40 m", "rocker": "30 m", "px": "20 m", "py": "20 m",
    "x0": "-10 m", "y0": "-10 m", "BD": "=D - B",
    "beta": "=atan2(BD.y, BD.x) + acos((coupler^2 + dot(BD, BD) - rocker^2)/(2*coupler*norm(BD)))"},
  "points": {"A": ["=x0", "=y0", 0], "B": "=A + [crank, 0, 0]", "D": "=A + [base, 0, 0]",
             "C": "=B + coupler*[cos(beta), sin(beta), 0]",
             "P": "=B + [px*cos(beta) - py*sin(beta), px*sin(beta) + py*cos(beta), 0]"},
  "bodies": [{"name": "crank", "rod": {"mass": 1, "from": "A", "to": "B"}},
             {"name": "coupler", "rod": {"mass": 1, "from": "B", "to": "C"}},
             {"name": "rocker", "rod": {"mass": 1, "from": "D", "to": "C"}}],
  "markers": [{"name": "P", "body": "coupler", "at": "P"}],
  "joints": [{"name": "A", "type": "revolute", "p": "crank", "s": "ground", "at": "A",
              "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 6.283185307179586}}},
             {"name": "B", "type": "revolute", "p": "coupler", "s": "crank", "at": "B"},
             {"name": "C", "type": "revolute", "p": "rocker", "s": "coupler", "at": "C"},
             {"name": "D", "type": "revolute", "p": "rocker", "s": "ground", "at": "D"}],
  "gravity": [0, 0, 0], "run": {"until": 1, "output": 1, "record": [{"x": "P.x"}, {"y": "P.y"}]})--");
}

// The sum of the squared distances of points from the path of P.
std::string error_of_path(const std::vector<std::array<double, 2>>& points) {
  std::string sum;
  for (const auto& [x, y] : points)
    sum +=
        (sum.empty() ? "" : " + ") + ("min((x - " + std::to_string(x) + " m)^2 + (y - " + std::to_string(y) + " m)^2)");
  return sum;
}

// The page of a search of the rotor's speed, against closed forms: the runs before and after, with the columns that the
// scene records, and the row of each run.
void check_rotor_page(const std::string& file, double before, double after) {
  std::ifstream in(kRunnerFolder + "/" + file, std::ios::binary);
  const std::string page((std::istreambuf_iterator<char>(in)), {});
  const Json data = Json::parse(lockstep::report_page::element(page, "data"));
  const std::vector<unsigned char> bytes =
      lockstep::report_page::bytes_of(lockstep::report_page::element(page, "numbers"));
  const Json& runs = data["histories"]["runs"];
  REQUIRE(runs.size() == 2);
  CHECK(runs[0]["run"] == 1);
  CHECK(runs[1]["run"] == data["shown"]);
  std::vector<std::string> lines{""};
  for (const char c : data["csv"].get<std::string>())
    c == '\n' ? lines.emplace_back() : lines.back() += std::string(1, c);
  CHECK(lines[0].starts_with("run,speed [rad/s],t final [s],"));
  for (const auto& [run, speed] : {std::pair(runs[0], before), std::pair(runs[1], after)}) {
    INFO(speed);
    const Json& columns = run["table"]["columns"];
    REQUIRE(columns.size() == 3);
    CHECK(columns[1]["name"] == "F");
    CHECK(columns[2]["name"] == "phi");
    // The weight is across to the radius at the start.
    const double first = lockstep::report_page::read(bytes, columns[1]["values"]).front();
    CHECK(std::abs(first - std::hypot(2 * 0.3 * speed * speed, 2 * 9.81)) <= 1e-4);
    CHECK(std::abs(lockstep::report_page::read(bytes, columns[2]["values"]).back() - 2 * speed) <= 1e-4);
    CHECK(run["frames"]["n"].get<int>() > 2);
    // "12,11.5744,2,100,...": number, speed, end, formula.
    const std::string& row = lines[run["run"].get<std::size_t>()];
    double number = 0, value = 0, end = 0, formula = 0;
    REQUIRE(std::sscanf(row.c_str(), "%lf,%lf,%lf,%lf", &number, &value, &end, &formula) == 4);
    CHECK(number == run["run"].get<double>());
    CHECK(std::abs(value - speed) <= 1e-4);
    CHECK(std::abs(formula - (2 * 0.3 * speed * speed + 2 * 9.81)) <= 1e-3);
  }
}

// Without NLopt the command reports the package that it needs.
bool is_left_out() {
  const bool left_out =
      contains(call("optimize " + rotor() + " --vary speed=5:20 --minimize \"max(F)\" --runs 1").text, "libnlopt-dev");
  if (left_out) WARN("skipped: NLopt is not installed");
  return left_out;
}

}  // namespace

TEST_CASE("find: the speed at which the peak force of a bearing reaches a limit", "[plugin][runner]") {
  const double wanted = std::sqrt((100 - 2 * 9.81) / (2 * 0.3));
  const std::string words = "find " + rotor() + " --vary speed=\"5 rad/s:20 rad/s\" --reach \"max(F) = 100 N\"";
  const Json found = json_of(words + " --json");
  CHECK(std::abs(found["values"]["speed"].get<double>() - wanted) <= 1e-6 * wanted);
  CHECK(std::abs(found["value"].get<double>() - 100) <= 1e-5);
  CHECK(found["unit"] == "N");
  const Called text = call(words + " --write rotor_found.json");
  INFO(text.text);
  CHECK(text.exit == 0);
  CHECK(value_of(text.text, "found") == "max(F) = 100 N with speed = 11.5744 rad/s");
  // The scene that is written has the speed: its run has this force.
  const Called run = call("run rotor_found.json --no-picture");
  INFO(run.text);
  CHECK(run.exit == 0);
  CHECK(contains(run.text, " ... 100 N"));
}

TEST_CASE("find: the page of the given and the found scene", "[plugin][runner]") {
  const std::string words =
      "find " + rotor() + " --vary speed=\"5 rad/s:20 rad/s\" --reach \"max(F) = 100 N\" --report ";
  const Called found = call(words + "found.html");
  INFO(found.text);
  CHECK(found.exit == 0);
  CHECK(value_of(found.text, "written") == "found.html");
  check_rotor_page("found.html", 10, std::sqrt((100 - 2 * 9.81) / (2 * 0.3)));
  check_refused(call(words + "-"), 2, {"--report: the report needs a file"});
}

TEST_CASE("find: the last value of a column, and channels that are no columns", "[plugin][runner]") {
  // phi is 2 s times the speed; the turns counted in it are not lost.
  const Json last = json_of("find " + rotor() + " --vary speed=5:20 --reach \"phi = 22 rad\" --json");
  CHECK(std::abs(last["values"]["speed"].get<double>() - 11) <= 1e-6);
  const Json mean =
      json_of("find " + rotor() + " --vary r=0.1:1 --reach \"mass.vx^2 + mass.vy^2 = 16 m^2/s^2\" --json");
  CHECK(std::abs(mean["values"]["r"].get<double>() - 0.4) <= 1e-6);
}

TEST_CASE("find: what cannot be found is an error with the next move", "[plugin][runner]") {
  const std::string begin = "find " + rotor() + " --vary speed=5:20 --reach ";
  check_refused(
      call(begin + "\"max(F) = 1 kN\""), 1,
      {"max(F) is 34.62 N with speed = 5 rad/s", "259.62 N with speed = 20 rad/s", "both below", "lockstep sweep"});
  check_refused(call(begin + "\"max(F) = 3 m\""), 2, {"--reach", "a force and a length are subtracted"});
  check_refused(call(begin + "\"max(G) = 3 N\""), 2, {"--reach", "G"});
  check_refused(call(begin + "\"max(F)\""), 2, {"compares nothing"});
  check_refused(call(begin + "\"max(F) < 3 N\""), 2, {"is not an equation"});
  check_refused(call("find " + rotor() + " --vary speed=5:20:3 --reach \"max(F) = 100 N\""), 2, {"expected NAME=a:b"});
  check_refused(call("find " + rotor() + " --vary speed=20:5 --reach \"max(F) = 100 N\""), 2, {"expected NAME=a:b"});
  // sign(phi - 26 rad) jumps from -1 to 1.
  check_refused(call(begin + "\"sign(phi - 26 rad) = 0\""), 1, {"jumps over the value"});
  // The rod is too short for the crank at one end of the range.
  check_refused(call("find " + engine() + " --vary rod=\"50 mm:300 mm\" --reach \"max(shaking) = 10 N\""), 1,
                {"the run with rod = 50 mm failed"});
}

TEST_CASE("optimize: the counterweight of least shaking force balances half of the reciprocating mass",
          "[plugin][runner]") {
  if (is_left_out()) return;
  // A uniform rod is, for its force, half at each end. The reciprocating force has the first harmonic m r w^2, and no other
  // odd one. The mean square of the shaking force is least if the weight balances all rotating and half of the
  // reciprocating mass: 1/2 (of the crank) + 1 (of the rod) + (3 + 1)/2.
  const Json j =
      json_of("optimize " + engine() + " --vary counterweight=\"0.1 kg:10 kg\" --minimize \"rms(shaking)\" --json");
  CHECK(std::abs(j["best"]["values"]["counterweight"].get<double>() - 3.5) <= 1e-3);
  CHECK(j["best"]["value"].get<double>() < j["start"]["value"].get<double>());
  CHECK(j["ended"] == "converged");
  CHECK(j["best"]["unit"] == "N");
  // With a limit of 2.5 kg at the limit, by the method for conditions.
  const Json limited =
      json_of("optimize " + engine() + " --vary counterweight=\"0.1 kg:10 kg\" --minimize \"=rms(shaking)\"" +
              " --subject-to \"counterweight < 2.5 kg\" --json");
  CHECK(std::abs(limited["best"]["values"]["counterweight"].get<double>() - 2.5) <= 1e-4);
}

TEST_CASE("optimize: a four-bar whose coupler point passes ten points", "[plugin][runner]") {
  if (is_left_out()) return;
  // Acharyya and Mandal, "Performance of EAs for four-bar linkage synthesis", Mechanism and Machine Theory 44 (2009), ten
  // points without timing: every 40 degrees on an ellipse about (10, 10) with semi-axes 10 and 8, the first one twice.
  // Their best sum of squares is 1.95 (differential evolution). The limit here is a tenth of it.
  std::vector<std::array<double, 2>> points;
  for (int k = 0; k < 10; ++k)
    points.push_back({10 + 10 * std::cos(2 * pi * k / 9), 10 + 8 * std::sin(2 * pi * k / 9)});
  const std::string words =
      "optimize " + four_bar() +
      " --vary base=5:80 --vary crank=5:80 --vary coupler=5:80 --vary rocker=5:80 --vary px=-60:60"
      " --vary py=-60:60 --vary x0=-60:60 --vary y0=-60:60 --minimize \"" +
      error_of_path(points) + "\" --method neldermead";
  const Json j = json_of(words + " --runs 500 --write path_found.json --json");
  CHECK(j["start"]["value"].get<double>() > 1000);
  CHECK(j["best"]["value"].get<double>() < 0.195);
  // A second way to the distances: the path at close instants by closed form.
  const Json& v = j["best"]["values"];
  const auto of = [&](const char* name) { return v[name].get<double>(); };
  std::vector<double> least(points.size(), HUGE_VAL);
  constexpr int kInstants = 20000;
  for (int i = 0; i < kInstants; ++i) {
    const double angle = 2 * pi * i / kInstants, bx = of("crank") * std::cos(angle), by = of("crank") * std::sin(angle);
    const double dx = of("base") - bx, dy = -by, bd2 = dx * dx + dy * dy, c = of("coupler"), r = of("rocker");
    const double beta = std::atan2(dy, dx) + std::acos((c * c + bd2 - r * r) / (2 * c * std::sqrt(bd2)));
    const double x = of("x0") + bx + of("px") * std::cos(beta) - of("py") * std::sin(beta);
    const double y = of("y0") + by + of("px") * std::sin(beta) + of("py") * std::cos(beta);
    for (std::size_t k = 0; k < points.size(); ++k)
      least[k] = std::min(least[k], std::pow(x - points[k][0], 2) + std::pow(y - points[k][1], 2));
  }
  double sum = 0;
  for (const double d : least) sum += d;
  CHECK(std::abs(sum - j["best"]["value"].get<double>()) <= 1e-4 * sum);
}

TEST_CASE("searches reject a name of a column and of a parameter", "[plugin][runner]") {
  if (is_left_out()) return;
  // The column falls from 0 to -5 m, the parameter of its name is constant.
  const std::string members = R"--("gravity": [0, -10, 0], "parameters": {"height": "2 m", "v": "1 m/s"},
    "bodies": [{"name": "b", "particle": 1, "velocity": ["=v", 0, 0]}],
    "run": {"until": 1, "output": 0.1, "record": [{"height": "b.y"}, {"x": "b.x"}]})--";
  const auto scene = [&](const std::string& more) { return scene_file("shared_name", members + more); };
  const std::string s = scene("");
  CHECK(call("run " + s + " --no-picture").exit == 0);
  const std::vector<std::string> words{"\"height\" is both a parameter (", "shared_name.json:2:",
                                       "and a recorded column (", "shared_name.json:4:", "rename one of them"};
  const auto check = [&](const std::string& command, const std::string& option, const std::string& formula) {
    std::vector<std::string> all = words;
    all.push_back(option + ": ");
    check_refused(call(command + " " + option + " \"" + formula + "\""), 2, all);
  };
  check("find " + s + " --vary height=1:3", "--reach", "min(height) = 2 m");
  check("optimize " + s + " --vary v=1:3", "--minimize", "min(height)");
  check("optimize " + s + " --vary v=1:3", "--maximize", "height + x");
  check("optimize " + s + " --vary v=1:3 --minimize x", "--subject-to", "height > -9 m");
  check("sensitivity " + s + " --to v", "--of", "min(height)");
  // In quotes it is the column.
  const Json j = json_of("optimize " + s + " --vary v=1:3 --minimize \"min('height')*x\" --json");
  CHECK(std::abs(j["best"]["value"].get<double>() + 5 * 3) <= 1e-4);
  // A condition of the scene is read in each run.
  const std::string conditions = scene(R"--(, "require": ["=height > 1 m"])--");
  check_refused(call("run " + conditions + " --no-picture"), 3, words);
  check_refused(call("check " + conditions), 3, words);
  check_refused(call("find " + conditions + " --vary v=1:3 --reach \"x = 2 m\""), 3, words);
}

TEST_CASE("optimize: a start at which the derivative vanishes may be a maximum", "[plugin][runner]") {
  if (is_left_out()) return;
  // A throw by 10 m/s lands at 10 m sin(2 th).
  const std::string scene = scene_file("throw", R"~("gravity": [0, -10, 0], "parameters": {"th": "45 deg"},
    "bodies": [{"name": "b", "particle": 1, "velocity": ["=10 m/s*cos(th)", "=10 m/s*sin(th)", 0]}],
    "events": [{"name": "land", "when": {"channel": "b.y", "direction": "falling"}, "stop": true}],
    "run": {"until": 5, "output": 0.1, "record": ["b.x"]})~");
  const std::string words = "optimize '" + scene + "' --vary th=10deg:80deg --minimize b.x";
  const Json j = json_of(words + " --json");
  CHECK(std::abs(j["best"]["value"].get<double>() - 10 * std::sin(pi / 9)) <= 1e-6);
  const Called outside = call(words + " --set th=85deg --subject-to \"b.x > 5 m && b.x < 8 m\"");
  INFO(outside.text);
  CHECK(outside.exit == 0);
  CHECK(contains(outside.text, "th of the scene is outside of its range"));
  CHECK(contains(value_of(outside.text, "best"), "5 m with "));
}

TEST_CASE("optimize: the page of the first and the best run", "[plugin][runner]") {
  if (is_left_out()) return;
  // F = m r w^2 + m g, so that the speed is largest at the limit of 100 N.
  const Called best = call("optimize " + rotor() + " --vary speed=\"5 rad/s:20 rad/s\" --maximize \"max(F)\"" +
                           " --subject-to \"max(F) < 100 N\" --quiet --report best.html");
  INFO(best.text);
  CHECK(best.exit == 0);
  check_rotor_page("best.html", 10, std::sqrt((100 - 2 * 9.81) / (2 * 0.3)));
}

TEST_CASE("optimize: without a point that meets all conditions, the least broken one", "[plugin][runner]") {
  if (is_left_out()) return;
  // F > 200 N and F < 100 N. The scale of an excess is the larger side at the start, where F = 79.62 N: 200 N and 100 N.
  // The larger excess is least where both are equal, whatever the objective is.
  const double first = 200, second = 100, force = (200 * second + 100 * first) / (first + second);
  const double speed = std::sqrt((force - 2 * 9.81) / (2 * 0.3));
  for (const char* objective : {"--minimize", "--maximize"}) {
    INFO(objective);
    const Called none =
        call("optimize " + rotor() + " --vary speed=5:20 " + objective + " \"max(F)\"" +
             " --subject-to \"max(F) > 200 N\" --subject-to \"max(F) < 100 N\" --method cobyla --write least_broken.json");
    INFO(none.text);
    CHECK(none.exit == 1);
    CHECK(contains(none.text, "they held together in no run"));
    const Json written = Json::parse(std::ifstream(kRunnerFolder + "/least_broken.json"));
    CHECK(std::abs(std::stod(written["parameters"]["speed"].get<std::string>()) - speed) <= 1e-4);
  }
}

TEST_CASE("optimize: maximum, conditions that cannot hold, and errors", "[plugin][runner]") {
  if (is_left_out()) return;
  // F = m r w^2 + m g is largest at the upper ends of both ranges.
  const Json j = json_of("optimize " + rotor() + " --vary speed=5:20 --vary r=0.1:0.5 --maximize \"max(F)\" --json");
  CHECK(std::abs(j["best"]["value"].get<double>() - 2 * (0.5 * 400 + 9.81)) <= 1e-4);
  const std::string begin = "optimize " + rotor() + " --vary speed=5:20 ";
  const Called none = call(begin + "--minimize \"max(F)\" --subject-to \"max(F) > 1 kN\" --runs 30");
  INFO(none.text);
  CHECK(none.exit == 1);
  CHECK(contains(none.text, "they held together in no run"));
  check_refused(call(begin), 2, {"--minimize: a formula is missing"});
  check_refused(call(begin + "--minimize \"max(F)\" --subject-to \"max(F) = 3 N\""), 2, {"is an equation"});
  check_refused(call(begin + "--minimize \"max(F)\" --subject-to \"max(F) < 3 N\" --method neldermead"), 2,
                {"neldermead takes no conditions"});
  check_refused(call("optimize " + engine() + " --set rod=0.05 --vary counterweight=0:1 --minimize \"rms(shaking)\""),
                1, {"the first run", "failed"});
}

TEST_CASE("optimize: no more runs than asked for, and a minimum next to runs that fail", "[plugin][runner]") {
  if (is_left_out()) return;
  const std::string words = "optimize " + engine() + " --vary rod=\"150 mm:400 mm\" --vary counterweight=1:9" +
                            " --minimize \"rms(shaking)\" --json --runs ";
  for (const long most : {1L, 4L, 6L, 11L}) CHECK(json_of(words + std::to_string(most))["runs"].get<long>() <= most);
  // The mass is at sqrt(1 - q) r from the pin, so that no run has q > 1; the minimum is at sqrt(1 - q) = 0.5.
  const std::string edge = scene_file("edge", R"--(
  "parameters": {"q": 0.99995, "x": "=sqrt(1 - q)*1 m"}, "gravity": [0, 0, 0],
  "bodies": [{"name": "mass", "mass": 1, "inertia": [1, 1, 1], "position": ["=x", 0, 0]}],
  "joints": [{"name": "A", "type": "fixed", "p": "mass", "s": "ground", "at": [0, 0, 0]}],
  "run": {"until": 0.1, "output": 0.1, "record": [{"arm": "mass.x"}]})--");
  const Json j = json_of("optimize " + edge + " --vary q=0:2 --minimize \"(arm - 0.5 m)^2\" --json");
  INFO(j.dump());
  CHECK(std::abs(j["best"]["values"]["q"].get<double>() - 0.75) <= 1e-3);
  CHECK(j["failed"].get<long>() > 0);
}

TEST_CASE("find: a jump is no solution, and an end of the range may be one", "[plugin][runner]") {
  const std::string begin = "find " + formulas() + " --vary q=-1:1 --tolerance 1e-6 --reach ";
  check_refused(call(begin + "\"(q < 0.3 ? -1 : 1)*exp(8*abs(q - 0.3)) = 0\""), 1, {"jumps over the value"});
  check_refused(call(begin + "\"(q < 0.3 ? q - 1 : (q - 0.3)*1000 + 0.5) = 0\""), 1, {"jumps over the value"});
  CHECK(std::abs(json_of(begin + "\"1e6*(q - 0.3) = 0\" --json")["values"]["q"].get<double>() - 0.3) <= 1e-7);
  CHECK(json_of(begin + "\"(q - 1)^3 = 0\" --json")["values"]["q"] == 1);
  check_refused(call("find " + formulas() + " --vary p=0:2 --reach \"p = 0.5\""), 1,
                {"the run with p = 2 failed: wrong;", "does not hold"});
}

TEST_CASE("optimize: conditions hold by their size at the point, and a start of nothing is no scale",
          "[plugin][runner]") {
  if (is_left_out()) return;
  const std::string begin = "optimize " + formulas() + " --json --vary q=-2:2 ";
  for (const char* start : {"-1", "2"}) {
    const Json j = json_of(begin + "--set q=" + start + " --maximize q --subject-to \"exp(10*q) < 1\"");
    INFO(j.dump());
    CHECK(std::abs(j["best"]["values"]["q"].get<double>()) <= 1e-4);
  }
  const Json j = json_of(begin + "--minimize \"sin(pi) + (q - 1.3)*(q - 0.5)\"");
  INFO(j.dump());
  CHECK(std::abs(j["best"]["values"]["q"].get<double>() - 0.9) <= 1e-4);
  const Called broken = call("optimize " + formulas() + " --vary L=\"1 m:2 m\" --maximize x --quiet");
  INFO(broken.text);
  CHECK(broken.exit == 9);
  CHECK(contains(broken.text, "requirement"));
}

}  // namespace search_values_test
