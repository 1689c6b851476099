// Where one-sided links are hit inside a step, and where one that holds would have to pull.
//
// A contact is free while its gap is above its floor, and hit where the gap comes down to it. One that was let go (or
// hit) begins at its floor; it must first rise above it by a margin, some roundings of the projection, before it can be
// hit again: noise hits nothing. Should it sink below by the margin without having risen, it is hit there.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "framework/dynamics/simulate/simulation_loop.h"
#include "framework/foundation/support/error.h"

namespace lockstep {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr int kParts = 6;           // of a step that may hide a hit: it is looked at between them
constexpr int kHalvings = 40;       // to find the flight between two hits in one step
constexpr double kNear = 0.25;      // of what a gap may close in a step: nearer is looked at more closely
constexpr double kShortest = 1e-9;  // of a step: where it is cut at least, so that time goes on
constexpr double kPull = 1e-9;      // of the largest force: what counts as a pull

// Bracket [a, b], g above zero at a and not above at b: Illinois' false position, a bisection whenever two tries did
// not halve it. The far end: there g is not above zero.
template <class F>
double first_below(double ta, double ga, double tb, double gb, double enough, const F& g) {
  const double tolerance = 4 * std::numeric_limits<double>::epsilon() * std::max(std::abs(ta), std::abs(tb));
  double value = gb, width = tb - ta;
  for (int i = 0; tb - ta > tolerance && value < -enough; ++i) {
    double t = tb - gb * (tb - ta) / (gb - ga);
    if (i % 3 == 2) {
      if (tb - ta > 0.5 * width) t = 0.5 * (ta + tb);
      width = tb - ta;
    }
    t = std::clamp(t, ta + 0.25 * tolerance, tb - 0.25 * tolerance);
    const double now = g(t);
    if (now > 0) {
      ta = t, ga = now, gb *= 0.5;
    } else {
      tb = t, gb = value = now, ga *= 0.5;
    }
  }
  return tb;
}

}  // namespace

void Simulation::Loop::begin_contacts() {
  const std::size_t n = contacts.size();
  released.clear(), contact_time = kNever;
  for (std::vector<Gap>* v : {&samples, &hits}) v->reserve(n * (kParts + 1));
  touching.reserve(n), active.reserve(n), aim.reserve(n), released.reserve(n);
  sample_times.reserve(kParts + 1);
  for (std::size_t i = 0; i < n; ++i) {
    if (!contacts.watched(i, sim.state_)) continue;
    check_side(i, "the start");
    const Gap g = contacts.gap(i, sim.dynamics_.look(sim.state_));
    contacts[i].leave(g);
    if (g.cd < -contacts[i].rest_speed()) contacts[i].clear = true;  // it begins with an impact
  }
}

void Simulation::Loop::check_side(std::size_t i, const std::string& cause) {
  const Gap g = contacts.gap(i, sim.dynamics_.look(sim.state_));
  const Contact& contact = contacts[i];
  const double length = sim.system().length();
  const RowKind kind = contact.link->row_kind(0);
  const double depth = -g.c * (kind == RowKind::translation ? 1.0 : kind == RowKind::rotation ? 2 * length : length);
  if (!(depth > sim.options_.start_limit)) return;
  throw AssemblyError(
      fmt::format("{} has the one-sided link '{}' (row {}) on its forbidden side: C = {:.6g}, and C {} 0 is free "
                  "(limit {:.3g} m); move its bodies apart, or turn the side over (\"side\": \"{}\")",
                  cause, contact.link->name(), contact.link->row_name(0), contact.sign * g.c,
                  contact.sign > 0 ? ">=" : "<=", sim.options_.start_limit, contact.sign > 0 ? "below" : "above"));
}

