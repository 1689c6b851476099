// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/charts.h>

#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <lockstep/error.h>
#include "framework/tools/charts/chart_grid.h"
#include "framework/tools/charts/gnuplot.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace chart_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::message_of;
namespace fs = std::filesystem;

namespace {

// A folder for the pictures of one test.
struct Folder {
  Folder() : path(fs::temp_directory_path() / ("lockstep_chart_test_" + std::to_string(getpid()))) {
    fs::remove_all(path);
    fs::create_directory(path);
  }
  ~Folder() { fs::remove_all(path); }
  std::string file(const std::string& name) const { return (path / name).string(); }
  fs::path path;
};

std::string contents(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

ChartSpec two_curves() {
  Series a{"B.force_on_p_world_x [N]", {}, {}}, b{"theory", {}, {}, SeriesStyle::dashes};
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.01 * i;
    a.x.push_back(t), b.x.push_back(t);
    a.y.push_back(std::sin(t)), b.y.push_back(t);
  }
  return {"Sine & its tangent", "t [s]", {{"force [N]", {a, b}}}};
}

MapSpec small_map() {
  MapSpec map;
  map.title = "gain and step";
  map.x_label = "step [s]", map.y_label = "gain [1/s]";
  map.x = {1e-3, 1e-2, 1e-1}, map.y = {1, 10};
  map.log_x = map.log_y = true;
  map.cells = {0, 0, 1, 0, 1, 2};
  map.kinds = {{"works", "#2a9d6f"}, {"inaccurate", "#f2c14e"}, {"fails", "#c8443c"}};
  map.curves = {{"limit", {1e-3, 1e-1}, {20, 1}}};
  return map;
}

void write_map(const std::string& path, const std::vector<MapSpec>& maps) {
  write_map_grid(path, {.title = "both", .maps = maps, .curve_label = "limit"});
}

bool is_png(const std::string& file) { return contents(file).starts_with("\x89PNG\r\n"); }

const bool drawn = !find_gnuplot().empty();

// Where gnuplot is not installed: true, and the drawing says what to do.
template <class F>
bool cannot(F&& act) {
  if (drawn) return false;
  check_words(message_of<FileError>(act), {"apt-get install gnuplot-nox"});
  WARN("skipped: gnuplot is not installed (tests/run installs it)");
  return true;
}

}  // namespace

TEST_CASE("a chart is written as SVG and PNG with its words in it", "[unit][record]") {
  const Folder folder;
  if (cannot([&] { write_chart(folder.file("a.svg"), two_curves()); })) return;
  write_chart(folder.file("a.svg"), two_curves());
  const std::string svg = contents(folder.file("a.svg"));
  check_words(svg,
              {"<svg", "</svg>", "Sine &amp; its tangent", "B.force_on_p_world_x [N]", "force [N]", "t [s]", "theory"});
  CHECK(is_png(folder.file("a.png")));
  write_chart(folder.file("b"), two_curves());
  write_chart(folder.file("c.png"), two_curves());
  for (const char* name : {"b.svg", "c.svg"}) CHECK(contents(folder.file(name)) == svg);
}

TEST_CASE("panels, logarithms, gaps and long series are drawn", "[unit][record]") {
  const Folder folder;
  ChartSpec spec = two_curves();
  if (cannot([&] { write_chart(folder.file("a"), spec); })) return;
  Series late{"late", {}, {}, SeriesStyle::linespoints};
  for (int i = 0; i < 20000; ++i)
    late.x.push_back(1e-4 * i), late.y.push_back(i == 7777 ? std::nan("") : std::exp(-1e-3 * i));
  late.style = SeriesStyle::lines;
  spec.panels.push_back({"decay [m]", {late}, true, {{1, 1e-3, "here"}}});
  write_chart(folder.file("a"), spec);
  const std::string svg = contents(folder.file("a.svg"));
  check_words(svg, {"decay [m]", "here", "force [N]"});
  CHECK(svg.size() < 200000);  // 20000 points would be 300 kB
}

TEST_CASE("a long title is drawn completely, in two lines if one is too short", "[unit][record]") {
  const Folder folder;
  ChartSpec spec = two_curves();
  if (cannot([&] { write_chart(folder.file("a"), spec); })) return;
  const std::string first = "first line of the title " + std::string(60, 'a'),
                    second = std::string(70, 'b') + " its end";
  spec.title = first + " " + second;
  write_chart(folder.file("a"), spec);
  const std::string svg = contents(folder.file("a.svg"));
  check_words(svg, {first, second});
  CHECK(svg.find(spec.title) == std::string::npos);
  spec.title = first;
  write_chart(folder.file("b"), spec);
  check_words(contents(folder.file("b.svg")), {first});
}

