// SPDX-License-Identifier: BSD-3-Clause
// Memory runs out under the program, at one request or from one on: it ends by one sentence and exit code 10, and old
// results stay. LOCKSTEP_FAULTS=N takes N requests of each verb in place of 40, and all takes every
// one: 600 000 runs of the program, some four hours.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/faults/failing.h"

namespace memory_faults_test {

using namespace failing;

namespace {

// What a verb is asked, and the results that it replaces. `same`: it writes the same bytes each time.
struct Asked {
  std::string words;
  std::vector<std::string> results{};
  bool same = true;
};

// Seconds of computing stand in rows of sweeps and in reports.
bool is_whole(const std::string& text, const std::string& whole, bool same) {
  const auto lines = [](const std::string& t) { return std::count(t.begin(), t.end(), '\n'); };
  return same ? text == whole
              : lines(text) == lines(whole) && text.substr(0, text.find('\n')) == whole.substr(0, whole.find('\n'));
}

// Whether it ended by exit code 10.
bool check_request(const Asked& asked, const std::vector<std::string>& whole, const std::string& call_of) {
  for (const std::string& result : asked.results) std::ofstream(result) << kOld;
  const Called r = with_failing(call_of, asked.words);
  INFO(asked.words << ", " << call_of << ", exit code " << r.exit << ":\n" << r.text.substr(0, 2000));
  CHECK(kDocumented.contains(r.exit));
  // In a sweep a run that needs the memory is a failed row of a table that is whole.
  const bool failed_row = r.exit == 1 && asked.words.starts_with("sweep") &&
                          contains(bytes_of(asked.results.front()), "failed: std::bad_alloc");
  CHECK((r.exit == 10 || r.exit == 0 || failed_row));
  if (r.exit == 10) CHECK(contains(r.text, "out of memory"));
  // Once the new table is whole and in its place, only words, pictures and reports are left to fail.
  for (std::size_t k = 0; k < asked.results.size(); ++k) {
    const std::string text = bytes_of(asked.results[k]);
    CHECK(((text == kOld && r.exit != 0) || is_whole(text, whole[k], asked.same)));
  }
  return r.exit == 10;
}

// Some requests spread over all that the verb makes, one alone and one with all later ones.
void check_requests(const Asked& asked, long n_points = 40) {
  const long n = counts_of(asked.words)[0];
  INFO(asked.words);
  CHECK(n > 100);
  std::vector<std::string> whole;
  for (const std::string& result : asked.results) whole.push_back(bytes_of(result));
  if (const char* wish = std::getenv("LOCKSTEP_FAULTS")) n_points = std::string(wish) == "all" ? n : std::stol(wish);
  REQUIRE(n_points > 0);
  const long step = std::max(1L, n / n_points);
  long ended = 0;
  for (const std::string on : {"", "+"})
    for (long k = 1; k <= n; k += step)
      ended += check_request(asked, whole, "malloc:" + std::to_string(k) + on) ? 1 : 0;
  CHECK(ended > 0);
  for (const std::string& result : asked.results) fs::remove(result + ".partial");
}

}  // namespace

TEST_CASE("a request for memory that fails ends by one sentence and exit code 10", "[faults]") {
  const std::string scene = arm_scene("memory", kShort), old = kFolder + "/memory.csv";
  check_requests({"run '" + scene + "' --record '" + old + "'", {old}});
  check_requests({"check '" + scene + "'"});
  check_requests({"check '" + scene + "' --plugin bump"});
  check_requests({"sweep '" + scene + "' --jobs 1 --vary gravity.2=-9.81,-1.62 --record '" + old + "'", {old}, false});
}

TEST_CASE("a command that only prints ends by exit code 10 when memory is exhausted", "[faults]") {
  for (const char* words : {"list", "list --json", "schema"}) check_requests({words});
}

TEST_CASE("a report ends by exit code 10 where memory runs out", "[faults]") {
  const std::string scene = arm_scene("memory_page", kShort), old = kFolder + "/memory_page.csv";
  const std::string page = kFolder + "/memory_page.html";
  check_requests({"report '" + scene + "' --record '" + old + "' --out '" + page + "'", {old, page}, false});
  check_requests({"run '" + scene + "' --record '" + old + "' --report '" + page + "'", {old, page}, false});
}

}  // namespace memory_faults_test
