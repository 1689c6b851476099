// SPDX-License-Identifier: BSD-3-Clause
// The files of a run beside its rows: headers of columns, rows at jumps, pictures of columns and of paths.
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <lockstep/recorder.h>
#include <lockstep/scene.h>
#include <lockstep/sweep.h>
#include "framework/tools/program/detail_rows.h"
#include "framework/tools/program/pictures.h"
#include "framework/tools/scene_run/scene_run.h"
#include "tests/support/catch.h"
#include "tests/support/gnuplot_here.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"
#include "tests/support/worst.h"

namespace runner_pictures_test {

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;

TEST_CASE("headers of columns are plain on request", "[runner]") {
  const auto header = [](const std::string& file) {
    std::ifstream in(kRunnerFolder + "/" + file);
    std::string line;
    std::getline(in, line);
    return line;
  };
  const std::string run = "run '" + kFourBar + "' --until 0.05 --quiet --no-picture ";
  CHECK(call(run + "--record units.csv").exit == 0);
  CHECK(call(run + "--record plain.csv --headers plain").exit == 0);
  CHECK(header("units.csv").starts_with("t [s],theta [rad],theta_d [rad/s]"));
  CHECK(header("plain.csv").starts_with("t,theta,theta_d,"));
  CHECK_FALSE(contains(header("plain.csv"), "["));
  const Table units = read_csv(kRunnerFolder + "/units.csv"), plain = read_csv(kRunnerFolder + "/plain.csv");
  REQUIRE(units.names() == plain.names());
  for (const std::string& name : units.names()) CHECK(units[name] == plain[name]);
  CHECK(call(run + "--record scene.csv --set run.headers=plain").exit == 0);
  CHECK(header("scene.csv") == header("plain.csv"));
  CHECK(call(run + "--record scene.csv --set run.headers=plain --headers units").exit == 0);
  CHECK(header("scene.csv") == header("units.csv"));
  check_refused(call(run + "--headers bare"), 2, {"--headers: unknown \"bare\"; known: units, plain"});
  CHECK(call("sweep '" + kFourBar +
             "' --vary crank='90 mm,100 mm' --until 0.02 --quiet --record plain_sweep.csv --headers plain")
            .exit == 0);
  CHECK(header("plain_sweep.csv").starts_with("run,crank,t final,theta final,theta min,theta max,"));
}

// A stop with restitution 0.8: the rate after an impact is -0.8 times that before it.
TEST_CASE("outputs at jumps are just before and after them", "[runner]") {
  const std::string scene = std::string(paths::kScenes) + "/bouncing_pendulum.json";
  CHECK(call("run '" + scene + "' --quiet --no-picture --record without.csv").exit == 0);
  CHECK(call("run '" + scene + "' --quiet --no-picture --record with.csv --at-jumps").exit == 0);
  const Table without = read_csv(kRunnerFolder + "/without.csv"), with = read_csv(kRunnerFolder + "/with.csv");
  int impacts = 0;
  std::vector<double> others;
  for (std::size_t i = 0; i < with.n_rows(); ++i) {
    const bool pair = i + 1 < with.n_rows() && with["t"][i] == with["t"][i + 1];
    const bool after = i > 0 && with["t"][i] == with["t"][i - 1];
    if (pair) {
      ++impacts;
      CHECK(with["phi_d"][i] < 0);
      CHECK(std::abs(with["phi_d"][i + 1] + 0.8 * with["phi_d"][i]) < 1e-9);
      CHECK(std::abs(with["phi"][i]) < 1e-8);
    } else if (!after) {
      others.push_back(with["phi_d"][i]);
    }
  }
  CHECK(impacts == 9);
  CHECK(others == without["phi_d"]);  // bit for bit: what is between is the same run
}

TEST_CASE("pictures of one column against another are drawn on request", "[runner]") {
  const std::string run = "run '" + kFourBar + "' --until 0.1 --record path.csv ";
  for (const char* name : {"path.By_over_Bx.png", "path.By_over_Bx.svg"})
    fs::remove(kRunnerFolder + "/" + std::string(name));
  const Called r = call(run + "--picture Bx:By --picture t:theta --picture Bx:By");
  INFO(r.text);
  CHECK(r.exit == 0);
  testing::require_gnuplot();
  for (const char* name : {"path.By_over_Bx.png", "path.By_over_Bx.svg", "path.theta_over_t.svg"}) {
    CHECK(contains(r.text, name));
    CHECK(r.text.find(name) == r.text.rfind(name));  // once
    CHECK(fs::file_size(kRunnerFolder + "/" + std::string(name)) > 1000);
  }
  std::ifstream svg(kRunnerFolder + "/path.By_over_Bx.svg");
  const std::string text((std::istreambuf_iterator<char>(svg)), {});
  for (const char* word : {"Bx [N]", "By [N]", "start"}) CHECK(contains(text, word));
  check_refused(call(run + "--picture Bx:Bz"), 2, {"\"Bz\" is not recorded"});
  CHECK(contains(call(run + "--picture Bx").text, "expected X:Y"));
  check_refused(call(run + "--picture Bx:By --no-picture"), 2, {"--picture excludes --no-picture"});
  const std::string scene = scene_file("pictured", kArm + R"("gravity": [0,-9.81,0], "links": [{)" + kHinge + R"(}],
    "run": {"until": 0.2, "output": 0.05, "record": ["arm.x", "arm.y"], "pictures": [{"x": "arm.x", "y": "arm.y"}]})");
  CHECK(contains(call("run '" + scene + "'").text, "pictured.arm.y_over_arm.x.png"));
  const std::string wrong = scene_file("mispictured", kArm + R"("run": {"until": 0.2, "record": ["arm.x"],
    "pictures": [{"x": "arm.x", "y": "arm.z"}]})");
  const Called refused = call("check '" + wrong + "'");
  CHECK(refused.exit == 3);
  CHECK(contains(refused.text, "run.pictures[0].y: \"arm.z\" is not recorded"));
}

