// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/charts/chart_grid.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include <lockstep/error.h>
#include <lockstep/math.h>
#include "framework/tools/charts/chart_path.h"
#include "framework/tools/charts/gnuplot.h"
#include "tests/support/catch.h"
#include "tests/support/gnuplot_here.h"
#include "tests/support/messages.h"

namespace chart_grid_test {

using namespace lockstep;
namespace fs = std::filesystem;

namespace {

GridSpec two_panels() {
  GridSpec grid{"Error & cost of 'two' methods"};
  grid.strip_label = "grey: failed";
  const Series front{"front of all runs", {1e-3, 1e-3, 1e-1}, {1e-1, 1e-4, 1e-4}, SeriesStyle::band, "#ddd6c0"};
  const Series one{"one", {1e-3, 1e-2, 1e-1}, {1e-1, 1e-2, 1e-3}, SeriesStyle::linespoints};
  const Series failed{"two", {2e-3}, {5}, SeriesStyle::crosses};
  grid.panels.push_back({"position error [m]", "CPU time [s]", {front, one, failed}, 1.0, {1e-5, 10}});
  grid.panels.push_back({"energy error [J]", "CPU time [s]", {one}});
  grid.remarks = {"two failed at step 0.1: it fell apart"};
  return grid;
}

}  // namespace

TEST_CASE("a grid is drawn with its legend, strip and remarks", "[unit][chart]") {
  testing::require_gnuplot();
  const fs::path folder = fs::temp_directory_path() / ("lockstep_grid_test_" + std::to_string(getpid()));
  fs::create_directory(folder);
  write_grid((folder / "grid").string(), two_panels());
  CHECK(fs::file_size(folder / "grid.png") > 10000);
  std::ifstream in(folder / "grid.svg");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  for (const char* word :
       {"front of all runs", "position error [m]", "energy error [J]", "grey: failed", "it fell apart"})
    CHECK(text.find(word) != std::string::npos);
  // One entry in the legend for each label, and a label that has only crosses is there too.
  const auto count = [&](const std::string& word) {
    int n = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
    return n;
  };
  CHECK(count("<title>one</title>") == 1);
  CHECK(count("<title>two</title>") == 1);
  fs::remove_all(folder);
}

TEST_CASE("curves with more data beyond the picture end in rings, which the legend names", "[unit][chart]") {
  testing::require_gnuplot();
  const fs::path folder = fs::temp_directory_path() / ("lockstep_rings_test_" + std::to_string(getpid()));
  fs::create_directory(folder);
  const auto drawn = [&](const GridSpec& grid) {
    write_grid((folder / "grid").string(), grid);
    std::ifstream in(folder / "grid.svg");
    return std::string{std::istreambuf_iterator<char>(in), {}};
  };
  GridSpec grid = two_panels();
  grid.open_label = "finer was not tried";
  CHECK(drawn(grid).find("finer was not tried") == std::string::npos);  // no entry without rings
  grid.panels[0].open_ends.x = {1e-1}, grid.panels[0].open_ends.y = {1e-3};
  CHECK(drawn(grid).find("finer was not tried") != std::string::npos);
  grid.panels[0].open_ends.y.clear();
  testing::check_words(testing::message_of<ModelError>([&] { write_grid((folder / "grid").string(), grid); }),
                       {"has 1 x and 0 y"});
  fs::remove_all(folder);
}

// A circle is one where both scales are equal: its curve is as wide as it is high, in pixels. A straight line along an axis
// takes most of the width.
TEST_CASE("a path is drawn with equal scales on request", "[unit][chart]") {
  testing::require_gnuplot();
  const fs::path folder = fs::temp_directory_path() / ("lockstep_path_test_" + std::to_string(getpid()));
  fs::create_directory(folder);
  PathSpec spec{"a circle", "x [m]", "y [m]"}, line{"a line", "x [m]", "y [m]"};
  for (int i = 0; i <= 360; ++i) {
    spec.x.push_back(2 + 0.3 * std::cos(kTwoPi * i / 360)), spec.y.push_back(-1 + 0.3 * std::sin(kTwoPi * i / 360));
    line.x.push_back(1e-3 * i / 360);
  }
  const auto drawn_size = [&](const PathSpec& path) {
    write_path((folder / "path").string(), path);
    std::ifstream in(folder / "path.svg");
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    for (const std::string& word : {std::string("x [m]"), std::string("y [m]"), std::string("start"), path.title})
      CHECK(text.find(word) != std::string::npos);
    const std::size_t plot = text.find("gnuplot_plot_1"), begin = text.find(" d='M", plot);
    REQUIRE(begin != std::string::npos);
    std::istringstream points(text.substr(begin + 5, text.find('\'', begin + 5) - begin - 5));
    double left = 1e9, right = -1e9, low = 1e9, high = -1e9, x = 0, y = 0;
    char mark = 0;
    for (int n = 0; points >> x >> mark >> y; ++n) {
      left = std::min(left, x), right = std::max(right, x), low = std::min(low, y), high = std::max(high, y);
      while (std::isspace(points.peek()) != 0 || points.peek() == 'L') points.get();
    }
    return std::array{right - left, high - low};
  };
  for (const bool equal : {true, false}) {
    spec.equal_scales = line.equal_scales = equal;
    const auto [width, height] = drawn_size(spec);
    INFO(width << " x " << height);
    CHECK(height > 100);
    CHECK((std::abs(width - height) < 1.5) == equal);
    for (const double y : {0.0, 5.0}) {
      line.y.assign(line.x.size(), y);
      const auto [length, rise] = drawn_size(line);
      CHECK(length > width - 1);
      CHECK(rise < 1);
    }
  }
  testing::check_words(testing::message_of<ModelError>([&] {
                         write_path("nothing", PathSpec{"empty", "x", "y"});
                       }),
                       {"\"empty\"", "nothing to draw"});
  testing::check_words(testing::message_of<ModelError>([&] {
                         write_path("nothing", PathSpec{"uneven", "x", "y", {1, 2}, {1}});
                       }),
                       {"has 2 x and 1 y"});
  fs::remove_all(folder);
}

TEST_CASE("a grid without numbers is rejected", "[unit][chart]") {
  testing::check_words(testing::message_of<ModelError>([&] { write_grid("nothing", GridSpec{"empty"}); }),
                       {"\"empty\" has no panels"});
  GridSpec grid = two_panels();
  grid.panels[1].series = {{"zero", {1, 2}, {0, 0}}};
  const auto refusal = [&] { return testing::message_of<ModelError>([&] { write_grid("nothing", grid); }); };
  testing::check_words(refusal(), {"has nothing to draw", "numbers above zero"});
  grid.panels[1].series = {{"uneven", {1, 2}, {1}}};
  testing::check_words(refusal(), {"series \"uneven\" has 2 x and 1 y", "the same number"});
}

}  // namespace chart_grid_test
