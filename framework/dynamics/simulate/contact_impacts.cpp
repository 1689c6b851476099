// Contact of unilateral links: the impact, which links stay in contact and which are released.
//
// Impact. With the touching rows that push, and all rows in force,
//
//   M dv + Jh^T z = 0,   Jh dv = target - Cd       z: impulses; Cd = Jh v + Ct before; target: e |Cd| away from the
//                                                  stop, 0 for a row that comes to rest and for all other rows
//   push = -(+-z) >= 0,   Cd+ >= target,   one of the two an equality      for every touching row
//
// Accelerations of the rows left at rest: the same with forces and C''. Both complementarity problems are solved by
// pivoting the first row that does not fit (Murty's least index), which is finite where the rows are independent.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include "framework/dynamics/simulate/contact_manager.h"
#include "framework/dynamics/simulate/keep_state.h"

namespace lockstep {
namespace {

constexpr double kNoise = 1e-10;  // relative to the largest impulse, speed, force or acceleration: less is rounding

std::uint64_t bit_of(std::size_t contact) { return std::uint64_t{1} << contact % 64; }

}  // namespace

// What a row or a force throws leaves the state and the contacts as they were: they are settled when the run goes on.
ContactManager::Settled ContactManager::settle(State& state) {
  keep_state(state, before_), released_before_ = released_;
  clear_before_.clear();
  for (std::size_t i = 0; i < contacts_.size(); ++i) clear_before_.push_back(contacts_[i].clear);
  const double contact_time = contact_time_;
  try {
    return settle_all(state);
  } catch (...) {
    state = before_, released_ = released_before_, contact_time_ = contact_time;
    for (std::size_t i = 0; i < contacts_.size(); ++i) contacts_[i].clear = clear_before_[i];
    throw;
  }
}

ContactManager::Settled ContactManager::settle_all(State& state) {
  Settled out;
  const bool here = state.t >= contact_time_;
  if (!here) released_.clear();
  contact_time_ = std::numeric_limits<double>::infinity();
  if (!find_touching(state)) {
    for (std::size_t i = 0; i < contacts_.size(); ++i)
      contacts_[i].clear = contacts_[i].above(contacts_.gap(i, dynamics_.inputs(state)));
    out.restart = here;
    return out;
  }
  modes_before_ = state.modes;
  for (std::size_t k = 0; k < touching_.size(); ++k) {
    const bool hit = hits_[k].cd < -contacts_[touching_[k]].margin;
    out.impact = out.impact || hit;
    if (here && (hit || !contacts_.in_force(touching_[k], state))) out.touched |= bit_of(touching_[k]);
  }
  if (out.impact) {
    pivot(state, "impulses", [&] { return find_kick(state); });
    take_impact(state);
  }
  out.resting = rest(state);
  released_.clear();
  out.restart = here || out.impact || state.modes != modes_before_;
  return out;
}

// Finds the contacts that touch and the gap rate that an impact has to leave each. False: there are none.
bool ContactManager::find_touching(const State& state) {
  touching_.clear(), hits_.clear(), aim_.clear(), active_.clear();
  const Inputs& in = dynamics_.inputs(state);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (!contacts_.watched(i, state)) continue;
    const Contact& contact = contacts_[i];
    const bool holds = contacts_.in_force(i, state);
    const Gap g = contacts_.gap(i, in);
    if (!holds && contact.above(g)) continue;
    const double back = contact.clear && g.cd < 0 ? -contact.restitution() * g.cd : 0.0;
    touching_.push_back(i), hits_.push_back(g);
    aim_.push_back(!holds && back >= contact.rest_speed() ? back : 0.0);
    active_.push_back(holds || g.cd < 0);
  }
  return !touching_.empty();
}

void ContactManager::put_active(State& state) const {
  for (std::size_t k = 0; k < touching_.size(); ++k) contacts_.put(touching_[k], active_[k], state);
}

