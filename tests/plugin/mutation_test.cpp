// Real plugins, changed at random: the host reads each without harm. One whose loaded part is whole loads and is the same
// plugin; one that was cut there is refused. Changed code in a file of sound structure is found by nobody, so it is not run.
#include <elf.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <random>

#include <lockstep/loader.h>
#include <lockstep/error.h>
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/plugin_files.h"
#include "tests/support/program.h"

namespace mutation_test {

using namespace lockstep;
using namespace lockstep::testing;
namespace fs = std::filesystem;

namespace {

class Mutator {
 public:
  explicit Mutator(unsigned seed) : bits_(seed) {}

  std::string changed(std::string bytes, std::size_t end = 0) {
    if (end == 0 || end > bytes.size()) end = bytes.size();
    switch (below(6)) {
      case 0:  // some bits
        for (std::size_t n = 1 + below(8); n > 0; --n) bytes[below(end)] ^= static_cast<char>(1u << below(8));
        break;
      case 1: {  // a run of one byte
        const std::size_t at = below(end), n = std::min(end - at, 1 + below(512));
        bytes.replace(at, n, n, "\0\xff\x90"[below(3)]);
        break;
      }
      case 2: {  // a run of noise
        const std::size_t at = below(end), n = std::min(end - at, 1 + below(512));
        for (std::size_t k = 0; k < n; ++k) bytes[at + k] = static_cast<char>(below(256));
        break;
      }
      case 3:  // an end
        bytes.resize(below(end));
        break;
      case 4: {  // two blocks in each other's place
        const std::size_t n = std::size_t{1} << below(10), a = below(end - n), b = below(end - n);
        const std::string first = bytes.substr(a, n);
        bytes.replace(a, n, bytes.substr(b, n)).replace(b, n, first);
        break;
      }
      default:  // numbers of the header and of the segments
        for (std::size_t n = 1 + below(4); n > 0; --n) {
          const std::uint64_t value = below(2) == 0 ? below(1u << 20) : bits_();
          bytes.replace(8 * below(64), 8, std::string(reinterpret_cast<const char*>(&value), 8));
        }
    }
    return bytes;
  }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(bits_() % n); }

 private:
  std::mt19937_64 bits_;
};

// 0: loaded and brings what the original brings; 1: refused; above: crashed.
int fate_in_a_child(const std::string& file, const Registry& original) {
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    alarm(20);
    int fate = 2;
    try {
      Registry registry;
      load_plugin(registry, file);
      const bool same = registry.laws.names() == original.laws.names() &&
                        registry.links.names() == original.links.names() &&
                        registry.forces.names() == original.forces.names() &&
                        registry.integrators.names() == original.integrators.names();
      fate = same ? 0 : 3;
    } catch (const PluginError&) {
      fate = 1;
    } catch (...) {
    }
    _exit(fate);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

bool is_taken(const std::string& file) {
  try {
    check_plugin_file(file);
    return true;
  } catch (const PluginError&) {
    return false;
  }
}

// The header, but for what it says of sections, and the segments that a loader takes into memory, each as far as the
// file has it.
std::string loaded_part(const std::string& sound, const std::string& bytes) {
  Elf64_Ehdr header;
  std::memcpy(&header, sound.data(), sizeof header);
  std::string part = bytes.substr(0, sizeof header);
  for (const auto& [at, n] : {std::pair<std::size_t, std::size_t>{offsetof(Elf64_Ehdr, e_shoff), 8},
                              {offsetof(Elf64_Ehdr, e_shentsize), 6}})  // of the sections, which debuggers read
    if (at + n <= part.size()) part.replace(at, n, n, '\0');
  for (unsigned k = 0; k < header.e_phnum; ++k) {
    Elf64_Phdr s;
    std::memcpy(&s, sound.data() + header.e_phoff + k * sizeof s, sizeof s);
    if (s.p_type == PT_LOAD && s.p_offset < bytes.size())
      part += bytes.substr(std::max<std::size_t>(s.p_offset, sizeof header),
                           s.p_offset + s.p_filesz - std::max<std::size_t>(s.p_offset, sizeof header));
  }
  return part;
}

}  // namespace

TEST_CASE("thousands of changed plugins are refused, or are the same plugin still", "[plugin][mutation]") {
  const std::string plugin = GENERATE(std::string(paths::kPlugins) + "/bump.so",
                                      std::string(paths::kPlugins) + "/cam_follower.so", kModules + "/probe.so");
  const std::string sound = bytes_of(plugin), sound_part = loaded_part(sound, sound);
  Registry original;
  load_plugin(original, plugin);
  Mutator mutator(20260);
  int n_refused = 0, n_same = 0;
  for (int k = 0; k < 1000; ++k) {
    const std::string bytes = mutator.changed(sound);
    if (bytes == sound) continue;
    const std::string file = plugin_file("mutants", "mutant.so", bytes), part = loaded_part(sound, bytes);
    const bool taken = is_taken(file);
    INFO(plugin << ", mutant " << k);
    if (part.size() < sound_part.size()) CHECK_FALSE(taken);
    n_refused += taken ? 0 : 1;
    if (!taken || part != sound_part) continue;
    CHECK(fate_in_a_child(file, original) == 0);
    ++n_same;
  }
  CAPTURE(plugin, n_refused, n_same);
  CHECK(n_refused > 250);
  CHECK(n_same > 0);  // tables that only debuggers read
  CHECK(fate_in_a_child(plugin, original) == 0);
  fs::remove_all(kModules + "/mutants");
}

TEST_CASE("the tables of a plugin are read without trust", "[plugin][mutation]") {
  const std::string sound = bytes_of(std::string(paths::kPlugins) + "/cam_follower.so");
  Mutator mutator(4);
  int n_refused = 0;
  for (int k = 0; k < 1000; ++k)
    n_refused += is_taken(plugin_file("loose", "loose.so", mutator.changed(sound, 0x1800))) ? 0 : 1;
  CHECK(n_refused > 300);
  fs::remove_all(kModules + "/loose");
}

}  // namespace mutation_test