TEST_CASE("an axis ends close to what is drawn", "[unit][record]") {
  const Folder folder;
  ChartSpec spec = two_curves();
  if (cannot([&] { write_chart(folder.file("a"), spec); })) return;
  spec.panels = {{"force [N]", {{"push", {0, 1, 2}, {-73, 110, 20}}}}};
  write_chart(folder.file("a"), spec);
  const std::string svg = contents(folder.file("a.svg"));
  const auto has = [&](const std::string& tic) {
    return svg.find(">" + tic + "<") != std::string::npos || svg.find("> " + tic + "<") != std::string::npos;
  };
  CHECK(has("100"));  // a tic inside the data's range
  for (const char* outside : {"-100", "150", "200"}) CHECK_FALSE(has(outside));
}

TEST_CASE("maps are drawn with their words in them", "[unit][record]") {
  const Folder folder;
  if (cannot([&] { write_map(folder.file("map"), {small_map()}); })) return;
  write_map(folder.file("map"), {small_map()});
  check_words(contents(folder.file("map.svg")), {"works", "inaccurate", "fails", "limit", "gain [1/s]"});
  MapSpec second = small_map();
  second.title = "second of two";
  write_map(folder.file("pair"), {small_map(), second});
  check_words(contents(folder.file("pair.svg")), {"both", "gain and step", "second of two", "works"});
  CHECK(is_png(folder.file("pair.png")));
}

TEST_CASE("no text of the user's becomes a command", "[unit][record]") {
  const Folder folder;
  const std::string trap = folder.file("trap");
  ChartSpec spec = two_curves();
  if (cannot([&] { write_chart(folder.file("a"), spec); })) return;
  spec.title = "`touch " + trap + "`";
  spec.x_label = "'; system('touch " + trap + "') #";
  spec.panels[0].y_label = "\nsystem 'touch " + trap + "'\n";
  spec.panels[0].series[0].label = "\\\" . system(\"touch " + trap + "\")";
  spec.panels[0].notes = {{0.5, 0.5, "@trap {/:Bold x_1^2} $(touch " + trap + ")"}};
  write_chart(folder.file("a"), spec);
  CHECK_FALSE(fs::exists(trap));
  check_words(contents(folder.file("a.svg")), {"`touch ", "x_1^2"});

  const fs::path before = fs::current_path();
  fs::current_path(folder.path);
  write_chart("| touch trap #'", two_curves());
  fs::current_path(before);
  CHECK_FALSE(fs::exists(trap));
  CHECK(fs::exists(folder.path / "| touch trap #'.svg"));
}

TEST_CASE("impossible charts are rejected in words", "[unit][record]") {
  const auto refusal = [](const auto& act) { return message_of<ModelError>(act); };
  ChartSpec spec = two_curves();
  spec.panels[0].series[1].y.pop_back();
  check_words(refusal([&] { write_chart("x", spec); }), {"Sine & its tangent", "theory", "101 x and 100 y"});
  spec = two_curves();
  spec.panels[0].series = {{"zeros", {0, 1}, {0, -1}}};
  spec.panels[0].log_y = true;
  check_words(refusal([&] { write_chart("x", spec); }), {"force [N]", "nothing to draw", "above zero"});
  spec.panels.clear();
  check_words(refusal([&] { write_chart("x", spec); }), {"no panels"});
  if (drawn) {
    const Folder folder;
    spec = two_curves();
    spec.panels[0].series[0].color = "red' ; system 'x";
    check_words(refusal([&] { write_chart(folder.file("a"), spec); }), {"#0072b2"});
    check_words(message_of<FileError>([&] { write_chart("no/such/folder/a.svg", two_curves()); }),
                {"no/such/folder/a.svg"});
  }
}

TEST_CASE("without gnuplot a chart reports the package to install", "[unit][record]") {
  const char* const path = std::getenv("PATH");
  const std::string before = path ? path : "";
  const Folder folder;
  setenv("PATH", folder.path.c_str(), 1);
  const std::string message = message_of<FileError>([&] { write_chart(folder.file("a.svg"), two_curves()); });
  setenv("PATH", before.c_str(), 1);
  check_words(message, {"a.svg", "gnuplot", "apt-get install gnuplot-nox"});
  CHECK_FALSE(fs::exists(folder.file("a.svg")));
}

TEST_CASE("a gnuplot that cannot be started, fails or draws nothing is reported with its message", "[unit][record]") {
  const char* const path = std::getenv("PATH");
  const std::string before = path ? path : "";
  const auto said_by = [&](const std::string& script) {
    const Folder folder;
    std::ofstream(folder.file("gnuplot")) << script;
    fs::permissions(folder.file("gnuplot"), fs::perms::owner_all);
    setenv("PATH", folder.path.c_str(), 1);
    const std::string message = message_of<FileError>([&] { write_chart(folder.file("a.svg"), two_curves()); });
    setenv("PATH", before.c_str(), 1);
    CHECK_FALSE(fs::exists(folder.file("a.svg")));
    return message;
  };
  check_words(said_by("no program"), {"cannot start", "gnuplot", "check that it can be executed"});
  check_words(said_by("#!/bin/sh\necho no fonts\nexit 3\n"),
              {"gnuplot could not draw", "a.svg", "its message: no fonts"});
  check_words(said_by("#!/bin/sh\necho nothing to do\n"),
              {"gnuplot drew nothing for", "a.svg", "its message: nothing to do"});
}

}  // namespace chart_test
