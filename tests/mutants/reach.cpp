// SPDX-License-Identifier: BSD-3-Clause
// reach.cpp: the hook of -finstrument-functions. Loaded before a program (LD_PRELOAD), it writes each function that runs into
// the file that LOCKSTEP_REACH names, once: "MODULE ADDRESS", the address in hexadecimal from where the module is loaded. Each
// line is written at once, so that nothing is lost where a process is killed; children append to the same file.
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace {
constexpr std::size_t kPlaces = std::size_t{1} << 18;  // of functions: many more than the library has
std::atomic<std::uintptr_t> seen[kPlaces];

bool is_new(std::uintptr_t address) {
  for (std::size_t k = (address >> 4) * 0x9e3779b97f4a7c15u >> 40 & (kPlaces - 1);; k = (k + 1) & (kPlaces - 1)) {
    std::uintptr_t there = seen[k].load(std::memory_order_relaxed);
    if (there == 0 && seen[k].compare_exchange_strong(there, address)) return true;
    if (there == address) return false;
  }
}

void write_down(void* function) {
  const char* path = std::getenv("LOCKSTEP_REACH");
  Dl_info module;
  if (path == nullptr || dladdr(function, &module) == 0) return;
  char name[4096], line[4200];
  if (realpath(module.dli_fname, name) == nullptr) return;
  const int length =
      std::snprintf(line, sizeof line, "%s %zx\n", name,
                    reinterpret_cast<std::uintptr_t>(function) - reinterpret_cast<std::uintptr_t>(module.dli_fbase));
  const int file = open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (file < 0 || write(file, line, static_cast<std::size_t>(length)) != length) std::abort();
  close(file);
}
}  // namespace

extern "C" void __cyg_profile_func_enter(void* function, void*) {
  if (is_new(reinterpret_cast<std::uintptr_t>(function))) write_down(function);
}
extern "C" void __cyg_profile_func_exit(void*, void*) {}
