// Locates where unilateral links are hit inside a step, and where one in contact would have to pull.
//
// A contact is free while its gap is above zero, and hit where the gap comes down to it. One that was released (or hit)
// starts at its floor, zero or a rounding below, and is hit a margin below that until it has risen above zero by the
// margin, some roundings of the projection (hysteresis against rounding).
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include "framework/dynamics/simulate/contact_manager.h"
#include "framework/dynamics/solvers/scales.h"

namespace lockstep {
namespace {

constexpr double kShortest = 1e-9;  // of a step: the earliest cut, so that time advances
constexpr double kPull = 1e-9;      // relative to the largest force: what counts as a pull

}  // namespace

bool ContactManager::free(std::size_t i, const State& s) const {
  return contacts_.watched(i, s) && !contacts_.in_force(i, s);
}

void ContactManager::lay_out() {
  contacts_.lay_out(dynamics_.system(), dynamics_.options().stabilization);
  const std::size_t n = contacts_.size();
  released_.clear(), contact_time_ = kNever;
  touching_.reserve(n), hits_.reserve(n), active_.reserve(n), aim_.reserve(n), released_.reserve(n), guards_.reserve(n);
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

// Of a link in force its push, else its gap.
double ContactManager::guard(std::size_t i, const Sample& sample) {
  if (!contacts_.in_force(i, sample.state)) return contacts_.gap(i, sample.inputs()).c;
  const Evaluated& v = sample.values();
  return -contacts_[i].sign * v.lambda[contacts_.row(i, v.rows)];
}

// Whether a step may hide a hit although the contact is free at both ends: a gap that is closed at its largest rate.
bool ContactManager::nears(std::size_t i, const Gap& end, double h) const {
  const Contact& contact = contacts_[i];
  const double least = contact.clear ? std::min(contact.gap.c, end.c) : end.c;
  return least - contact.floor <= h * std::max(std::abs(contact.gap.cd), std::abs(end.cd));
}

// The first instant at which a contact is hit; infinity: none is.
double ContactManager::locate_hit(const State& end) {
  guards_.clear();
  bool any_free = false;
  for (std::size_t i = 0; i < contacts_.size(); ++i) any_free = any_free || free(i, end);
  if (!any_free) return kNever;
  bool near = !finder_.is_short();
  const double t0 = interval_.from().t;
  const Inputs& in = dynamics_.inputs(end);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (!free(i, end)) continue;
    const Contact& c = contacts_[i];
    const Gap gap = contacts_.gap(i, in);
    near = near || nears(i, gap, end.t - t0);
    Guard g{.of = i, .from = c.gap.c, .to = gap.c};
    if (!c.clear || !(c.gap.c > 0))
      g.armed = false, g.rises = c.gap.cd > 0, g.low = c.floor - c.margin, g.rise = c.margin,
      g.from = std::max(c.gap.c, c.floor);
    guards_.push_back(g);
  }
  const double first = finder_.find(guards_, near);
  for (const Guard& g : guards_)
    if (g.at <= first) contacts_[g.of].clear = contacts_[g.of].clear || g.armed;
  return first;
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
    const Contact& c = contacts_[i];
    const double t0 = interval_.from().t, t1 = end.t;
    const double t = c.push > 0 ? finder_.root({.of = i}, {t0, c.push}, {t1, c.push_now}) : t0;
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
  finder_.begin(state);
  double first = locate_hit(state);
  first = std::min(first, locate_releases(state, first));
  const bool found = first != kNever;
  if (found) first = contact_time_ = std::min(t1, std::max(first, t0 + kShortest * (t1 - t0)));
  finder_.cut(first, state);
  return found;
}

}  // namespace lockstep
