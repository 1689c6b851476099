// SPDX-License-Identifier: BSD-3-Clause
// Defects that are known and not mended yet, by what the program says: see tests/support/open_defect.h.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include <lockstep/recorder.h>
#include "framework/tools/program/progress.h"
#include "tests/support/catch.h"
#include "tests/support/defect_runs.h"
#include "tests/support/open_defect.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace open_defects_program_test {

using namespace lockstep;
using namespace lockstep::testing;
using Json = nlohmann::ordered_json;

namespace {

constexpr double kG = 9.81;
const std::string kSmallProgram = "A small program", kAnswers = "Answers";

}  // namespace

TEST_CASE("a line of progress fits a terminal of 40 columns", "[defect][a small program]") {
  std::size_t longest = 0;
  for (const double t : {0.5, 12.34, 99.0}) longest = std::max(longest, progress_line(t, 100, 30, 39).size());
  CHECK(progress_line(12.34, 100, 30, 79).size() <= 79);
  CHECK(contains(progress_line(12.34, 100, 30, 79), "to go"));
  CAPTURE(longest);
  expect_defect("a progress bar in 40 columns", kSmallProgram, longest > 39,
                longest <= 39 && contains(progress_line(12.34, 100, 30, 39), "to go"));
}

TEST_CASE("a run that fails with --json gives its error once", "[defect][a small program]") {
  const Called ran = run_named(defect("locks_jansen"), "failed_once", "--json");
  INFO(ran.text);
  CHECK(ran.exit == 6);
  const std::size_t json = ran.text.find("{\n");
  REQUIRE(json != std::string::npos);
  const Json result = Json::parse(ran.text.substr(json));
  CHECK(result["status"] == "failed");
  const std::string error = result["error"];
  REQUIRE(error.size() > 20);
  const bool twice = contains(ran.text.substr(0, json), error.substr(0, 40));
  expect_defect("the doubled error of --json", kSmallProgram, twice, !twice);
}

// Twenty rows fall on the zeros of 0.3 sin(20 pi t). The motor's peak, over all the motion, is at the swing's ends:
// J (20 pi)^2 0.3 + m g l / 2 cos 0.3, J about the end of a rod whose radius is a fiftieth of its length.
TEST_CASE("extremes are those of the motion, not only of the recorded times", "[defect][answers]") {
  const double rate = 20 * kPi, peak = (1.0 / 3 + 1e-4) * rate * rate * 0.3 + 0.5 * kG * std::cos(0.3);
  const std::string scene = defect("peak_between_rows");
  const Called swept = call("sweep " + scene + " --vary bodies.arm.rod.mass=1 --record peak.csv");
  INFO(swept.text);
  REQUIRE(swept.exit == 0);
  std::ifstream file(kRunnerFolder + "/peak.csv");
  std::string header, row;
  REQUIRE((std::getline(file, header) && std::getline(file, row)));
  const auto cell = [&](const std::string& name) {
    const auto n = std::count(header.begin(), header.begin() + static_cast<long>(header.find(name)), ',');
    std::size_t at = 0;
    for (long k = 0; k < n; ++k) at = row.find(',', at) + 1;
    return std::stod(row.substr(at));
  };
  const double most = std::max(std::abs(cell("M min")), std::abs(cell("M max")));
  const Called inverse = call("inverse " + scene + " --record inverse_peak.csv --json");
  REQUIRE(inverse.exit == 0);
  const Json driven = Json::parse(inverse.text);
  double by_laws = 0;
  for (const Json& column : driven["columns"])
    if (column["name"] == "A.drive_rz.torque_on_p_link_z") by_laws = std::abs(column["peak"].get<double>());
  CAPTURE(peak, most, by_laws, inverse.text);
  expect_defect("peak_between_rows", kAnswers, std::abs(most - 4.905) < 1e-3 && std::abs(by_laws - 4.905) < 1e-3,
                std::abs(most / peak - 1) < 1e-2 && std::abs(by_laws / peak - 1) < 1e-2);
}

}  // namespace open_defects_program_test