// Once round a circle in 17001 rows, of which every second is drawn; the table has them all.
TEST_CASE("a path of a long run uses recorded values of one time each", "[runner]") {
  const std::string scene = scene_file("round", R"("gravity": [0, 0, 0],
    "bodies": [{"name": "b", "particle": 1, "position": [1, 0, 0], "velocity": [0, 1, 0]}],
    "forces": [{"name": "F", "type": "spring_damper", "p": "b", "s": "ground", "at_s": [0, 0, 0], "stiffness": 1,
      "free_length": 0}],
    "run": {"until": 6.8, "output": 4e-4, "integrator": "dop853", "tolerance": 1e-10, "record": ["b.x", "b.y"]})");
  fs::remove(kRunnerFolder + "/round.b.y_over_b.x.svg");
  const Called r = call("run '" + scene + "' --verbose --picture b.x:b.y");
  INFO(r.text);
  CHECK(r.exit == 0);
  CHECK(value_of(r.text, "rows") == "17001");
  testing::require_gnuplot();
  CHECK(contains(r.text, "paths connect one row in 2"));
  CHECK_FALSE(contains(r.text, "curves connect the ends of steps"));  // no rows within steps were asked for
  std::ifstream in(kRunnerFolder + "/round.b.y_over_b.x.svg");
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  const std::size_t path = text.find(" d='M", text.find("gnuplot_plot_1"));
  REQUIRE(path != std::string::npos);
  std::istringstream points(text.substr(path + 5, text.find('\'', path + 5) - path - 5));
  std::vector<double> x, y;  // pixels
  char mark = 0;
  for (double a = 0, b = 0; points >> a >> mark >> b; x.push_back(a), y.push_back(b))
    while (std::isspace(points.peek()) != 0 || points.peek() == 'L') points.get();
  REQUIRE(x.size() > 1000);
  const auto [left, right] = std::minmax_element(x.begin(), x.end());
  const auto [low, high] = std::minmax_element(y.begin(), y.end());
  const double radius = (*right - *left) / 2;
  double off = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    keep_worst(off, std::abs(std::hypot(x[i] - (*left + *right) / 2, y[i] - (*low + *high) / 2) - radius));
  CHECK(radius > 100);
  CHECK(off < 0.5);
}

TEST_CASE("kinematics, inverse and statics --vary draw as a run does", "[runner]") {
  testing::require_gnuplot();
  const auto drawn = [](const std::string& command, const std::string& file) {
    for (const char* ending : {".svg", ".png"}) fs::remove(kRunnerFolder + "/" + file + ending);
    const Called called = call(command);
    INFO(called.text);
    CHECK(called.exit == 0);
    CHECK(contains(called.text, file + ".svg"));
    std::ifstream svg(kRunnerFolder + "/" + file + ".svg");
    return std::string((std::istreambuf_iterator<char>(svg)), {});
  };
  const std::string rest = " '" + kFourBar + "' --until 0.1 --record driven.csv";
  for (const char* command : {"kinematics", "inverse"}) {
    const std::string text = drawn(command + rest, "driven");  // the panels of the scene
    for (const char* word : {"t [s]", "coupler", "rocker", "drive_torque"}) CHECK(contains(text, word));
    CHECK_FALSE(contains(text, "theta_dd"));
    CHECK(contains(drawn(command + rest + " --picture Bx:By", "driven.By_over_Bx"), "By [N]"));
  }
  fs::remove(kRunnerFolder + "/driven.svg");
  CHECK(call("kinematics" + rest + " --no-picture").exit == 0);
  CHECK_FALSE(fs::exists(kRunnerFolder + "/driven.svg"));
  check_refused(call("inverse" + rest + " --picture Bx:Bz"), 2, {"\"Bz\" is not recorded"});

  const std::string lift =
      "statics '" + std::string(paths::kScenes) + "/scissor_lift.json' --record raised.csv --vary ";
  const std::string text = drawn(lift + "angle='15 deg:40 deg:5'", "raised");
  for (const char* word : {"parameters.angle [rad]", "height"}) CHECK(contains(text, word));
  fs::remove(kRunnerFolder + "/raised.svg");
  CHECK(call(lift + "angle='15 deg:40 deg:3' --no-picture").exit == 0);
  CHECK_FALSE(fs::exists(kRunnerFolder + "/raised.svg"));
  const Called other = call(lift + "stages=1,2 --no-picture");
  CHECK(other.exit == 1);
  CHECK(contains(other.text, "its columns are not those of the values before"));
}