void Simulation::Loop::note_contacts(bool moved) {
  const State& state = sim.state_;
  bool any_in_force = false;
  const Inputs& in = sim.dynamics_.look(state);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (!contacts.watched(i, state)) continue;
    contacts[i].gap = contacts.gap(i, in);
    if (contacts.in_force(i, state))
      any_in_force = true;
    else
      contacts[i].see(contacts[i].gap);
  }
  if (any_in_force && moved) look_at_pushes(state);
  for (std::size_t i = 0; i < contacts.size(); ++i) contacts[i].push = contacts[i].push_now;
}

void Simulation::Loop::look_at_pushes(const State& state) {
  const Evaluated& v = sim.dynamics_.evaluate(state);
  for (std::size_t i = 0; i < contacts.size(); ++i)
    if (const int row = contacts.row(i, v.rows); row >= 0) contacts[i].push_now = -contacts[i].sign * v.lambda[row];
}

// Forces below this are noise; of the evaluation made last.
double Simulation::Loop::pull_limit() const {
  const Evaluated& v = sim.dynamics_.values();
  const double lambda = v.lambda.size() > 0 ? v.lambda.lpNorm<Eigen::Infinity>() : 0.0;
  return kPull * std::max(lambda, sim.dynamics_.force().lpNorm<Eigen::Infinity>());
}

Gap Simulation::Loop::gap_at(std::size_t i, double t) {
  state_at(t, scratch);
  return contacts.gap(i, sim.dynamics_.look(scratch));
}

double Simulation::Loop::push_at(std::size_t i, double t) {
  state_at(t, scratch);
  const Evaluated& v = sim.dynamics_.evaluate(scratch);
  return -contacts[i].sign * v.lambda[contacts.row(i, v.rows)];
}

// Whether a step may hide a hit although both its ends are free.
bool Simulation::Loop::nears(std::size_t i, const Gap& a, const Gap& b, double h) const {
  const Contact& contact = contacts[i];
  const double way = h * std::max(std::abs(a.cd), std::abs(b.cd));
  const double least = contact.clear ? std::min(a.c, b.c) : b.c;
  return least - contact.floor <= kNear * way;
}

// The turning point of a gap that falls at a and rises at b, and the gap there.
double Simulation::Loop::lowest_between(std::size_t i, double ta, const Gap& a, double tb, const Gap& b, double& c) {
  const double enough = 1e-6 * std::max(-a.cd, b.cd);
  const double t = first_below(ta, -a.cd, tb, -b.cd, enough, [&](double when) { return -gap_at(i, when).cd; });
  c = gap_at(i, t).c;
  return t;
}

// The first instant in [ta, tb] at which the contact is hit; never: infinity.
double Simulation::Loop::hit_between(std::size_t i, double ta, const Gap& a, double tb, const Gap& b) {
  Contact& contact = contacts[i];
  const double floor = contact.floor, enough = 1e-2 * contact.margin;
  const auto fall = [&](double from_t, double from_c, double to_t, double to_c, double level) {
    return first_below(from_t, from_c - level, to_t, to_c - level, enough,
                       [&](double t) { return gap_at(i, t).c - level; });
  };
  if (!contact.clear) {
    if (b.c >= floor - contact.margin) return kNever;
    double t = tb;
    for (int k = 0; k < kHalvings && a.cd > 0; ++k) {  // did it rise and come back?
      t = ta + 0.5 * (t - ta);
      const Gap g = gap_at(i, t);
      if (!contact.above(g)) continue;
      contact.clear = true;
      return fall(t, g.c, tb, b.c, floor);
    }
    return fall(ta, std::max(a.c, floor), tb, b.c, floor - contact.margin);
  }
  if (b.c <= floor) return fall(ta, a.c, tb, b.c, floor);
  if (!(a.cd < 0 && b.cd > 0)) return kNever;
  // a gap that bends upwards lies above its tangents at both ends
  const double meet = (b.c - b.cd * tb - a.c + a.cd * ta) / (a.cd - b.cd);
  if (a.c + a.cd * (meet - ta) > floor) return kNever;
  double lowest = 0;
  const double t = lowest_between(i, ta, a, tb, b, lowest);
  return lowest <= floor ? fall(ta, a.c, t, lowest, floor) : kNever;
}

