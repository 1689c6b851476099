// SPDX-License-Identifier: BSD-3-Clause
// Contact of one-sided joints: the impact, and which joints stay in contact or are released.
//
// Impact. With the touching rows that push, and all rows in force,
//
//   M dv + Jh^T z = 0,   Jh dv = target - Cd       z: impulses; Cd = Jh v + Ct before; target: e |Cd| away from the
//                                                  stop, 0 for a row that comes to rest and for all other rows
//   push = -(+-z) >= 0,   Cd+ >= target,   one of the two an equality      for every touching row
//
// Accelerations of the rows left at rest: the same with forces and C''. Both complementarity problems are solved by
// pivoting the first row that does not fit (Murty's least index), which is finite if the rows are independent.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include "framework/dynamics/simulate/contact_manager.h"
#include "framework/dynamics/simulate/keep_state.h"

namespace lockstep {
namespace {

constexpr double kNoise = 1e-10;  // relative to the largest impulse, speed, force or acceleration: less is rounding

std::uint64_t bit_of(std::size_t contact) { return contact < 64 ? std::uint64_t{1} << contact : 0; }

void add_name(std::string& names, const Lock& link) { names += (names.empty() ? "'" : ", '") + link.name() + "'"; }

}  // namespace

ContactManager::Settled ContactManager::settle(State& state) {
  Settled out;
  const bool here = state.t >= contact_time_;
  if (find_touching(state)) {
    modes_before_ = state.modes;
    for (const Touch& touch : touching_) {
      const bool hit = touch.gap.cd < -contacts_[touch.of].margin;
      out.impact = out.impact || hit;
      if (here && (hit || !contacts_.in_force(touch.of, state))) out.touched |= bit_of(touch.of);
    }
    if (out.impact) {
      pivot(state, "impulses", [&] { return find_kick(state); });
      take_impact(state);
    }
    out.resting = rest(state, here);
    out.restart = out.impact || state.modes != modes_before_;
  }
  out.restart = out.restart || here;
  contact_time_ = kNever;
  return out;
}

// Finds the contacts that touch and the gap rate that an impact has to leave each. False: there are none.
bool ContactManager::find_touching(const State& state) {
  touching_.clear();
  const Inputs& in = dynamics_.inputs(state);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (!contacts_.watched(i, state)) continue;
    const Contact& contact = contacts_[i];
    const bool holds = contacts_.in_force(i, state);
    const Gap g = contacts_.gap(i, in);
    if (!holds && contact.above(g)) continue;
    const double back = g.cd < -contact.margin ? -contact.restitution() * g.cd : 0.0;
    touching_.push_back({i, g, !holds && back >= contact.rest_speed() ? back : 0.0, holds || g.cd < 0});
  }
  return !touching_.empty();
}

void ContactManager::put_active(State& state) const {
  for (const Touch& touch : touching_) contacts_.put(touch.of, touch.active, state);
}

// Flips the first row that does not fit until all do. `misfit`: its place for these rows, or their number.
template <class Misfit>
void ContactManager::pivot(State& state, const char* what, const Misfit& misfit) {
  const std::size_t n_rows = touching_.size(), most = 20 + 10 * n_rows * n_rows;
  for (std::size_t n = 0;; ++n) {
    if (n == most) fail(state, what);
    put_active(state);
    const std::size_t k = misfit();
    if (k == n_rows) return;
    touching_[k].active = !touching_[k].active;
  }
}

// The change of velocity with the active rows; returns the first row that does not fit it.
std::size_t ContactManager::find_kick(const State& state) {
  const Evaluation& e = dynamics_.gather(state);
  const RowTable& rows = e.rows();
  impulse_.setZero(rows.n_rows);
  no_force_.setZero(state.v.size()), kick_.setZero(state.v.size());
  e.residuals(C_, Cd_);
  C_ = -Cd_;
  for (const Touch& touch : touching_)
    if (touch.active) C_[contacts_.row(touch.of, rows)] += contacts_[touch.of].sign * touch.aim;
  if (rows.n_rows > 0) dynamics_.factor(e).solve(e, no_force_, C_, kick_, impulse_);
  keep_state(state, trial_);
  trial_.v += kick_;
  const Inputs& in = dynamics_.inputs(trial_);
  double speed = 0;
  for (const Touch& touch : touching_) speed = std::max(speed, std::abs(touch.gap.cd));
  const double least = -kNoise * impulse_.lpNorm<Eigen::Infinity>();
  return first_misfit([&](const Touch& touch) {
    const int row = touch.active ? contacts_.row(touch.of, rows) : -1;
    return row >= 0 ? -contacts_[touch.of].sign * impulse_[row] >= least
                    : contacts_.gap(touch.of, in).cd >= touch.aim - kNoise * speed;
  });
}

