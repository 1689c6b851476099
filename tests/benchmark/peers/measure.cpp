// SPDX-License-Identifier: BSD-3-Clause
#include "tests/benchmark/peers/measure.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

namespace lockstep::peers {

namespace {

constexpr double kUseless = 0.1;    // m; a run with a larger error is not timed
constexpr double kQuickest = 0.01;  // s of CPU; shorter runs are repeated until they add up to it

double clock_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Holds a file's lock while it lives, so that two timed runs of one machine do not meet.
class MachineLock {
 public:
  explicit MachineLock(const std::string& path)
      : file_(path.empty() ? -1 : open(path.c_str(), O_CREAT | O_RDWR, 0666)) {
    if (file_ >= 0) flock(file_, LOCK_EX);
  }
  ~MachineLock() {
    if (file_ >= 0) close(file_);
  }
  MachineLock(const MachineLock&) = delete;
  MachineLock& operator=(const MachineLock&) = delete;

 private:
  int file_;
};

}  // namespace

double user_seconds() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return double(usage.ru_utime.tv_sec) + 1e-6 * double(usage.ru_utime.tv_usec);
}

// -- Run

void Run::sample(double t, const Motions& now) {
  const double hair = 1e-9 * mechanism.until;
  while (history.size() <= kReports) {
    const double wanted = mechanism.until * double(history.size()) / kReports;
    if (wanted > t + hair) break;
    history.push_back(between(wanted < t - hair ? wanted : t, t, now));
    interpolated |= wanted < t - hair;
  }
  watch(now);
  t_last = t;
  last_ = now;
}

// Cubic through places and velocities at both ends of the step.
Positions Run::between(double t, double t_now, const Motions& now) const {
  Positions x;
  const bool inside = t < t_now;
  const double h = t_now - t_last, s = inside ? (t - t_last) / h : 1.0;
  const double a = (1 + 2 * s) * (1 - s) * (1 - s), b = s * (1 - s) * (1 - s), d = s * s * (s - 1);
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (inside)
      x.push_back(a * last_[i].x + b * h * last_[i].v + (1 - a) * now[i].x + d * h * now[i].v);
    else
      x.push_back(now[i].x);
  }
  return x;
}

void Run::watch(const Motions& now) {
  for (const BodyMotion& b : now) broken |= !b.x.allFinite() || !b.v.allFinite();
  if (!is_described(mechanism)) return;
  const double T = kinetic_energy(mechanism, now), E = T + potential_energy(mechanism, now);
  if (last_.empty()) start_energy_ = E;
  largest_kinetic_ = std::max(largest_kinetic_, T);
  const double change = std::abs(E - start_energy_), gap = largest_gap(mechanism, now);
  if (!(change <= largest_change_)) largest_change_ = change;
  if (!(gap <= violation)) violation = gap;
  energy_drift = largest_change_ / std::max(largest_kinetic_, 1e-300);
}

void Run::check_time() const {
  if (user_seconds() - born_ > allowed_) throw TooSlow{};
}

// -- ladders

Ladder step_ladder(const Mechanism& m, double largest) {
  const double length = m.until;
  long n0 = kReports;
  while (length / double(n0) > largest) n0 *= 2;
  return [=](int rung) {
    const long n = rung < 0 ? (rung > -30 ? n0 >> -rung : 0) : n0 << rung;
    return n > 0 && length / double(n) <= largest ? length / double(n) : 0.0;
  };
}

Ladder tolerance_ladder() {
  return [](int rung) { return rung == -3 ? 0.99 : rung < -3 || rung > 10 ? 0.0 : std::pow(10.0, -3 - rung); };
}

long n_steps(const Mechanism& m, double h) { return std::lround(m.until / h); }

bool due(long i, long n) { return n <= kReports || i % (n / kReports) == 0; }

// -- Bench

struct Bench::Result {
  double cpu = std::nan(""), error = std::nan(""), error_end = std::nan(""), drift = std::nan(""), violation = 0;
  double cost = 0;  // CPU of the sampled run, s
  bool done = false, slow = false, failed = false;
  char status[240] = "";

  void say(std::string text) {
    for (char& c : text)
      if (c == ',' || c == '\n') c = ';';
    std::snprintf(status, sizeof status, "%s", text.c_str());
  }
  bool useful() const { return done && error <= kUseless; }
};

Bench::Bench(std::string system, int argc, char** argv)
    : system_(std::move(system)), truths_([&] {
        std::string folder = ".";
        for (int i = 1; i + 1 < argc; i += 2) {
          words_.emplace_back(argv[i], argv[i + 1]);
          if (words_.back().first == "--truth") folder = argv[i + 1];
        }
        return folder;
      }()) {
  if (!word("--budget").empty()) budget_ = std::stod(word("--budget"));
  const std::string seconds = word("--seconds");
  deadline_ = seconds.empty() ? HUGE_VAL : clock_seconds() + std::stod(seconds);
}

std::string Bench::word(const std::string& key) const {
  const std::vector<std::string> values = all_words(key);
  return values.empty() ? "" : values.back();
}

std::vector<std::string> Bench::all_words(const std::string& key) const {
  std::vector<std::string> values;
  for (const auto& [name, value] : words_)
    if (name == key) values.push_back(value);
  return values;
}

bool Bench::wants(const Mechanism& m) const {
  const std::vector<std::string> names = all_words("--mechanism");
  return names.empty() || std::find(names.begin(), names.end(), m.name) != names.end();
}

