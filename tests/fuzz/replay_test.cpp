// The fuzz targets without a fuzzer: over their corpus, and over changes to it that are the same every time. So none of
// them rots, and what was found stays mended. LOCKSTEP_FUZZ_INPUTS="N" takes N changed inputs a target, "SEED:N" others.
#include <chrono>
#include <cstdio>
#include <cstdlib>
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

// What a broken promise was broken by is kept, so that it can be run alone; after a crash it is the last input.
void try_one(const Target& target, const std::string& input, long n) {
  const std::string kept = kFolder + "/" + target.name + ".last";
  std::ofstream(kept, std::ios::binary | std::ios::trunc) << input;
  const auto begin = std::chrono::steady_clock::now();
  try {
    target.run({reinterpret_cast<const std::uint8_t*>(input.data()), input.size()});
  } catch (const Broken& broken) {
    const std::string found = kFolder + "/" + target.name + "." + std::to_string(n) + ".broken";
    fs::copy_file(kept, found, fs::copy_options::overwrite_existing);
    FAIL_CHECK(broken.words << "\nby the input in " << found);
  }
  const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
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
    std::string input = inputs[static_cast<std::size_t>(bits() % inputs.size())];
    if (!is_scene && bits() % 4 == 0) input += inputs[static_cast<std::size_t>(bits() % inputs.size())];
    try_one(target, is_scene ? mutated_scene(input, bits) : mutated(input, bits), n++);
  }
  fs::current_path(before);
}

}  // namespace

TEST_CASE("fuzzed formulas are read or refused", "[fuzz]") { replay("formula", 4000); }
TEST_CASE("fuzzed tables are read or refused", "[fuzz]") { replay("table", 2000); }
TEST_CASE("fuzzed meshes are read or refused", "[fuzz]") { replay("mesh", 4000); }
TEST_CASE("fuzzed plugin files are refused before they are opened", "[fuzz]") { replay("plugin", 2000); }
TEST_CASE("fuzzed names of channels, methods and variables are found or refused", "[fuzz]") { replay("channel", 500); }
TEST_CASE("fuzzed scenes are built or refused", "[fuzz]") { replay("scene", 2000); }
TEST_CASE("fuzzed scenes run to finite numbers or end by an error", "[fuzz]") { replay("run", 150); }
TEST_CASE("calls of the API in any order end by finite numbers or an error", "[fuzz]") { replay("api", 2000); }

}  // namespace replay_test
