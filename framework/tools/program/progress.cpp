// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/program/progress.h"

#include <spdlog/fmt/fmt.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>

#include "framework/tools/program/terminal.h"

namespace lockstep {
namespace {

// A signal handler can only reach a global variable; threads read it.
std::atomic<int> signal_came = 0;
static_assert(std::atomic<int>::is_always_lock_free);

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

// A signal that is ignored (SIGHUP under nohup) stays ignored.
void handle_by(void (*handler)(int)) {
  for (const int signal : kSignals)
    if (std::signal(signal, handler) == SIG_IGN) std::signal(signal, SIG_IGN);
}

extern "C" void note_interrupt(int) {
  signal_came = 1;
  handle_by(SIG_DFL);
}

// One column stays free: a full line would wrap on some terminals.
std::size_t line_width() {
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return (known ? size.ws_col : 80u) - 1u;
}

constexpr double kBarSeconds = 0.1, kLineSeconds = 10;

}  // namespace

Interrupt::Interrupt() {
  signal_came = 0;
  handle_by(note_interrupt);
}
Interrupt::~Interrupt() { handle_by(SIG_DFL); }
bool Interrupt::asked() const { return signal_came != 0; }

std::string progress_line(double t, double until, double seconds, std::size_t width, Counts counts) {
  const double share = until > 0 ? std::clamp(t / until, 0.0, 1.0) : 1.0;
  const bool runs = counts == Counts::runs;
  std::string text = counts == Counts::budget ? fmt::format("{:3.0f} %  {:.0f} s of {:.0f} s", 100 * share, t, until)
                     : runs ? fmt::format("{:3.0f} %  {:.0f} of {:.0f} runs", 100 * share, std::floor(t), until)
                            : fmt::format("{:3.0f} %  t = {:.4g} s of {:.4g} s", 100 * share, t, until);
  if (counts != Counts::budget && seconds > 0 && t > 0)
    text += fmt::format("  {:.3g} {}/s  {:.0f} s to go", t / seconds, runs ? "runs" : "s", (until - t) * seconds / t);
  constexpr std::size_t kLongest = 30, kShortest = 5, kFrame = 3;
  if (width < text.size() + kFrame + kShortest) return text;
  const std::size_t length = std::min(kLongest, width - text.size() - kFrame);
  const auto n = static_cast<std::size_t>(share * static_cast<double>(length));
  return fmt::format("[{:#<{}}{:.<{}}] {}", "", n, "", length - n, text);
}

Progress::Progress(double until, bool quiet, Counts counts)
    : until_(until),
      counts_(counts),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) != 0),
      begin_(Clock::now()),
      last_(begin_) {}

double Progress::seconds() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

void Progress::at(double t) {
  if (quiet_) return;
  const Clock::time_point now = Clock::now();
  if (std::chrono::duration<double>(now - last_).count() < (terminal_ ? kBarSeconds : kLineSeconds)) return;
  last_ = now;
  const std::string line = progress_line(t, until_, seconds(), terminal_ ? line_width() : 0, counts_);
  if (terminal_) {
    tell(fmt::format("\r{:<{}}", line.substr(0, line_width()), line_width()));
    drawn_ = true;
  } else {
    tell(line + "\n");
  }
}

void Progress::finish() {
  if (drawn_) tell(fmt::format("\r{:<{}}\r", "", line_width()));
  drawn_ = false;
}

}  // namespace lockstep
