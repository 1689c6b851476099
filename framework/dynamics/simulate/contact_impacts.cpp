// What happens where one-sided links touch: the impact, who comes to rest, who lets go.
//
// Impact. With the touching rows that push, and all rows in force,
//
//   M dv + Jh^T z = 0,   Jh dv = target - Cd      z: impulses; Cd = Jh v + Ct before; target: e |Cd| away from the
//                                                 stop, 0 for a row that comes to rest and for all other rows
//   push = -(+-z) >= 0,   Cd+ >= target,   one of the two an equality      for every touching row
//
// Acceleration, of those that are left at rest: the same with forces and C''. Both complementarities are solved by
// pivoting the first row that does not fit (Murty's least index), finite where the rows are independent.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "framework/dynamics/simulate/simulation_loop.h"
#include "framework/foundation/support/error.h"

namespace lockstep {
namespace {

constexpr double kNoise = 1e-10;  // of the largest impulse, speed, force or acceleration: what is less is rounding

std::size_t most_pivots(std::size_t n) { return 20 + 10 * n * n; }

}  // namespace

void Simulation::Loop::settle_contacts() {
  const bool here = sim.state_.t >= contact_time;
  if (!here) released.clear();
  contact_time = std::numeric_limits<double>::infinity();
  if (!find_touching()) {
    for (std::size_t i = 0; i < contacts.size(); ++i)
      contacts[i].clear = contacts[i].above(contacts.gap(i, sim.dynamics_.look(sim.state_)));
    if (here) begin_method();
    return;
  }
  modes_before = sim.state_.modes;
  bool approaching = false;
  for (std::size_t k = 0; k < touching.size(); ++k)
    approaching = approaching || hits[k].cd < -contacts[touching[k]].margin;
  if (approaching) impact();
  rest();
  if (approaching) sim.dynamics_.accept(sim.state_);  // counted turns go on at the new speeds
  released.clear();
  if (here || approaching || sim.state_.modes != modes_before) begin_method();
}

// Who touches, and what an impact is to leave of its speed. False: nobody.
bool Simulation::Loop::find_touching() {
  const State& state = sim.state_;
  touching.clear(), hits.clear(), aim.clear(), active.clear();
  const Inputs& in = sim.dynamics_.look(state);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (!contacts.watched(i, state)) continue;
    const Contact& contact = contacts[i];
    const bool holds = contacts.in_force(i, state);
    const Gap g = contacts.gap(i, in);
    if (!holds && contact.above(g)) continue;
    const double back = contact.clear && g.cd < 0 ? -contact.restitution() * g.cd : 0.0;
    touching.push_back(i), hits.push_back(g);
    aim.push_back(!holds && back >= contact.rest_speed() ? back : 0.0);
    active.push_back(holds || g.cd < 0);
  }
  return !touching.empty();
}

void Simulation::Loop::put_active() {
  for (std::size_t k = 0; k < touching.size(); ++k) contacts.put(touching[k], active[k], sim.state_);
}

void Simulation::Loop::impact() {
  bool fits = false;
  for (std::size_t n = 0; !fits; ++n) {
    if (n == most_pivots(touching.size())) blame_contacts("impulses");
    std::size_t misfit = 0;
    kick_with(fits, misfit);
    if (!fits) active[misfit] = !active[misfit];
  }
  take_impact();
}

// The velocities after it with the rows that are active, and the first row that does not fit to them.
void Simulation::Loop::kick_with(bool& fits, std::size_t& misfit) {
  Dynamics& dynamics = sim.dynamics_;
  put_active();
  dynamics.gather(sim.state_);
  const RowTable& rows = dynamics.rows();
  C.setZero(rows.n_rows), Cd.setZero(rows.n_rows), impulse.setZero(rows.n_rows);
  no_force.setZero(sim.state_.v.size()), kick.setZero(sim.state_.v.size());
  dynamics.residuals(C, Cd);
  C = -Cd;
  for (std::size_t k = 0; k < touching.size(); ++k)
    if (active[k]) C[contacts.row(touching[k], rows)] += contacts[touching[k]].sign * aim[k];
  if (rows.n_rows > 0) dynamics.solve(no_force, C, kick, impulse);
  trial = sim.state_;
  trial.v += kick;
  const Inputs& in = dynamics.look(trial);
  double speed = 0;
  for (const Gap& g : hits) speed = std::max(speed, std::abs(g.cd));
  const double least = rows.n_rows > 0 ? -kNoise * impulse.lpNorm<Eigen::Infinity>() : 0.0;
  fits = true;
  for (std::size_t k = 0; k < touching.size() && fits; ++k) {
    const std::size_t i = touching[k];
    if (const int row = active[k] ? contacts.row(i, rows) : -1; row >= 0)
      fits = -contacts[i].sign * impulse[row] >= least;
    else
      fits = contacts.gap(i, in).cd >= aim[k] - kNoise * speed;
    misfit = k;
  }
}

