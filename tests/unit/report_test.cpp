// SPDX-License-Identifier: BSD-3-Clause
// The report of a run: what the page holds, against the run itself.
#include <lockstep/report.h>

#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include <lockstep/error.h>
#include <lockstep/forces.h>
#include <lockstep/joints.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include <lockstep/sweep.h>
#include "framework/tools/report/frames.h"
#include "framework/tools/report/numbers.h"
#include "framework/tools/report/page.h"
#include "framework/tools/scene_run/scene_run.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/paths.h"
#include "tests/support/report_page.h"

namespace report_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::message_of;
using namespace lockstep::report_page;
namespace fs = std::filesystem;

namespace {

// A pendulum on a spring, with a stop that it hits.
struct Pendulum {
  System system{{.gravity = {0, -9.81, 0}}};
  Body& rod = system.add_body("rod", shapes::rod(2, {0, 0, 0}, {1, 0, 0}));
  Lock& hinge = system.add<Revolute>("A", rod, system.ground(), pose_at({0, 0, 0}));
  Marker& tip = system.add_marker_at("tip", rod, pose_at({1, 0, 0}));
  Marker& post = system.add_marker_at("post", system.ground(), pose_at({1, 1, 0}));
  Force& spring = system.add<SpringDamper>("spring", tip, post, {.stiffness = 30, .free_length = 0.5});
};

}  // namespace

TEST_CASE("a column in single precision keeps what it changes by", "[report]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const std::vector<double>& values : std::vector<std::vector<double>>{
           {1e6 + 1e-3, 1e6 + 2e-3, 1e6 - 5e-4}, {-3.25, 0.1, 7e-9, 4.5}, {1e-300, 2e-300}, {0, nan, 1e38}, {5}, {}}) {
    report::Numbers numbers;
    const std::vector<float> before{1.0F};  // what follows begins at a multiple of 8
    numbers.add(std::span<const float>(before));
    const Json place = numbers.add_column(values);
    CHECK(place["at"].get<std::size_t>() == 8);
    const std::vector<double> back = read(bytes_of(numbers.base64()), place);
    REQUIRE(back.size() == values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      INFO(values[i]);
      if (std::isnan(values[i]))
        CHECK(std::isnan(back[i]));
      else
        CHECK(std::abs(back[i] - values[i]) <= 1e-7 * std::min(std::abs(values[i]), 1e3));
    }
  }
}

TEST_CASE("base64 is that of RFC 4648", "[report]") {
  for (const auto& [plain, text] : std::vector<std::pair<std::string, std::string>>{
           {"light wor", "bGlnaHQgd29y"}, {"light wo", "bGlnaHQgd28="}, {"light w", "bGlnaHQgdw=="}}) {
    report::Numbers numbers;
    std::vector<double> eight(1);
    std::memcpy(eight.data(), plain.data(), std::min<std::size_t>(8, plain.size()));
    numbers.add(std::span<const double>(eight));
    const std::string base64 = numbers.base64();
    CHECK(base64.substr(0, 8) == text.substr(0, 8));
    CHECK(bytes_of(base64).size() == 8);
  }
}

