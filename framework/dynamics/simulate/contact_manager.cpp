// Locates where unilateral links are hit inside a step, and where one in contact would have to pull.
//
// A contact is free while its gap is above its floor, and hit where the gap comes down to it. One that was released (or
// hit) starts at its floor and is re-armed once the gap has risen above the floor by a margin of some roundings of the
// projection (hysteresis against rounding). If it sinks below by the margin without having risen, it is hit there.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include <lockstep/error.h>
#include "framework/dynamics/simulate/contact_manager.h"
#include "framework/dynamics/simulate/root_finder.h"
#include "framework/dynamics/solvers/scales.h"

namespace lockstep {
namespace {

constexpr int kHalvings = 40;       // to find the flight between two hits in one step
constexpr double kNear = 1;         // of what a gap may close in a step: smaller gaps are looked at inside the step
constexpr double kShortest = 1e-9;  // of a step: the earliest cut, so that time advances
constexpr double kPull = 1e-9;      // relative to the largest force: what counts as a pull

template <class G>
double first_below(double ta, double ga, double tb, double gb, double enough, const G& g) {
  const double tolerance = 4 * std::numeric_limits<double>::epsilon() * std::max(std::abs(ta), std::abs(tb));
  return falling_root(ta, ga, tb, gb, tolerance, enough, g);
}

}  // namespace

bool ContactManager::free(std::size_t i, const State& s) const {
  return contacts_.watched(i, s) && !contacts_.in_force(i, s);
}

void ContactManager::lay_out() {
  contacts_.lay_out(dynamics_.system(), dynamics_.options().stabilization);
  const std::size_t n = contacts_.size();
  released_.clear(), contact_time_ = kNever;
  samples_.reserve(n * (StepSearch::kLeast + 1)), hits_.reserve(n);
  touching_.reserve(n), active_.reserve(n), aim_.reserve(n), released_.reserve(n), armed_.reserve(n);
  sample_times_.reserve(StepSearch::kLeast + 1);
}

void ContactManager::save(Snapshot& out) const {
  out.put(static_cast<double>(contacts_.size()));
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Contact& c = contacts_[i];
    for (const double x : {c.floor, c.clear ? 1.0 : 0.0, c.gap.c, c.gap.cd, c.push, c.push_now}) out.put(x);
  }
}

void ContactManager::load(SnapshotReader& in) {
  lay_out();
  if (in.get_count() != static_cast<long>(contacts_.size()))
    throw ModelError("the run was saved with another number of one-sided links");
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    Contact& c = contacts_[i];
    c.floor = in.get(), c.clear = in.get_flag();
    for (double* x : {&c.gap.c, &c.gap.cd, &c.push, &c.push_now}) *x = in.get();
  }
}

void ContactManager::start(const State& state) {
  lay_out();
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (!contacts_.watched(i, state)) continue;
    check_side(i, state, "the start");
    const Gap g = contacts_.gap(i, dynamics_.inputs(state));
    contacts_[i].leave(g);
    if (g.cd < -contacts_[i].rest_speed()) contacts_[i].clear = true;  // the run begins with an impact
  }
}

void ContactManager::check_sides(const State& state, const std::vector<std::string>& links, const std::string& cause) {
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    if (std::find(links.begin(), links.end(), contacts_[i].link->name()) != links.end()) check_side(i, state, cause);
}

void ContactManager::check_side(std::size_t i, const State& state, const std::string& cause) {
  const Gap g = contacts_.gap(i, dynamics_.inputs(state));
  const Contact& contact = contacts_[i];
  const double length = dynamics_.system().length();
  const double depth = -g.c * length_per_unit(contact.link->row_kind(0), length);
  if (!(depth > limit_)) return;
  const std::string advice =
      contact.link->type() == "stop"  // its side is that of its limit
          ? std::string("its range leaves this position out: widen the range (\"low\", \"high\"), or start within it")
          : fmt::format("move its bodies apart, or reverse the side (\"side\": \"{}\")",
                        contact.sign > 0 ? "below" : "above");
  throw AssemblyError(
      fmt::format("{} has the one-sided link '{}' (row {}) on its forbidden side: C = {:.6g}, and C {} 0 is free "
                  "(limit {:.3g} m); {}",
                  cause, contact.link->name(), contact.link->row_name(0), contact.sign * g.c,
                  contact.sign > 0 ? ">=" : "<=", limit_, advice));
}