// v+ and the energy that it cost: an impulse z on a row takes z (Cd- + Cd+)/2, and laws give z Ct.
void Simulation::Loop::take_impact() {
  Dynamics& dynamics = sim.dynamics_;
  dynamics.gather(sim.state_);
  const RowTable& rows = dynamics.rows();
  for (std::size_t k = 0; k < touching.size(); ++k) {
    if (!active[k]) continue;
    const Contact& contact = contacts[touching[k]];
    const int row = contacts.row(touching[k], rows);
    if (row < 0) continue;
    sim.state_.z[contact.link->impact_memory()] += 0.5 * impulse[row] * contact.sign * (hits[k].cd + aim[k]);
  }
  const Evaluated impulses{dynamics.inputs(), kick, impulse, rows};
  for (const auto& auxiliary : sim.system().auxiliaries())
    auxiliary->impact(impulses,
                      {sim.state_.s.data() + auxiliary->first(), static_cast<std::size_t>(auxiliary->size())});
  sim.state_.v += kick;
  const Inputs& in = dynamics.look(sim.state_);
  for (std::size_t k = 0; k < touching.size(); ++k) hits[k] = contacts.gap(touching[k], in);
  ++sim.report_.impacts;
}

// Those that touch without a speed: the ones that push are in force, the others leave with C'' >= 0.
void Simulation::Loop::rest() {
  Dynamics& dynamics = sim.dynamics_;
  std::size_t n = 0;
  for (std::size_t k = 0; k < touching.size(); ++k) {
    const std::size_t i = touching[k];
    const bool holds = active[k] && aim[k] == 0, still = std::abs(hits[k].cd) <= contacts[i].margin;
    contacts.put(i, false, sim.state_);
    contacts[i].leave(hits[k]);
    if (!holds && !still) continue;
    touching[n] = i, hits[n] = hits[k];
    active[n++] = holds && std::find(released.begin(), released.end(), i) == released.end();
  }
  touching.resize(n), hits.resize(n), active.resize(n);
  if (n == 0) return;
  bool fits = false;
  for (std::size_t pivots = 0; !fits; ++pivots) {
    if (pivots == most_pivots(n)) blame_contacts("forces");
    put_active();
    const Evaluated& v = dynamics.evaluate(sim.state_);
    const double force = std::max(v.lambda.size() > 0 ? v.lambda.lpNorm<Eigen::Infinity>() : 0.0,
                                  dynamics.force().lpNorm<Eigen::Infinity>());
    const double a = v.a.size() > 0 ? v.a.lpNorm<Eigen::Infinity>() : 0.0;
    fits = true;
    for (std::size_t k = 0; k < n && fits; ++k) {
      const std::size_t i = touching[k];
      const int row = active[k] ? contacts.row(i, v.rows) : -1;
      fits = row >= 0 ? -contacts[i].sign * v.lambda[row] >= -kNoise * force
                      : contacts.gap_dd(i, v) >= -kNoise * std::max(a, sim.system().gravity().norm());
      if (!fits) active[k] = !active[k];
    }
  }
  std::string names;
  for (std::size_t k = 0; k < n; ++k)
    if (active[k]) names += (names.empty() ? "the rest of link '" : "', '") + contacts[touching[k]].link->name();
  if (!names.empty()) make_consistent(names + "'");
}

void Simulation::Loop::blame_contacts(const char* what) const {
  std::string names;
  for (const std::size_t i : touching) names += (names.empty() ? "'" : "', '") + contacts[i].link->name();
  throw SolveError(
      fmt::format("t = {:.9g} s: no {} of the one-sided links {}' that touch here push all of them and pull none; they "
                  "hold one thing several times, or friction in them jams: take one of them out, or make the friction "
                  "smaller",
                  sim.state_.t, what, names));
}

}  // namespace lockstep
