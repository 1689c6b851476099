// SPDX-License-Identifier: BSD-3-Clause
// A plugin that ends the process that opens it, in the way that LOCKSTEP_TEST_DEADLY says.
#include <sys/syscall.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <new>
#include <string>

#include <lockstep/author/plugin.h>

namespace {

struct Still final : lockstep::MotionLaw {
  static lockstep::TypeInfo info() { return {"deadly_law", "nothing", {}}; }
  static lockstep::LawPtr<lockstep::MotionLaw> make(const lockstep::Params&) { return std::make_shared<Still>(); }
  lockstep::LawValue at(double) const override { return {}; }
};

void die(int signal) {
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

std::string wish() {
  const char* how = std::getenv("LOCKSTEP_TEST_DEADLY");
  return how == nullptr ? "" : how;
}

bool begin() {
  const std::string how = wish();
  if (how == "segv") die(SIGSEGV);
  if (how == "ill") die(SIGILL);
  if (how == "abort") die(SIGABRT);
  if (how == "alarm") die(SIGALRM);  // as when time is up
  // The thread sanitizer replaces _exit, and ends with a code of its own if it is called within dlopen.
  if (how == "exit") syscall(SYS_exit_group, 3);
  if (how == "quiet") syscall(SYS_exit_group, 0);
  if (how == "late") std::atexit([] { die(SIGABRT); });
  return true;
}

const bool kBegun = begin();

}  // namespace

LOCKSTEP_PLUGIN(registry) {
  if (wish() == "memory") throw std::bad_alloc();
  if (kBegun) registry.laws.add<Still>();
}