void ContactManager::note(const State& state, bool moved) {
  bool any_in_force = false;
  const Inputs& in = dynamics_.inputs(state);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (!contacts_.watched(i, state)) continue;
    contacts_[i].gap = contacts_.gap(i, in);
    if (contacts_.in_force(i, state))
      any_in_force = true;
    else
      contacts_[i].see(contacts_[i].gap);
  }
  if (any_in_force && moved) evaluate_pushes(state);
  for (std::size_t i = 0; i < contacts_.size(); ++i) contacts_[i].push = contacts_[i].push_now;
}

const Solution& ContactManager::evaluate_pushes(const State& state) {
  const Solution& v = dynamics_.evaluate(state);
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    if (const int row = contacts_.row(i, v.rows); row >= 0) contacts_[i].push_now = -contacts_[i].sign * v.lambda[row];
  return v;
}

Gap ContactManager::gap_at(std::size_t i, double t) { return contacts_.gap(i, dynamics_.inputs(interval_.at(t))); }

double ContactManager::push_at(std::size_t i, double t) {
  const Evaluated& v = dynamics_.evaluate(interval_.at(t));
  return -contacts_[i].sign * v.lambda[contacts_.row(i, v.rows)];
}

// Whether a step may hide a hit although the contact is free at both ends.
bool ContactManager::nears(std::size_t i, const Gap& a, const Gap& b, double h) const {
  const Contact& contact = contacts_[i];
  const double way = h * std::max(std::abs(a.cd), std::abs(b.cd));
  const double least = contact.clear ? std::min(a.c, b.c) : b.c;
  return least - contact.floor <= kNear * way;
}

// The turning point of a gap that falls at a and rises at b, and the gap there.
double ContactManager::lowest_between(std::size_t i, double ta, const Gap& a, double tb, const Gap& b, double& c) {
  const double enough = 1e-6 * std::max(-a.cd, b.cd);
  const double t = first_below(ta, -a.cd, tb, -b.cd, enough, [&](double when) { return -gap_at(i, when).cd; });
  c = gap_at(i, t).c;
  return t;
}

// The first instant in [ta, tb] at which the contact is hit; never: infinity.
double ContactManager::hit_between(std::size_t i, double ta, const Gap& a, double tb, const Gap& b) {
  Contact& contact = contacts_[i];
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

// The gaps at the beginning of the step, at instants inside it and at its end.
void ContactManager::sample(const State& end, const std::vector<double>& inside) {
  const auto add = [&](const State& state) {
    sample_times_.push_back(state.t);
    const Inputs& in = dynamics_.inputs(state);
    for (std::size_t i = 0; i < contacts_.size(); ++i) samples_.push_back(free(i, end) ? contacts_.gap(i, in) : Gap{});
  };
  sample_times_.assign(1, interval_.from().t), samples_.clear();
  for (std::size_t i = 0; i < contacts_.size(); ++i) samples_.push_back(contacts_[i].gap);
  for (const double t : inside) add(search_.look(t));
  add(end);
}

// Whether the step may hide a hit from what is known at its ends, which was sampled.
bool ContactManager::must_look_inside(const State& end) {
  if (!interval_.has_dense()) return false;
  const std::size_t n = contacts_.size();
  search_.begin(end);
  bool near = search_.turn_parts() > 1 || search_.along();
  for (std::size_t i = 0; i < n && !near; ++i)
    near = free(i, end) && nears(i, samples_[i], samples_[n + i], end.t - interval_.from().t);
  if (!near || !search_.many()) return near;
  sample(end, search_.scales());
  for (std::size_t i = 0; i < n; ++i) {
    if (!free(i, end)) continue;
    double low = kNever, high = -kNever;
    for (std::size_t k = i; k < samples_.size(); k += n)
      low = std::min(low, samples_[k].c - contacts_[i].floor),
      high = std::max(high, samples_[k].c - contacts_[i].floor);
    if (!is_far(low, high - low)) return true;
  }
  sample(end, {});
  return false;
}

// The first hit between two of the samples.
double ContactManager::first_hit(const State& end) {
  const std::size_t n = contacts_.size();
  for (std::size_t part = 1; part < sample_times_.size(); ++part) {
    double first = kNever;
    for (std::size_t i = 0; i < n; ++i) {
      if (!free(i, end)) continue;
      const Gap a = samples_[(part - 1) * n + i], b = samples_[part * n + i];
      first = std::min(first, hit_between(i, sample_times_[part - 1], a, sample_times_[part], b));
    }
    if (std::isfinite(first)) return first;
    for (std::size_t i = 0; i < n; ++i)
      if (free(i, end)) contacts_[i].see(samples_[part * n + i]);
  }
  return kNever;
}

// Samples the gaps at the end of the step, and inside it where one of them may be hit there; returns the first hit.
double ContactManager::locate_hit(const State& end) {
  armed_.clear();
  bool any_free = false;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    armed_.emplace_back(contacts_[i].clear, contacts_[i].floor);
    any_free = any_free || free(i, end);
  }
  if (!any_free) return kNever;
  sample(end, {});
  if (must_look_inside(end)) sample(end, search_.even());
  const double first = first_hit(end);
  return std::min(first, hit_at_output(end, first));
}