TEST_CASE("a report holds columns, poses and loads of its run", "[report]") {
  Pendulum p;
  Simulation run(p.system, {.output = 0.02});
  const Table& table =
      run.record({"rod.x", "rod.y", "rod.qw", "A.force_on_p_world_y", "spring.force", "tip.x", "tip.y"});
  Report report(run.recorder());
  run.add_observer(report);
  run.run_until(1);
  const Page page(report.page({.title = "a pendulum"}));

  for (const Column& column : table.columns()) {
    const std::vector<double> shown = page.column(column.name);
    REQUIRE(shown.size() == column.values.size());
    for (std::size_t i = 0; i < shown.size(); ++i)
      CHECK(std::abs(shown[i] - column.values[i]) <= 1e-7 * std::abs(column.values[i]));
  }

  const Json& frames = page.data["frames"];
  const std::vector<double> times = read(page.bytes, frames["times"]), rows = read(page.bytes, frames["rows"]);
  const std::size_t width = frames["width"];
  REQUIRE(rows.size() == times.size() * width);
  CHECK(width == 13 + 2 * 6);  // one body; the hinge and the spring
  const Json& loads = page.data["mechanism"]["loads"];
  REQUIRE(loads.size() == 2);
  CHECK(loads[0]["name"] == "A");
  CHECK(loads[1]["name"] == "spring");
  std::size_t found = 0;
  for (std::size_t row = 0; row < table.n_rows(); ++row)
    for (std::size_t k = 0; k < times.size(); ++k) {
      if (times[k] != table["t"][row]) continue;
      ++found;
      const double* frame = rows.data() + k * width;
      CHECK(frame[0] == Approx(table["rod.x"][row]).margin(1e-7));
      CHECK(frame[1] == Approx(table["rod.y"][row]).margin(1e-7));
      CHECK(frame[3] == Approx(table["rod.qw"][row]).margin(1e-7));
      CHECK(frame[14] == Approx(table["A.force_on_p_world_y"][row]).margin(1e-5));
      // The spring pulls the tip towards the post.
      const Vec3 pull(1 - table["tip.x"][row], 1 - table["tip.y"][row], 0);
      const Vec3 force = table["spring.force"][row] * pull.normalized();
      CHECK((Vec3(frame[19], frame[20], frame[21]) - force).norm() < 1e-5);
      CHECK(Vec3(frame[22], frame[23], frame[24]).norm() < 1e-5);
    }
  CHECK(found == table.n_rows());
}

// Every column is zero but in two rows, one value in each, and 80 columns of 100 001 rows are 33 MB.
TEST_CASE("the page of a long run has 20 MB at most, with the extremes of all columns", "[report]") {
  constexpr long kColumns = 80;
  Pendulum p;
  Simulation run(p.system, {.output = 1e-5});
  for (long k = 0; k < kColumns; ++k)
    run.record("c" + std::to_string(k), [k](const Sample& s) {
      const long row = std::lround(1e5 * s.state.t);
      return row == 777 + 1111 * k ? 5.0 + static_cast<double>(k) : row == 99'123 - 1111 * k ? -3.0 : 0.0;
    });
  Report report(run.recorder());
  run.add_observer(report);
  run.run_until(0.1);
  CHECK(Page(report.page()).data["table"]["stride"] == 1);  // so far all fit
  CHECK(report.left_out().empty());
  run.run_until(1);
  REQUIRE(run.table().n_rows() == 100'001);
  const Page page(report.page());
  CHECK(page.text.size() <= 20'000'000);
  CHECK(page.text.size() > 10'000'000);  // no more is left out than must be
  const Json& table = page.data["table"];
  for (long k = 0; k < kColumns; ++k) {
    const std::vector<double> curve = read(page.bytes, table["columns"][k + 1]["curve"]);
    CHECK(std::ranges::max(curve) == 5.0 + static_cast<double>(k));
    CHECK(std::ranges::min(curve) == -3.0);
  }
  const auto stride = table["stride"].get<std::size_t>();
  const std::vector<double> rows = page.column("t"), curve = read(page.bytes, table["columns"][0]["curve"]);
  CHECK(stride > 1);
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) CHECK(rows[i] == run.table()["t"][i * stride]);
  CHECK(std::ranges::is_sorted(curve));
  const Json& frames = page.data["frames"];
  const std::vector<double> times = read(page.bytes, frames["times"]);
  for (const auto* t : {&rows, &curve, &times}) CHECK((t->front() == 0 && t->back() == 1));
  double gap = 0;
  for (std::size_t i = 1; i < times.size(); ++i) gap = std::max(gap, times[i] - times[i - 1]);
  CHECK(gap < 1.01e-5 * frames["stride"].get<double>());
  CHECK(report.left_out() == "1 row in " + std::to_string(stride) + ", 1 frame in " + frames["stride"].dump());
}