// Gaps at the end of the step, and between where one of them is near; the first hit of the first part that has one.
double Simulation::Loop::locate_hit(double t1) {
  const std::size_t n = contacts.size();
  const double t0 = from.t;
  std::vector<double>& times = sample_times;
  const auto free = [&](std::size_t i) { return contacts.watched(i, sim.state_) && !contacts.in_force(i, sim.state_); };
  const auto sample = [&](double t, const State& state) {
    times.push_back(t);
    const Inputs& in = sim.dynamics_.look(state);
    for (std::size_t i = 0; i < n; ++i) samples.push_back(free(i) ? contacts.gap(i, in) : Gap{});
  };
  times.assign(1, t0);
  samples.clear();
  for (std::size_t i = 0; i < n; ++i) samples.push_back(contacts[i].gap);
  sample(t1, sim.state_);
  bool near = false;
  for (std::size_t i = 0; i < n; ++i) near = near || (free(i) && nears(i, samples[i], samples[n + i], t1 - t0));
  if (near && has_dense) {
    times.pop_back(), samples.resize(n);
    for (int k = 1; k < kParts; ++k) {
      state_at(t0 + (t1 - t0) * k / kParts, scratch);
      sample(scratch.t, scratch);
    }
    sample(t1, sim.state_);
  }
  for (std::size_t part = 1; part < times.size(); ++part) {
    double first = kNever;
    for (std::size_t i = 0; i < n; ++i) {
      if (!free(i)) continue;
      const Gap a = samples[(part - 1) * n + i], b = samples[part * n + i];
      first = std::min(first, hit_between(i, times[part - 1], a, times[part], b));
    }
    if (std::isfinite(first)) return first;
    for (std::size_t i = 0; i < n; ++i)
      if (free(i)) contacts[i].see(samples[part * n + i]);
  }
  return kNever;
}

double Simulation::Loop::locate_release(std::size_t i, double t1) {
  const double ga = contacts[i].push, gb = contacts[i].push_now;
  if (!(ga > 0)) return from.t;
  return first_below(from.t, ga, t1, gb, 1e-10 * std::max(ga, -gb), [&](double t) { return push_at(i, t); });
}

bool Simulation::Loop::locate_contacts() {
  const double t1 = sim.state_.t;
  released.clear();
  if (!has_dense) after.clear(), sim.method_->save(after);
  double first = locate_hit(t1);
  // of those that hold: which pull at the end
  bool any_in_force = false;
  for (std::size_t i = 0; i < contacts.size(); ++i) any_in_force = any_in_force || contacts.in_force(i, sim.state_);
  if (any_in_force) {
    look_at_pushes(sim.state_);
    const double limit = pull_limit();
    for (std::size_t i = 0; i < contacts.size(); ++i)
      if (contacts.in_force(i, sim.state_) && contacts[i].push_now < -limit) released.push_back(i);
    double earliest = kNever;
    std::size_t n_released = 0;
    for (const std::size_t i : released) {
      const double t = locate_release(i, t1);
      if (t > first || t > earliest) continue;
      if (t < earliest) n_released = 0;
      earliest = t, released[n_released++] = i;
    }
    released.resize(n_released);
    first = std::min(first, earliest);
  }
  if (!std::isfinite(first)) {
    if (!has_dense) after.rewind(), sim.method_->restore(after);
    return false;
  }
  first = std::min(t1, std::max(first, from.t + kShortest * (t1 - from.t)));
  if (first < t1) {
    state_at(first, scratch);
    sim.state_ = scratch;
    step.h = first - from.t;
  } else if (!has_dense) {
    after.rewind(), sim.method_->restore(after);
  }
  contact_time = first;
  return true;
}

}  // namespace lockstep