// Applies v+ and counts its energy: an impulse z on a row takes z (Cd- + Cd+)/2, and laws give z Ct.
void ContactManager::take_impact(State& state) {
  const Evaluation& e = dynamics_.gather(state);
  const RowTable& rows = e.rows();
  for (const Touch& touch : touching_) {
    const Contact& contact = contacts_[touch.of];
    const int row = touch.active ? contacts_.row(touch.of, rows) : -1;
    if (row < 0) continue;
    state.z[contact.link->impact_memory()] += 0.5 * impulse_[row] * contact.sign * (touch.gap.cd + touch.aim);
  }
  const Evaluated impulses{e.inputs(), kick_, impulse_, rows};
  for (const auto& auxiliary : dynamics_.system().auxiliaries())
    auxiliary->impact(impulses, {state.s.data() + auxiliary->first(), static_cast<std::size_t>(auxiliary->size())});
  state.v += kick_;
  const Inputs& in = dynamics_.inputs(state);
  for (Touch& touch : touching_) touch.gap = contacts_.gap(touch.of, in);
}

// Of the contacts that touch without speed, those that push come into force; the others leave with C'' >= 0. Returns
// the names of those in force.
std::string ContactManager::rest(State& state, bool here) {
  for (Touch& touch : touching_) {
    Contact& contact = contacts_[touch.of];
    contacts_.put(touch.of, false, state);
    contact.leave(touch.gap);
    touch.active = touch.active && touch.aim == 0;
  }
  std::erase_if(touching_, [&](const Touch& touch) {
    return !touch.active && std::abs(touch.gap.cd) > contacts_[touch.of].margin;
  });
  for (Touch& touch : touching_)
    touch.active = touch.active && !(here && std::ranges::find(released_, touch.of) != released_.end());
  std::string names;
  if (touching_.empty()) return names;
  pivot(state, "forces", [&] {
    const Solution& v = dynamics_.evaluate(state);
    const double force = std::max(v.lambda.lpNorm<Eigen::Infinity>(), v.evaluation.force().lpNorm<Eigen::Infinity>());
    const double least = -kNoise * std::max(v.a.lpNorm<Eigen::Infinity>(), dynamics_.system().gravity().norm());
    return first_misfit([&](const Touch& touch) {
      const int row = touch.active ? contacts_.row(touch.of, v.rows) : -1;
      return row >= 0 ? -contacts_[touch.of].sign * v.lambda[row] >= -kNoise * force
                      : contacts_.gap_dd(touch.of, v) >= least;
    });
  });
  for (const Touch& touch : touching_)
    if (touch.active) add_name(names, *contacts_[touch.of].link);
  return names.empty() ? names : "the contact of joint " + names;
}

std::string ContactManager::who_was_touched(const LastSteps& steps) const {
  std::string names;
  bool several = false;
  long most = 0;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const long touched = steps.touched(bit_of(i));
    if (touched == 0 || 10 * touched < steps.n()) continue;
    several = !names.empty();
    most = std::max(most, touched);
    add_name(names, *contacts_[i].link);
  }
  if (names.empty()) return {};
  return fmt::format(
      "one-sided joint{} {} made or lost contact in {} of the last {} steps: a law may drive bodies against {}, or "
      "they are clamped; end the law before it, or remove {}",
      several ? "s" : "", names, most, steps.n(), several ? "them" : "it", several ? "one" : "it");
}

void ContactManager::fail(const State& state, const char* what) const {
  std::string names;
  for (const Touch& touch : touching_) add_name(names, *contacts_[touch.of].link);
  throw SolveError(
      fmt::format("t = {:.9g} s: no {} satisfy the one-sided joints {} in contact: they are redundant, or friction "
                  "jams them; remove one of them, or reduce the friction",
                  state.t, what, names));
}

}  // namespace lockstep