// A step rotates by 0.19 rad: every second one has moved far, eight times as many as there is room for.
TEST_CASE("frames of a long rotation are evenly spread", "[report]") {
  System system;
  system.add_body("rotor", shapes::box(1, {1, 1, 1})).start.w = {0, 0, 2 * kPi};
  Simulation run(system, {.step = 0.03, .output = 500});
  report::Frames frames(1000 * (13 * sizeof(float) + sizeof(double)));
  run.add_observer(frames);
  run.run_until(500);
  const std::vector<double>& times = frames.times();
  CHECK(times.size() <= 1000);
  CHECK(times.size() >= 500);
  CHECK(times.back() == 500);
  double least = 500, most = 0;
  for (std::size_t i = 1; i + 1 < times.size(); ++i) {
    least = std::min(least, times[i] - times[i - 1]);
    most = std::max(most, times[i] - times[i - 1]);
  }
  CAPTURE(least, most);
  CHECK(most < 3 * least);
}

TEST_CASE("a report changes nothing of its run", "[report]") {
  const auto columns = [](bool with_report) {
    Pendulum p;
    Simulation run(p.system, {.integrator = "dop853", .output = 0.05});
    run.record({"rod.angle_z", "A.force_on_p_world_x", "energy.total", "evaluations", "step"});
    Report report(run.recorder());
    if (with_report) run.add_observer(report);
    run.run_until(1);
    return run.table().columns();
  };
  const std::vector<Column> without = columns(false), with = columns(true);
  REQUIRE(without.size() == 6);
  for (std::size_t c = 0; c < without.size(); ++c) CHECK(without[c].values == with[c].values);
}

TEST_CASE("active parts of a run are marked, with frames before and after", "[report]") {
  Pendulum p;
  Simulation run(p.system, {.output = 0.1});
  run.record({"rod.x"});
  run.add_event({.name = "cut", .at = 0.33, .deactivate = {"A"}});
  Report report(run.recorder());
  run.add_observer(report);
  run.run_until(0.5);
  const Page page(report.page());
  REQUIRE(page.data["marks"].size() == 1);
  CHECK(page.data["marks"][0]["what"] == "event 'cut'");
  CHECK(page.data["marks"][0]["t"].get<double>() == 0.33);
  REQUIRE(page.data["switches"]["later"].size() == 1);
  CHECK(page.data["switches"]["at_start"] == Json::array({true}));
  CHECK(page.data["switches"]["later"][0] == Json{{"t", 0.33}, {"link", 0}, {"active", false}});
  const std::vector<double> times = read(page.bytes, page.data["frames"]["times"]);
  REQUIRE(page.data["frames"]["jumps"].size() == 1);
  CHECK(times[page.data["frames"]["jumps"][0].get<std::size_t>()] == 0.33);
  CHECK(std::is_sorted(times.begin(), times.end()));
  CHECK(times.back() == 0.5);
}

TEST_CASE("few outputs leave frames where bodies moved far", "[report]") {
  Pendulum p;
  p.rod.start.w = {0, 0, 20};
  Simulation run(p.system, {.output = 1});
  run.record({"rod.x"});
  Report report(run.recorder());
  run.add_observer(report);
  run.run_until(1);
  CHECK(run.table().n_rows() == 2);
  const Page page(report.page());
  CHECK(read(page.bytes, page.data["frames"]["times"]).size() > 10);
}

