#include "framework/tools/precision/history.h"

#include <algorithm>
#include <cmath>

#include "framework/mechanism/rows/loads.h"

namespace lockstep {
namespace {

Quat turn_of(const VecX& q, Eigen::Index slot) { return Quat::from(q.segment<4>(7 * slot + 3)); }

}  // namespace

void HistoryObserver::output(const Sample& s) {
  const double begin = cpu_();
  const long before = s.dynamics().work().evaluations;
  State slots = s.state;
  s.dynamics().to_slots(slots);
  to_.t.push_back(slots.t), to_.q.push_back(slots.q), to_.v.push_back(slots.v);
  to_.energy.push_back(energy_.value(s)), to_.kinetic.push_back(kinetic_.value(s));
  const Evaluated& values = s.values();
  subtract_reactions(values.rows, values.lambda, to_.load.emplace_back(VecX::Zero(slots.v.size())));
  evaluations_ += s.dynamics().work().evaluations - before;
  spent_ += cpu_() - begin;
}

HistoryError difference(const History& a, const History& b, double length) {
  HistoryError e;
  const auto take = [](double& most, double x) { most = std::isfinite(x) ? std::max(most, x) : HUGE_VAL; };
  if (a.t.size() != b.t.size()) return {HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL};
  for (std::size_t i = 0; i < a.t.size(); ++i) {
    for (Eigen::Index k = 0; k < a.v[i].size() / 6; ++k) {
      take(e.position, (a.q[i].segment<3>(7 * k) - b.q[i].segment<3>(7 * k)).norm());
      const Quat between = conjugate(turn_of(b.q[i], k)) * turn_of(a.q[i], k);
      take(e.position, length * 2.0 * std::atan2(between.vec().norm(), std::abs(between.w)));
      take(e.velocity, (a.v[i].segment<3>(6 * k) - b.v[i].segment<3>(6 * k)).norm());
      take(e.velocity, length * (a.v[i].segment<3>(6 * k + 3) - b.v[i].segment<3>(6 * k + 3)).norm());
      take(e.reaction, (a.load[i].segment<3>(6 * k) - b.load[i].segment<3>(6 * k)).norm());
      take(e.reaction, (a.load[i].segment<3>(6 * k + 3) - b.load[i].segment<3>(6 * k + 3)).norm() / length);
    }
    take(e.energy, std::abs(a.energy[i] - b.energy[i]));
  }
  return e;
}

HistoryError size_of(const History& h, double length) {
  History still;
  const std::size_t n = h.t.size();
  const VecX none = VecX::Zero(h.v.front().size());
  still.t = h.t, still.energy.assign(n, h.energy.front()), still.q.assign(n, h.q.front());
  still.v.assign(n, none), still.load.assign(n, none);
  HistoryError size = difference(h, still, length);
  for (const double kinetic : h.kinetic) size.energy = std::max(size.energy, kinetic);
  return size;
}

}  // namespace lockstep