TEST_CASE("the table of a picture has the drawn columns, and no others", "[runner]") {
  const std::string text = R"({"lockstep": 1, "bodies": [{"name": "b", "particle": 1, "position": [1, 0, 0]}],
    "run": {"until": 1, "record": ["b.x", {"y": "b.y"}, "b.vx", "b.vy"], "draw": [["y"]]}})";
  const Registry registry = builtin_registry();
  Mechanism m = build_mechanism(scene_from_text(text, "s.json"), registry);
  const auto recorder = make_recorder(m);
  const auto drawn = drawn_columns(recorder->table(), m.run.draw, {{.x = "b.x", .y = "b.vx"}});
  CHECK(drawn == std::set<std::string>{"b.vx", "b.x", "y"});
  CHECK(make_recorder(m, &drawn)->table().names() == std::vector<std::string>{"t", "b.x", "y", "b.vx"});
  CHECK(drawn_columns(recorder->table(), {}, {}) == std::set<std::string>{"b.vx", "b.vy", "b.x", "y"});
}

// x = cos(w t): between rows half a swing apart the picture's rows lie on the curve.
TEST_CASE("the table of a picture is dense if the method can interpolate", "[runner]") {
  const std::string text = R"~({"lockstep": 1, "bodies": [{"name": "b", "particle": 1, "position": [1, 0, 0]}],
    "forces": [{"name": "F", "type": "spring_damper", "p": "b", "s": "ground", "at_s": [-9, 0, 0], "stiffness": 4, "free_length": 9}],
    "run": {"tolerance": 1e-10, "output": 1.5, "until": 6, "record": ["b.x", "b.vx", {"moved": "=integral(b.vx)"}],
            "integrator": )~";
  for (const bool dense : {true, false}) {
    const Registry registry = builtin_registry();
    const std::string method = dense ? R"("dop853"}})" : R"({"type": "rattle2"}, "step": 0.004}})";
    Mechanism m = build_mechanism(scene_from_text(text + method, "s.json"), registry);
    const auto recorder = make_recorder(m);
    const StepLoopOptions options{.step = m.run.step, .tolerance = m.run.tolerance, .output = m.run.output};
    PictureRows rows(make_recorder(m), *recorder, picture_spacing(options, m.run.until));
    Dynamics dynamics(system_of(m), make_solver(m.run, registry));
    StepLoop loop(dynamics, make_integrator(m.run, registry), options);
    loop.add_observer(*recorder), loop.add_observer(rows);
    loop.run_until(6);
    const Table all = rows.together(recorder->table());
    CHECK(recorder->table().n_rows() == 5);
    CHECK(all.n_rows() > 450);
    CHECK(all.n_rows() < 620);
    CHECK(rows.joins_steps() == !dense);
    double worst = 0, off = 0, gap = 0;
    for (std::size_t i = 0; i < all.n_rows(); ++i) {
      const double t = all["t"][i];
      keep_worst(worst, std::abs(all["b.x"][i] - std::cos(2 * t)));
      keep_worst(off, std::abs(all["moved"][i] - (std::cos(2 * t) - 1)));
      if (i > 0) keep_worst(gap, t - all["t"][i - 1]);
      if (i > 0) CHECK(t > all["t"][i - 1]);
    }
    CHECK(worst < (dense ? 1e-8 : 1e-3));
    CHECK(off < 1e-3);
    CHECK(gap < 0.023);
  }
  CHECK(picture_spacing({.output = 0.01}, 6) == std::numeric_limits<double>::infinity());  // dense already
  CHECK(picture_spacing({.output = 0.1}, 6) == Approx(0.01));
}

}  // namespace runner_pictures_test