TEST_CASE("hostile names stay text", "[report]") {
  const std::string worst = "</script><script>alert(1)</script><!-- \" ' \\ \x01 \xff @lockstep-numbers@ ";
  const std::string name = worst + std::string(10'000, 'x');
  System system;
  Body& body = system.add_body(name, shapes::box(1, {1, 1, 1}), {});
  body.start.v = {1, 0, 0};
  Simulation run(system, {.output = 0.1});
  run.record({{name, "energy.kinetic"}});
  Report report(run.recorder(), {{name, Solid::Kind::box, {1, 1, 1}}});
  run.add_observer(report);
  run.run_until(0.2);
  const std::string all = report.page({.title = name, .scene = worst, .command = worst, .failure = worst});
  const Page page(all);
  std::string shown = name;
  shown.replace(shown.find('\xff'), 1, "\xef\xbf\xbd");  // no UTF-8: the sign for that
  CHECK(page.data["mechanism"]["bodies"][1]["name"] == shown);
  CHECK(page.data["text"]["title"] == shown);
  CHECK(page.column("t").back() == 0.2);
  // The page has the elements of any other, and no more.
  const std::string plain = report::page_with({{"text", {{"title", ""}}}}, report::Numbers());
  const auto count = [](const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
  };
  for (const char* tag : {"<script", "</script", "<!--", "</title"}) CHECK(count(all, tag) == count(plain, tag));
}

TEST_CASE("a report needs a run and a file that can be written", "[report]") {
  Pendulum p;
  Simulation run(p.system, {.output = 0.1});
  run.record({"rod.x"});
  Report report(run.recorder());
  check_words(message_of<ModelError>([&] { report.write("/nowhere.html"); }), {"the run has not begun", "add_observer", "after the run"});
  run.add_observer(report);
  run.run_until(0.1);
  check_words(message_of<FileError>([&] { report.write("/nowhere/at/all/x.html"); }), {"/nowhere/at/all/x.html"});
  const fs::path file = fs::temp_directory_path() / ("lockstep_report_test_" + std::to_string(::getpid()) + ".html");
  report.write(file.string());
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  CHECK(text.str() == report.page());
  CHECK(!fs::exists(file.string() + ".partial"));
  fs::remove(file);
}

TEST_CASE("every scene of the samples gives a report", "[report]") {
  const Registry registry = builtin_registry();
  std::size_t most = 0;
  for (const auto& entry : fs::directory_iterator(paths::kScenes)) {
    if (entry.path().extension() != ".json" || entry.path().stem() == "nfourbar_40") continue;
    INFO(entry.path().string());
    const Scene scene = read_scene(entry.path().string());
    if (!scene.plugins.empty()) continue;
    Mechanism m = build_mechanism(scene, registry);
    const std::unique_ptr<Recorder> recorder = make_recorder(m);
    Report report(*recorder, m.solids, m.looks);
    Dynamics dynamics(system_of(m), make_solver(m.run, registry), {m.run.formulation, m.run.stabilization});
    State start = m.system.start();
    if (m.run.assemble) assemble(dynamics, start, m.start_speeds);
    StepLoop loop(dynamics, make_integrator(m.run, registry),
                  {.step = m.run.step, .tolerance = m.run.tolerance, .output = m.run.output});
    loop.add_observer(*recorder);
    loop.add_observer(report);
    loop.set_state(std::move(start));
    loop.run_until(std::min(m.run.until, 0.05));
    const Page page(report.page({.title = scene.title}));
    const Json& mechanism = page.data["mechanism"];
    CHECK(mechanism["bodies"].size() == m.system.bodies().size());
    CHECK(mechanism["links"].size() == m.system.links().size());
    const std::vector<double> rows = read(page.bytes, page.data["frames"]["rows"]);
    const auto width = page.data["frames"]["width"].get<std::size_t>();
    REQUIRE(rows.size() >= width);
    for (std::size_t i = 0; i < 13 * mechanism["moving"].size(); ++i) CHECK(std::isfinite(rows[i]));
    std::size_t n_solids = 0;
    for (const Json& body : mechanism["bodies"]) {
      n_solids += body["solids"].size();
      std::vector<Json> sizes, places, drawn, at;
      const auto pose = [](const Pose& p) { return Json::array({p.x[0], p.x[1], p.x[2], p.q.w, p.q.x, p.q.y, p.q.z}); };
      for (const Solid& s : m.solids)
        if (s.body == body["name"])
          sizes.push_back(Json::array({s.size[0], s.size[1], s.size[2]})), places.push_back(pose(s.at));
      for (const Json& solid : body["solids"]) drawn.push_back(solid["size"]), at.push_back(solid["at"]);
      CHECK(drawn == sizes);
      CHECK(at == places);
      CHECK(body["home"] == pose(m.system.body(body["name"].get<std::string>()).home));
    }
    CHECK(n_solids == m.solids.size());
    for (const Json& link : mechanism["links"])  // circles and cams: points in the plane of the marker
      for (const Json& curve : link.value("curves", Json::array()))
        if (curve["closed"]) {
          const auto points = curve["points"].get<std::vector<double>>();
          CHECK((points.size() == 3 * 96 || points.size() == 3 * 240));
          for (std::size_t k = 2; k < points.size(); k += 3) CHECK(points[k] == 0);
        }
    most = std::max(most, page.text.size());
  }
  CHECK(report::page_with({{"text", {{"title", ""}}}}, report::Numbers()).size() < 1'000'000);  // without data
  CHECK(most < 2'000'000);
}

TEST_CASE("a scene defines the shapes of its bodies", "[report]") {
  const auto scene_with = [](const std::string& visual) {
    return scene_from_text(
        R"({"lockstep": 1, "bodies": [{"name": "ball", "sphere": {"mass": 1, "radius": 0.5}, "visual": )" + visual +
            "}]}",
        "ball.json");
  };
  const Registry registry = builtin_registry();
  const Mechanism m = build_mechanism(scene_with(R"({"color": "#00Ff80", "opacity": 0.25})"), registry);
  REQUIRE(m.looks.size() == 1);
  CHECK(m.looks[0].body == "ball");
  CHECK(m.looks[0].color == "#00Ff80");
  CHECK(m.looks[0].opacity == 0.25);
  CHECK(build_mechanism(scene_with("{}"), registry).looks[0].opacity == 1);
  for (const auto& each : std::vector<std::pair<std::string, std::string>>{{R"({"color": "red"})", "#0072b2"},
                                                                           {R"({"color": "#12345g"})", "#0072b2"},
                                                                           {R"({"opacity": 1.5})", "0 to 1"},
                                                                           {R"({"colour": "#000000"})", "color"}})
    check_words(message_of<SceneError>([&] { build_mechanism(scene_with(each.first), registry); }),
                {"body 'ball', visual", each.second});
}

// A wavy sheet of n x n points.
std::shared_ptr<const TriangleMesh> sheet(std::uint32_t n) {
  auto mesh = std::make_shared<TriangleMesh>();
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t k = 0; k < n; ++k)
      mesh->points.push_back({-3.0F + 0.01F * static_cast<float>(i), 0.02F * static_cast<float>(k),
                              std::sin(0.1F * static_cast<float>(i + k))});
  for (std::uint32_t i = 0; i + 1 < n; ++i)
    for (std::uint32_t k = 0; k + 1 < n; ++k) mesh->triangles.push_back({i * n + k, (i + 1) * n + k, i * n + k + 1});
  return mesh;
}

TEST_CASE("a mesh is stored in the page once, with 16 bits per coordinate", "[report]") {
  for (const std::uint32_t n : {40U, 300U}) {  // 1600 points, and more than 16 bits count
    const std::shared_ptr<const TriangleMesh> mesh = sheet(n);
    Pendulum p;
    Simulation run(p.system, {.output = 0.1});
    run.record({"rod.x"});
    const Solid solid{"rod", Solid::Kind::mesh, {2, 2, 2}, {Vec3(0, 0, 1), Quat{}}, mesh};
    Solid equal = solid;
    equal.mesh = sheet(n), equal.size = {1, 1, 1};
    Report report(run.recorder(), {solid, equal, {"rod", Solid::Kind::mesh, {1, 1, 1}}});  // the last has no mesh
    run.add_observer(report);
    run.run_until(0.1);
    const Page page(report.page());
    const Json& solids = page.data["mechanism"]["bodies"][1]["solids"];
    REQUIRE(solids.size() == 2);
    CHECK(solids[0]["kind"] == "mesh");
    CHECK(solids[0]["mesh"] == 0);
    CHECK(solids[1]["mesh"] == 0);
    CHECK(solids[0]["size"] == Json::array({2, 2, 2}));
    REQUIRE(page.data["meshes"].size() == 1);
    const Json& kept = page.data["meshes"][0];
    const std::vector<double> points = read(page.bytes, kept["points"]), corners = read(page.bytes, kept["triangles"]);
    CHECK(kept["triangles"]["bits"] == (n == 40 ? 16 : 32));
    REQUIRE(points.size() == 3 * mesh->points.size());
    REQUIRE(corners.size() == 3 * mesh->triangles.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double low = kept["low"][i % 3], size = kept["size"][i % 3];
      const double shown = low + size * points[i] / 65535, given = mesh->points[i / 3][i % 3];
      if (std::abs(shown - given) > 0.51 * size / 65535) FAIL(i << ": " << shown << " for " << given);
    }
    for (std::size_t i = 0; i < corners.size(); ++i)
      if (corners[i] != mesh->triangles[i / 3][i % 3]) FAIL("corner " << i);
  }
}

TEST_CASE("links of a report are marked by name", "[report]") {
  Pendulum p;
  Simulation run(p.system, {.output = 0.1});
  run.record({"rod.x"});
  Report report(run.recorder());
  run.add_observer(report);
  run.run_until(0.1);
  const Page page(report.page({.marked = {{"A", "it is </script> redundant"}}}));
  CHECK(page.data["text"]["marked"] == Json::array({Json::array({"A", "it is </script> redundant"})}));
}

TEST_CASE("solids are at the place of their mass", "[report]") {
  const Scene scene = scene_from_text(R"({"lockstep": 1, "bodies": [
    {"name": "hammer", "position": [5, 0, 0], "compound": [
      {"rod": {"mass": 1, "from": [0, 0, 0], "to": [0, 0, 2], "radius": 0.1}},
      {"box": {"mass": 3, "size": [0.4, 0.2, 0.6]}, "position": [0, 1, 2], "orientation": {"axis": "x", "angle": "90 deg"}}]},
    {"name": "ball", "sphere": {"density": 1000, "radius": 0.5}},
    {"name": "drum", "fixed": true, "cylinder": {"mass": 1, "radius": 2, "length": 3}}]})",
                                      "hammer.json");
  const Mechanism m = build_mechanism(scene, builtin_registry());
  REQUIRE(m.solids.size() == 4);
  // Mass and inertia from the solids alone, against those of the scene.
  const auto mass_of = [](const Solid& s, double mass) {
    const Vec3 e = s.size;
    const MassProperties own = s.kind == Solid::Kind::box      ? shapes::box(mass, e)
                               : s.kind == Solid::Kind::sphere ? shapes::sphere(mass, e[0] / 2)
                                                               : shapes::cylinder(mass, e[0] / 2, e[2]);
    return shapes::moved(own, s.at);
  };
  const std::vector<MassProperties> parts{mass_of(m.solids[0], 1), mass_of(m.solids[1], 3)};
  const MassProperties hammer = shapes::compound(parts), &given = m.system.body("hammer").mass;
  CHECK((hammer.center - given.center).norm() < 1e-12);
  CHECK((hammer.J - given.J).norm() < 1e-12);
  CHECK(m.solids[2].body == "ball");
  CHECK((mass_of(m.solids[2], m.system.body("ball").mass.mass).J - m.system.body("ball").mass.J).norm() < 1e-9);
  CHECK(m.solids[3].body == "drum");
  CHECK(m.solids[3].size == Vec3(4, 4, 3));
}

}  // namespace report_test
