// SPDX-License-Identifier: BSD-3-Clause
// The fuzz targets without a fuzzer: over their corpus, and over changes to it that are the same every time. So none of
// them rots, and what was found stays mended. LOCKSTEP_FUZZ_INPUTS="N" takes N changed inputs a target, "SEED:N" others.
#include <poll.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/mutate.h"
#include "tests/fuzz/targets.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"

namespace replay_test {

using namespace lockstep;
using namespace lockstep::fuzz;
namespace fs = std::filesystem;

namespace {

const std::string kCorpus = std::string(paths::kSource) + "/tests/fuzz/corpus/";
const std::string kFolder = std::string(paths::kBuild) + "/output/fuzz";

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// The files of a target in the order of their names.
std::vector<std::string> corpus(const std::string& target) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(kCorpus + (target == "run" ? "scene" : target)))
    files.push_back(entry.path());
  if (target == "plugin") files.push_back(std::string(paths::kBuild) + "/test_plugins/small_plugin.so");
  std::sort(files.begin(), files.end());
  std::vector<std::string> inputs;
  for (const fs::path& file : files) inputs.push_back(bytes_of(file));
  return inputs;
}

// The time that this process has had of its processors; waiting, and what other processes take, are none of it.
double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// While it lives, an input may take so many seconds of CPU time. One that takes more hangs: the process ends by SIGABRT,
// which Catch reports as a failure of the case, and tells in which file the input is.
constexpr double kHang = 10;
class TimeLimit {
 public:
  TimeLimit(double seconds, const std::string& file) {
    std::snprintf(words_, sizeof words_, "\nhang: an input took more than %g s of CPU time: %s\n", seconds,
                  file.c_str());
    previous_ = std::signal(SIGPROF, [](int) {
      const ssize_t written = write(STDERR_FILENO, words_, std::strlen(words_));
      static_cast<void>(written);
      std::abort();
    });
    set(seconds);
  }
  ~TimeLimit() {
    set(0);
    std::signal(SIGPROF, previous_);
  }
  TimeLimit(const TimeLimit&) = delete;
  TimeLimit& operator=(const TimeLimit&) = delete;

 private:
  static void set(double seconds) {
    const auto whole = static_cast<time_t>(seconds);
    const itimerval t{{0, 0}, {whole, static_cast<suseconds_t>(1e6 * (seconds - static_cast<double>(whole)))}};
    setitimer(ITIMER_PROF, &t, nullptr);
  }
  static char words_[4096];
  void (*previous_)(int);
};
char TimeLimit::words_[4096];

// What a broken promise was broken by is kept, so that it can be run alone; after a crash it is the last input.
void try_one(const Target& target, const std::string& input, long n) {
  const std::string kept = kFolder + "/" + target.name + ".last";
  std::ofstream(kept, std::ios::binary | std::ios::trunc) << input;
  const double begin = cpu_seconds();
  try {
    const TimeLimit limit(kHang, kept);
    target.run({reinterpret_cast<const std::uint8_t*>(input.data()), input.size()});
  } catch (const Broken& broken) {
    const std::string found = kFolder + "/" + target.name + "." + std::to_string(n) + ".broken";
    fs::copy_file(kept, found, fs::copy_options::overwrite_existing);
    FAIL_CHECK(broken.words << "\nby the input in " << found);
  }
  const double took = cpu_seconds() - begin;
  if (took > 2) {
    const std::string slow = kFolder + "/" + target.name + "." + std::to_string(n) + ".slow";
    fs::copy_file(kept, slow, fs::copy_options::overwrite_existing);
    std::printf("%.1f s: %s\n", took, slow.c_str());
  }
}

struct Range {
  unsigned long seed = 1;
  long n = 0;
};
Range range(long usual) {
  Range r{1, usual};
  if (const char* given = std::getenv("LOCKSTEP_FUZZ_INPUTS"))
    if (std::sscanf(given, "%lu:%ld", &r.seed, &r.n) != 2) r = {1, std::atol(given)};
  return r;
}

void replay(const std::string& name, long usual) {
  fs::create_directories(kFolder);
  const fs::path before = fs::current_path();
  fs::current_path(kFolder);  // scenes may name files; here are none
  const Target& target =
      *std::find_if(std::begin(kTargets), std::end(kTargets), [&](const Target& t) { return t.name == name; });
  const std::vector<std::string> inputs = corpus(name);
  REQUIRE(!inputs.empty());
  long n = 0;
  for (const std::string& input : inputs) try_one(target, input, n++);
  const Range r = range(usual);
  const bool is_scene = name == "scene" || name == "run";
  std::mt19937_64 bits(r.seed);
  for (long k = 0; k < r.n; ++k) {
    std::string input = inputs[bits() % inputs.size()];
    if (!is_scene && bits() % 4 == 0) input += inputs[bits() % inputs.size()];
    try_one(target, is_scene ? mutated_scene(input, bits) : mutated(input, bits), n++);
  }
  fs::current_path(before);
}

}  // namespace

// A process that only waits takes no time; one that goes round without end is ended, and says by which input.
TEST_CASE("an input that takes more CPU time than it may fails by name", "[fuzz]") {
  for (const bool busy : {false, true}) {
    int ends[2];
    REQUIRE(pipe(ends) == 0);
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      std::signal(SIGABRT, SIG_DFL);
      dup2(ends[1], STDERR_FILENO);
      alarm(20);
      const TimeLimit limit(0.2, "some.last");
      if (!busy) usleep(500'000);
      for (volatile bool goes_on = busy; goes_on;)
        poll(nullptr, 0, 0);  // waits for nothing; a thread sanitizer delivers signals at such calls alone
      _exit(0);
    }
    close(ends[1]);
    std::string said;
    char part[256];
    for (ssize_t n = 0; (n = read(ends[0], part, sizeof part)) > 0;) said.append(part, static_cast<std::size_t>(n));
    close(ends[0]);
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    INFO(busy << " " << said);
    CHECK((WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT) == busy);
    CHECK((WIFEXITED(status) && WEXITSTATUS(status) == 0) == !busy);
    CHECK(said == (busy ? "\nhang: an input took more than 0.2 s of CPU time: some.last\n" : ""));
  }
}

TEST_CASE("fuzzed formulas are read or rejected", "[fuzz]") { replay("formula", 4000); }
TEST_CASE("fuzzed tables are read or rejected", "[fuzz]") { replay("table", 2000); }
TEST_CASE("fuzzed robots in URDF are scenes or rejected", "[fuzz]") { replay("urdf", 2000); }
TEST_CASE("fuzzed meshes are read or rejected", "[fuzz]") { replay("mesh", 4000); }
TEST_CASE("fuzzed plugin files are rejected before they are opened", "[fuzz]") { replay("plugin", 2000); }
TEST_CASE("fuzzed names of channels, methods and variables are found or rejected", "[fuzz]") { replay("channel", 500); }
TEST_CASE("fuzzed scenes are built or rejected", "[fuzz]") { replay("scene", 2000); }
TEST_CASE("fuzzed scenes run to finite numbers or end by an error", "[fuzz]") { replay("run", 150); }
TEST_CASE("calls of the API in any order end by finite numbers or an error", "[fuzz]") { replay("api", 2000); }

}  // namespace replay_test
