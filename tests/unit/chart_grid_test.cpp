#include "framework/tools/charts/chart_grid.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "framework/tools/charts/gnuplot.h"
#include <lockstep/error.h>
#include "tests/support/catch.h"

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
  if (find_gnuplot().empty()) return;
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

TEST_CASE("a grid without numbers is refused", "[unit][chart]") {
  CHECK_THROWS_AS(write_grid("nothing", GridSpec{"empty"}), ModelError);
  GridSpec grid = two_panels();
  grid.panels[1].series = {{"zero", {1, 2}, {0, 0}}};
  CHECK_THROWS_AS(write_grid("nothing", grid), ModelError);
  grid.panels[1].series = {{"uneven", {1, 2}, {1}}};
  CHECK_THROWS_AS(write_grid("nothing", grid), ModelError);
}

}  // namespace chart_grid_test
