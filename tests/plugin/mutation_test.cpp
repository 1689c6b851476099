// SPDX-License-Identifier: BSD-3-Clause
// Real plugins, changed at random: the host reads each without harm. One whose loaded part is whole loads and is the
// same plugin; one that was cut there is refused. Other damage to the loaded part is not looked for, so such a file is not run.
#include <elf.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <random>

#include <lockstep/author/loader.h>
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
  std::size_t below(std::size_t n) { return bits_() % n; }

 private:
  std::mt19937_64 bits_;
};

// What `act` returns in a child, or 128 and the number of the signal that ended it.
template <class Act>
int fate_in_a_child(Act&& act) {
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    for (const int crash : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL})
      std::signal(crash, SIG_DFL);  // Catch2 has its own
    alarm(20);
    _exit(act());
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// 0: loaded and brings what the original brings; 1: refused; above: neither.
int fate_when_loaded(const std::string& file, const Registry& original) {
  return fate_in_a_child([&] {
    try {
      Registry registry;
      load_plugin(registry, file);
      const bool same = registry.laws.names() == original.laws.names() &&
                        registry.links.names() == original.links.names() &&
                        registry.forces.names() == original.forces.names() &&
                        registry.integrators.names() == original.integrators.names();
      return same ? 0 : 3;
    } catch (const PluginError&) {
      return 1;
    } catch (...) {
      return 2;
    }
  });
}

bool is_taken(const std::string& file) {
  try {
    check_plugin_file(file);
    return true;
  } catch (const PluginError&) {
    return false;
  }
}

std::vector<Elf64_Phdr> loaded_segments(const std::string& sound) {
  Elf64_Ehdr header;
  std::memcpy(&header, sound.data(), sizeof header);
  std::vector<Elf64_Phdr> segments(header.e_phnum);
  std::memcpy(segments.data(), sound.data() + header.e_phoff, segments.size() * sizeof(Elf64_Phdr));
  std::erase_if(segments, [](const Elf64_Phdr& s) { return s.p_type != PT_LOAD; });
  return segments;
}

// The header, but for what it says of sections, and the segments that a loader takes into memory, each as far as the
// file has it.
std::string loaded_part(const std::string& sound, const std::string& bytes) {
  std::string part = bytes.substr(0, sizeof(Elf64_Ehdr));
  for (const auto& [at, n] : {std::pair<std::size_t, std::size_t>{offsetof(Elf64_Ehdr, e_shoff), 8},
                              {offsetof(Elf64_Ehdr, e_shentsize), 6}})  // of the sections, which debuggers read
    if (at + n <= part.size()) part.replace(at, n, n, '\0');
  for (const Elf64_Phdr& s : loaded_segments(sound)) {
    const std::size_t begin = std::max<std::size_t>(s.p_offset, sizeof(Elf64_Ehdr));
    if (begin < bytes.size()) part += bytes.substr(begin, s.p_offset + s.p_filesz - begin);
  }
  return part;
}

}  // namespace

TEST_CASE("thousands of changed plugins are rejected, or remain the same plugin", "[plugin][mutation]") {
  const std::string plugin = GENERATE(built_plugin("bump"), built_plugin("cam_follower"), test_plugin("probe"));
  const std::string sound = bytes_of(plugin), sound_part = loaded_part(sound, sound);
  const Elf64_Phdr last = loaded_segments(sound).back();
  // what debuggers read is changed up to half as many bytes as are loaded
  const std::size_t end = std::min(sound.size(), (last.p_offset + last.p_filesz) * 3 / 2);
  Registry original;
  load_plugin(original, plugin);
  Mutator mutator(20260);
  int n_refused = 0, n_same = 0;
  for (int k = 0; k < 1000; ++k) {
    const std::string bytes = mutator.changed(sound, end);
    if (bytes == sound) continue;
    const std::string file = plugin_file("mutants", "mutant.so", bytes), part = loaded_part(sound, bytes);
    const bool taken = is_taken(file);
    INFO(plugin << ", mutant " << k);
    if (part.size() < sound_part.size()) CHECK_FALSE(taken);
    n_refused += taken ? 0 : 1;
    if (!taken || part != sound_part) continue;
    CHECK(fate_when_loaded(file, original) == 0);
    ++n_same;
  }
  CAPTURE(plugin, n_refused, n_same);
  CHECK(n_refused > 150);  // a sixth is cut
  CHECK(n_same > 0);  // tables that only debuggers read
  CHECK(fate_when_loaded(plugin, original) == 0);
  fs::remove_all(kModules + "/mutants");
}

TEST_CASE("the tables of a plugin are read without trust", "[plugin][mutation]") {
  const std::string plugin = GENERATE(built_plugin("cam_follower"), test_plugin("tables"));
  const std::string sound = bytes_of(plugin);
  Mutator mutator(4);
  int n_refused = 0;
  for (int k = 0; k < 1000; ++k) {
    const std::string bytes = mutator.changed(sound, loaded_segments(sound).front().p_filesz);
    n_refused += is_taken(plugin_file("loose", "loose.so", bytes)) ? 0 : 1;
  }
  CHECK(n_refused > 150);
  fs::remove_all(kModules + "/loose");
}

}  // namespace mutation_test
