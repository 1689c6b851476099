// SPDX-License-Identifier: BSD-3-Clause
// Loaded before a program (LD_PRELOAD), makes one call of the system fail. LOCKSTEP_FAIL="malloc:17" is the 17th request
// for memory after main has begun, "malloc:17+" that and all later ones, "write:3" the third write (the disk is full),
// "fsync:1", "rename:1". "alarm:20" is a signal every 20 ms, whose handler lets calls of the system end early (EINTR).
// LOCKSTEP_FAIL_COUNT names a file for the number of calls that were made of each kind.
#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>

extern "C" {

void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);

}  // extern "C"

namespace {

enum Call { kMalloc, kWrite, kFsync, kRename, kCalls };
constexpr const char* kNames[kCalls] = {"malloc", "write", "fsync", "rename"};

std::atomic<bool> in_main{false};
std::atomic<long> counts[kCalls];
Call failing = kCalls;
long failing_at = 0;
bool failing_on = false;

// Whether this call is to fail.
bool fails(Call call) {
  if (!in_main.load(std::memory_order_relaxed)) return false;
  const long n = ++counts[call];
  return call == failing && (n == failing_at || (failing_on && n > failing_at));
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

// As a library does that handles signals without SA_RESTART.
void alarm_every(long ms) {
  struct sigaction action {};
  action.sa_handler = [](int) {};
  sigaction(SIGALRM, &action, nullptr);
  const timeval interval{ms / 1000, 1000 * (ms % 1000)};
  const itimerval timer{interval, interval};
  setitimer(ITIMER_REAL, &timer, nullptr);
}

void read_wish() {
  const char* wish = getenv("LOCKSTEP_FAIL");
  if (wish == nullptr) return;
  if (strncmp(wish, "alarm:", 6) == 0) alarm_every(atol(wish + 6));
  for (int k = 0; k < kCalls; ++k) {
    const size_t n = strlen(kNames[k]);
    if (strncmp(wish, kNames[k], n) != 0 || wish[n] != ':') continue;
    failing = static_cast<Call>(k), failing_at = atol(wish + n + 1), failing_on = strchr(wish, '+') != nullptr;
  }
}

void write_counts() {
  in_main = false;
  const char* file = getenv("LOCKSTEP_FAIL_COUNT");
  if (file == nullptr) return;
  FILE* out = fopen(file, "w");
  if (out == nullptr) return;
  for (int k = 0; k < kCalls; ++k) fprintf(out, "%ld\n", counts[k].load());
  fclose(out);
}

int (*real_main)(int, char**, char**) = nullptr;
int counted_main(int argc, char** argv, char** environment) {
  read_wish();
  in_main = true;
  const int code = real_main(argc, argv, environment);
  write_counts();
  return code;
}

}  // namespace

#define SHOWN extern "C" __attribute__((visibility("default")))

SHOWN int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(), void (*fini)(),
                            void (*rtld_fini)(), void* stack_end) {
  using Start = int (*)(int (*)(int, char**, char**), int, char**, void (*)(), void (*)(), void (*)(), void*);
  real_main = main;
  return next<Start>("__libc_start_main")(counted_main, argc, argv, init, fini, rtld_fini, stack_end);
}

SHOWN void* malloc(size_t n) {
  if (fails(kMalloc)) return errno = ENOMEM, nullptr;
  return __libc_malloc(n);
}
SHOWN void* calloc(size_t n, size_t size) {
  if (fails(kMalloc)) return errno = ENOMEM, nullptr;
  return __libc_calloc(n, size);
}
SHOWN void* realloc(void* at, size_t n) {
  if (fails(kMalloc)) return errno = ENOMEM, nullptr;
  return __libc_realloc(at, n);
}
SHOWN void* aligned_alloc(size_t alignment, size_t n) {
  if (fails(kMalloc)) return errno = ENOMEM, nullptr;
  return __libc_memalign(alignment, n);
}
SHOWN int posix_memalign(void** to, size_t alignment, size_t n) {
  if (fails(kMalloc)) return ENOMEM;
  *to = __libc_memalign(alignment, n);
  return *to == nullptr ? ENOMEM : 0;
}

// Of files only: what a person is told still comes through.
SHOWN ssize_t write(int file, const void* bytes, size_t n) {
  if (file > 2 && fails(kWrite)) return errno = ENOSPC, -1;
  return next<ssize_t (*)(int, const void*, size_t)>("write")(file, bytes, n);
}
SHOWN ssize_t writev(int file, const iovec* parts, int n) {
  if (file > 2 && fails(kWrite)) return errno = ENOSPC, -1;
  return next<ssize_t (*)(int, const iovec*, int)>("writev")(file, parts, n);
}
SHOWN int fsync(int file) {
  if (fails(kFsync)) return errno = EIO, -1;
  return next<int (*)(int)>("fsync")(file);
}
SHOWN int rename(const char* from, const char* to) {
  if (fails(kRename)) return errno = EACCES, -1;
  return next<int (*)(const char*, const char*)>("rename")(from, to);
}
