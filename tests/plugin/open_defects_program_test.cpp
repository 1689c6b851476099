// SPDX-License-Identifier: BSD-3-Clause
// Defects that are known and not mended yet, by what the program says: see tests/support/open_defect.h.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

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

const std::string kSmallProgram = "A small program";

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

}  // namespace open_defects_program_test