// A hit that an output shows before `before`: no row lies beyond a contact that is not made.
double ContactManager::hit_at_output(const State& end, double before) {
  const std::vector<double>& outputs = search_.outputs_before(std::min(before, end.t));
  if (outputs.empty()) return kNever;
  double beyond = kNever;
  const Dynamics::Aside aside(dynamics_);
  for (std::size_t k = 0; k < outputs.size() && beyond == kNever; ++k) {
    const Inputs& in = dynamics_.inputs(search_.look(outputs[k]));
    for (std::size_t i = 0; i < contacts_.size(); ++i)
      if (free(i, end) && contacts_.gap(i, in).c < armed_[i].second - contacts_[i].margin) beyond = outputs[k];
  }
  if (beyond == kNever) return kNever;
  for (std::size_t i = 0; i < contacts_.size(); ++i) std::tie(contacts_[i].clear, contacts_[i].floor) = armed_[i];
  instants_.assign(sample_times_.begin() + 1, sample_times_.end() - 1);
  instants_.insert(std::lower_bound(instants_.begin(), instants_.end(), beyond), beyond);
  sample(end, instants_);
  return first_hit(end);
}

double ContactManager::locate_release(std::size_t i, double t1) {
  const double ga = contacts_[i].push, gb = contacts_[i].push_now, t0 = interval_.from().t;
  if (!(ga > 0)) return t0;
  return first_below(t0, ga, t1, gb, 1e-10 * std::max(ga, -gb), [&](double t) { return push_at(i, t); });
}

// The instant at which the first of the links in contact that pull at the end begins to pull, if before `before`.
double ContactManager::locate_releases(const State& end, double before) {
  bool any_in_force = false;
  for (std::size_t i = 0; i < contacts_.size(); ++i) any_in_force = any_in_force || contacts_.in_force(i, end);
  if (!any_in_force) return kNever;
  const Solution& v = evaluate_pushes(end);
  const double limit = kPull * std::max(v.lambda.size() > 0 ? v.lambda.lpNorm<Eigen::Infinity>() : 0.0,
                                        v.evaluation.force().lpNorm<Eigen::Infinity>());
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    if (contacts_.in_force(i, end) && contacts_[i].push_now < -limit) released_.push_back(i);
  double earliest = kNever;
  std::size_t n = 0;
  for (const std::size_t i : released_) {
    const double t = locate_release(i, end.t);
    if (t > before || t > earliest) continue;
    if (t < earliest) n = 0;
    earliest = t, released_[n++] = i;
  }
  released_.resize(n);
  return earliest;
}

bool ContactManager::locate(State& state) {
  const double t0 = interval_.from().t, t1 = state.t;
  released_.clear();
  interval_.keep_method();
  double first = locate_hit(state);
  first = std::min(first, locate_releases(state, first));
  if (!std::isfinite(first)) {
    interval_.restore_method();
    return false;
  }
  first = std::min(t1, std::max(first, t0 + kShortest * (t1 - t0)));
  if (first < t1)
    interval_.cut(first, state);
  else
    interval_.restore_method();
  contact_time_ = first;
  return true;
}

}  // namespace lockstep