// Flips the first row that does not fit until all do. `misfit`: its place for these rows, or their number.
template <class Misfit>
void ContactManager::pivot(State& state, const char* what, const Misfit& misfit) {
  const std::size_t n_rows = active_.size(), most = 20 + 10 * n_rows * n_rows;
  for (std::size_t n = 0;; ++n) {
    if (n == most) fail(state, what);
    put_active(state);
    const std::size_t k = misfit();
    if (k == n_rows) return;
    active_[k] = !active_[k];
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
  for (std::size_t k = 0; k < touching_.size(); ++k)
    if (active_[k]) C_[contacts_.row(touching_[k], rows)] += contacts_[touching_[k]].sign * aim_[k];
  if (rows.n_rows > 0) dynamics_.factor(e).solve(e, no_force_, C_, kick_, impulse_);
  keep_state(state, trial_);
  trial_.v += kick_;
  const Inputs& in = dynamics_.inputs(trial_);
  double speed = 0;
  for (const Gap& g : hits_) speed = std::max(speed, std::abs(g.cd));
  const double least = rows.n_rows > 0 ? -kNoise * impulse_.lpNorm<Eigen::Infinity>() : 0.0;
  std::size_t k = 0;
  for (bool fits = true; k < touching_.size(); ++k) {
    const std::size_t i = touching_[k];
    if (const int row = active_[k] ? contacts_.row(i, rows) : -1; row >= 0)
      fits = -contacts_[i].sign * impulse_[row] >= least;
    else
      fits = contacts_.gap(i, in).cd >= aim_[k] - kNoise * speed;
    if (!fits) break;
  }
  return k;
}

// Applies v+ and counts its energy: an impulse z on a row takes z (Cd- + Cd+)/2, and laws give z Ct.
void ContactManager::take_impact(State& state) {
  const Evaluation& e = dynamics_.gather(state);
  const RowTable& rows = e.rows();
  for (std::size_t k = 0; k < touching_.size(); ++k) {
    if (!active_[k]) continue;
    const Contact& contact = contacts_[touching_[k]];
    const int row = contacts_.row(touching_[k], rows);
    if (row < 0) continue;
    state.z[contact.link->impact_memory()] += 0.5 * impulse_[row] * contact.sign * (hits_[k].cd + aim_[k]);
  }
  const Evaluated impulses{e.inputs(), kick_, impulse_, rows};
  for (const auto& auxiliary : dynamics_.system().auxiliaries())
    auxiliary->impact(impulses, {state.s.data() + auxiliary->first(), static_cast<std::size_t>(auxiliary->size())});
  state.v += kick_;
  const Inputs& in = dynamics_.inputs(state);
  for (std::size_t k = 0; k < touching_.size(); ++k) hits_[k] = contacts_.gap(touching_[k], in);
}

// Of the contacts that touch without speed, those that push come into force; the others leave with C'' >= 0. Returns
// the names of those in force.
std::string ContactManager::rest(State& state) {
  std::size_t n = 0;
  for (std::size_t k = 0; k < touching_.size(); ++k) {
    const std::size_t i = touching_[k];
    const bool holds = active_[k] && aim_[k] == 0, still = std::abs(hits_[k].cd) <= contacts_[i].margin;
    contacts_.put(i, false, state);
    contacts_[i].leave(hits_[k]);
    if (!holds && !still) continue;
    touching_[n] = i, hits_[n] = hits_[k];
    active_[n++] = holds && std::find(released_.begin(), released_.end(), i) == released_.end();
  }
  touching_.resize(n), hits_.resize(n), active_.resize(n);
  std::string names;
  if (n == 0) return names;
  pivot(state, "forces", [&] {
    const Solution& v = dynamics_.evaluate(state);
    const double force = std::max(v.lambda.size() > 0 ? v.lambda.lpNorm<Eigen::Infinity>() : 0.0,
                                  v.evaluation.force().lpNorm<Eigen::Infinity>());
    const double a = v.a.size() > 0 ? v.a.lpNorm<Eigen::Infinity>() : 0.0;
    const double least = -kNoise * std::max(a, dynamics_.system().gravity().norm());
    std::size_t k = 0;
    for (; k < n; ++k) {
      const std::size_t i = touching_[k];
      const int row = active_[k] ? contacts_.row(i, v.rows) : -1;
      if (row >= 0 ? !(-contacts_[i].sign * v.lambda[row] >= -kNoise * force) : !(contacts_.gap_dd(i, v) >= least))
        break;
    }
    return k;
  });
  for (std::size_t k = 0; k < n; ++k)
    if (active_[k]) names += (names.empty() ? "the contact of link '" : "', '") + contacts_[touching_[k]].link->name();
  if (!names.empty()) names += "'";
  return names;
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
    names += (names.empty() ? "'" : "', '") + contacts_[i].link->name();
  }
  if (names.empty()) return {};
  return fmt::format(
      "one-sided link{} touched or let go in {} of the last {} steps: a law may drive bodies on against {}, or they "
      "have no way left; let the law end there, give them way, or remove {}",
      several ? fmt::format("s {}' were", names) : fmt::format(" {}' was", names), most, steps.n(),
      several ? "them" : "it", several ? "one" : "it");
}

void ContactManager::fail(const State& state, const char* what) const {
  std::string names;
  for (const std::size_t i : touching_) names += (names.empty() ? "'" : "', '") + contacts_[i].link->name();
  throw SolveError(
      fmt::format("t = {:.9g} s: there are no {} with which the one-sided links {}' that touch here only push; they "
                  "hold the same motion several times, or friction in them jams: remove one of them, or reduce the "
                  "friction",
                  state.t, what, names));
}

}  // namespace lockstep
