// SPDX-License-Identifier: BSD-3-Clause
// Locates where unilateral links are hit inside a step, and where one in contact would have to pull.
//
// A contact is free while its gap is above zero, and hit where the gap comes down to it. One that leaves at a speed is
// hit where it is back at its gap: of (gap - gap0)/(t - t0), which has not the zero that it leaves. Any other that
// touches is hit a margin below its floor, zero or where it was released; the margin is some roundings of the projection.
#include <spdlog/fmt/fmt.h>

#include <cmath>

#include <lockstep/detail/phi_function.h>
#include <lockstep/error.h>
#include <lockstep/joints.h>
#include "framework/dynamics/simulate/contact_manager.h"
#include "framework/dynamics/solvers/scales.h"
#include "framework/foundation/math/limits.h"
#include "framework/mechanism/links/joint_functions.h"

namespace lockstep {
void ContactManager::lay_out() {
  contacts_.lay_out(dynamics_.system(), dynamics_.options().stabilization);
  const std::size_t n = contacts_.size();
  released_.clear(), contact_time_ = kNever;
  touching_.reserve(n), released_.reserve(n);
}

void ContactManager::save(Snapshot& out) const {
  out.put(static_cast<double>(contacts_.size()));
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    for (const Contact& c = contacts_[i]; const double x : {c.floor, c.gap.c, c.gap.cd, c.push, c.push_now}) out.put(x);
}

void ContactManager::load(SnapshotReader& in) {
  lay_out();
  if (in.get_count() != static_cast<long>(contacts_.size()))
    throw ModelError("the run was saved with another number of one-sided links");
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    Contact& c = contacts_[i];
    for (double* x : {&c.floor, &c.gap.c, &c.gap.cd, &c.push, &c.push_now}) *x = in.get();
  }
}

void ContactManager::start(const State& state) {
  lay_out();
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (!contacts_.watched(i, state)) continue;
    check_side(i, state, "the start");
    contacts_[i].leave(contacts_.gap(i, dynamics_.inputs(state)));
  }
}

void ContactManager::check_sides(const State& state, const std::vector<std::string>& links, const std::string& cause) {
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    if (std::find(links.begin(), links.end(), contacts_[i].link->name()) != links.end()) check_side(i, state, cause);
}

void ContactManager::check_side(std::size_t i, const State& state, const std::string& cause) {
  const Gap g = contacts_.gap(i, dynamics_.inputs(state));
  const Contact& contact = contacts_[i];
  const double depth = -g.c * length_per_unit(contact.link->row_kind(0), dynamics_.system().length());
  if (!(depth > limit_)) return;
  const auto fail_at = [&](const auto& end, double scale, const char* unit) {
    const auto shown = [&](double x) {  // without the digits of round-off
      return fmt::format("{:.4g} {}", std::abs(x) < kNegligible ? 0.0 : scale * x, unit);
    };
    throw AssemblyError(
        fmt::format("{} lies {} beyond the stop '{}': the coordinate is {}, its limit is {}; widen its range (\"low\", "
                    "\"high\"), or start within it (\"start\": {{\"position\": ...}}; with \"at\" it is 0 as drawn)",
                    cause, shown(std::abs(g.c)), contact.link->name(), shown(end.limit + end.sign * contact.sign * g.c),
                    shown(end.limit)));
  };
  if (const auto* turn = dynamic_cast<const TurnStop*>(contact.link))
    fail_at(phi_of<StopAbout>(turn->function()), 180 / kPi, "deg");
  if (const auto* slide = dynamic_cast<const SlideStop*>(contact.link))
    fail_at(phi_of<StopAlong>(slide->function()), 1, "m");
  const bool above = contact.sign > 0;
  throw AssemblyError(
      fmt::format("{} lies {:.4g} m on the wrong side of the one-sided joint '{}'; move its bodies {}, or reverse the "
                  "side (\"side\": \"{}\")",
                  cause, depth, contact.link->name(), above ? "apart" : "closer together", above ? "below" : "above"));
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

// What a free contact has to fall to zero for a hit.
double ContactManager::height(const Contact& c, double gap, double t) const {
  if (c.leaves()) return (gap - c.gap.c) / (t - interval_.from().t);
  return c.above(c.gap) && c.gap.c > 0 ? gap : gap - (c.floor - c.margin);
}

// Of a link in force its push, else its height.
double ContactManager::guard(std::size_t i, const Sample& sample) {
  if (!contacts_.in_force(i, sample.state))
    return height(contacts_[i], contacts_.gap(i, sample.inputs()).c, sample.state.t);
  const Evaluated& v = dynamics_.evaluate(sample.state);  // as push(), at both ends
  return -contacts_[i].sign * v.lambda[contacts_.row(i, v.rows)];
}

// The step may hide a hit if a body rotates far, or if a gap is closed at its largest rate.
void ContactManager::add_gaps(const State& end) {
  const auto is_free = [&](std::size_t i) { return contacts_.watched(i, end) && !contacts_.in_force(i, end); };
  std::size_t i = 0;
  while (i < contacts_.size() && !is_free(i)) ++i;
  if (i == contacts_.size()) return;
  const double t0 = interval_.from().t, h = end.t - t0;
  const bool is_short = finder_.is_short();  // which reads other inputs
  const Inputs& in = dynamics_.inputs(end);
  for (; i < contacts_.size(); ++i) {
    if (!is_free(i)) continue;
    const Contact& c = contacts_[i];
    const Gap gap = contacts_.gap(i, in);
    const double lowest = c.above(c.gap) ? std::min(c.gap.c, gap.c) : gap.c;
    const double from = c.leaves() ? c.gap.cd : height(c, std::max(c.gap.c, c.floor), t0);
    const bool near = !is_short || lowest - c.floor <= h * std::max(std::abs(c.gap.cd), std::abs(gap.cd));
    finder_.add({.owner = this,
                 .of = i,
                 .least = t0 + kNegligible * h,
                 .from = from,
                 .to = height(c, gap.c, end.t),
                 .inside = near});
  }
}

// Of links in contact that pull at the end. One that did so at the beginning is released there.
void ContactManager::add_pulls(const State& end) {
  bool any_in_force = false;
  for (std::size_t i = 0; i < contacts_.size(); ++i) any_in_force = any_in_force || contacts_.in_force(i, end);
  if (!any_in_force) return;
  const Solution& v = evaluate_pushes(end);
  const double limit =
      kNegligible * std::max(v.lambda.lpNorm<Eigen::Infinity>(), v.evaluation.force().lpNorm<Eigen::Infinity>());
  const double t0 = interval_.from().t, least = t0 + kNegligible * (end.t - t0);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Contact& c = contacts_[i];
    if (!contacts_.in_force(i, end) || !(c.push_now < -limit)) continue;
    const double at = c.push > 0 ? kNever : least;
    finder_.add({.owner = this, .of = i, .least = least, .from = c.push, .to = c.push_now, .at = at});
  }
}

void ContactManager::add_guards(const State& end) {
  contact_time_ = kNever, released_.clear();
  if (!contacts_.empty()) add_gaps(end), add_pulls(end);
}

bool ContactManager::meet(const State& end) {
  for (const Guard& g : finder_.guards()) {
    if (g.owner != this || !(g.at <= end.t)) continue;
    contact_time_ = end.t;
    if (contacts_.in_force(g.of, end)) released_.push_back(g.of);
  }
  return contact_time_ != kNever;
}

}  // namespace lockstep