bool Bench::wants(const Mechanism& m, const std::string& method) const {
  return wants(m) && method.find(word("--method")) != std::string::npos;
}

bool Bench::out_of_time() const { return clock_seconds() > deadline_; }

// A sampled run tells the errors; runs that are of use are timed.
Bench::Result Bench::measure(const Mechanism& m, const Simulate& simulate) {
  Result r;
  Run run(m, true, 2 * budget_);
  const double begin = user_seconds();
  try {
    simulate(run);
  } catch (const TooSlow&) {
    r.slow = true;
    r.say("over-budget");
    return r;
  } catch (const std::exception& e) {
    r.failed = true;
    r.violation = run.violation;
    r.say(std::string("exception: ") + e.what());
    return r;
  }
  r.cost = std::max(1e-7, user_seconds() - begin);
  const History& truth = truths_.of(m);
  if (run.history.size() == truth.size()) {
    r.error = largest_distance(run.history, truth);
    r.error_end = largest_distance(run.history.back(), truth.back());
  }
  if (is_described(m) && m.kind != Kind::slider_crank) r.drift = run.energy_drift;
  r.violation = run.violation;
  r.done = !run.broken && r.error < 1e3;
  std::string status = run.broken ? "NaN" : !std::isfinite(r.error) ? "incomplete" : r.done ? "ok" : "blown-up";
  status += " steps=" + std::to_string(run.steps) + (run.interpolated ? " hermite " : " ") + run.note;
  if (r.useful()) time(m, simulate, r);
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  r.say(status + (r.useful() && !std::isfinite(r.cpu) ? " timing-failed" : "") +
        " memory=" + std::to_string(usage.ru_maxrss / 1024) + "MB");
  return r;
}

// The least of five, of two above 0.3 s, once above 1 s.
void Bench::time(const Mechanism& m, const Simulate& simulate, Result& r) {
  const MachineLock lock(word("--lock"));
  const int rounds = r.cost < 0.3 ? 5 : r.cost < 1 ? 2 : 1;
  try {
    for (int round = 0; round < rounds; ++round) {
      double sum = 0;
      int n = 0;
      for (; sum < kQuickest && n < 1000; ++n) {
        Run run(m, false, 3 * budget_);
        simulate(run);
        sum += run.spent;
      }
      r.cpu = std::fmin(r.cpu, sum / n / m.until);
    }
  } catch (const TooSlow&) {
  } catch (const std::exception&) {
  }
}

// In a process of its own: some systems take theirs with them when they fail.
Bench::Result Bench::measure_apart(const Mechanism& m, const std::string& method, double setting,
                                   const Simulate& simulate) {
  truths_.of(m);
  std::fflush(stdout);
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = fork();
  if (child == 0) {
    const rlim_t seconds = static_cast<rlim_t>(30 * budget_ + 30);
    const rlimit limit{seconds, seconds};
    setrlimit(RLIMIT_CPU, &limit);
    const Result r = measure(m, simulate);
    _exit(write(ends[1], &r, sizeof r) == ssize_t(sizeof r) ? 0 : 1);
  }
  close(ends[1]);
  Result r;
  const bool whole = read(ends[0], &r, sizeof r) == ssize_t(sizeof r);
  close(ends[0]);
  int state = 0;
  waitpid(child, &state, 0);
  if (!whole) {
    r = {};
    r.failed = true;
    r.say("died: signal " + std::to_string(WIFSIGNALED(state) ? WTERMSIG(state) : 0));
  }
  std::printf("%s,%s,%s,%.6g,%.5g,%.3g,%.3g,%.3g,%.3g,%s\n", system_.c_str(), m.name.c_str(), method.c_str(), setting,
              r.cpu, r.error, r.error_end, r.drift, r.violation, r.status);
  std::fflush(stdout);
  return r;
}

// Coarser until the error passes 0.1 m or the run fails; then finer until the error stops falling (or is below 1e-12 m,
// round-off), the next would exceed the budget, or three in a row failed (twelve, where none was good before: a stiff
// mechanism).
void Bench::sweep(const Mechanism& m, const std::string& method, const Ladder& setting,
                  const std::function<Simulate(double)>& make, double growth) {
  if (!wants(m, method)) return;
  if (out_of_time()) {
    std::fprintf(stderr, "%s %s %s: left out, the time is up\n", system_.c_str(), m.name.c_str(), method.c_str());
    return;
  }
  const auto run = [&](int rung) { return measure_apart(m, method, setting(rung), make(setting(rung))); };
  const Result start = run(0);
  Result r = start;
  for (int rung = -1; (r.slow || r.useful()) && setting(rung) > 0 && !out_of_time(); --rung) r = run(rung);
  if (start.slow) return;
  double best = start.done ? start.error : 1e9, cost = start.cost;
  int stalled = 0, failed = 0;
  for (int rung = 1; setting(rung) > 0 && best > 1e-12 && stalled < 4 && failed < (best < 1e9 ? 3 : 12); ++rung) {
    if (out_of_time() || cost * std::pow(setting(rung - 1) / setting(rung), growth) > budget_) break;
    r = run(rung);
    if (r.slow) break;
    failed = r.failed ? failed + 1 : 0;
    if (r.cost > 0) cost = r.cost;
    if (r.done && r.error < 0.8 * best)
      best = r.error, stalled = 0;
    else if (best < kUseless)
      ++stalled;
  }
}

}  // namespace lockstep::peers
