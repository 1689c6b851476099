// The rows of a link over full turns: C changes by what its jacobian says, past every half turn.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "framework/tools/check/lock_check.h"
#include <lockstep/relative.h>

namespace lockstep {

// Three turns of P about z of S in steps: what C changes by has to be what its jacobian says.
void LockCheck::turns() {
  for (const auto& [p, s] : link_.pairs()) turn_about_z(*p, *s);
}

void LockCheck::turn_about_z(const Marker& p, const Marker& s) {
  const bool move_p = p.body->slot != kGround;
  const int slot = move_p ? p.body->slot : s.body->slot;
  if (slot == kGround || system_.slot(slot).freedoms == Freedoms::particle) return;
  constexpr int kSteps = 300;
  const double step = 3 * kTwoPi / kSteps;
  state_ = -1;
  Place on = home_of(system_, options_.from);
  const Motion home = on.slot(slot);
  const MarkerInWorld S = in_world(MarkerFrame(s), on.in());
  const Vec3 axis = (move_p ? 1.0 : -1.0) * S.A.col(2);
  const auto put = [&](double angle) {
    Motion& O = on.slot(slot);
    const Quat turn = axis_angle(axis, angle);
    O.x = S.x + rotation(turn) * (home.x - S.x);
    O.e = turn * home.e;
    O.A = rotation(O.e);
  };
  LockRows r;
  const auto rates = [&](VecX& out) {  // dC/dangle by the jacobian
    const Motion& O = on.slot(slot);
    out = r.J.middleCols<3>(6 * slot) * cross(axis, Vec3(O.x - S.x)) +
          r.J.middleCols<3>(6 * slot + 3) * (O.A.transpose() * axis);
  };
  VecX C, rate, rate_before, z_before;
  MatX off(m_, kSteps);
  std::vector<VecX> memories;
  for (int i = 0; i <= kSteps; ++i) {
    put(i * step);
    bench_.rows(on, r);
    if (!r.C.allFinite() || !r.J.allFinite()) return;
    const VecX C_before = C;
    rate_before = rate, C = r.C;
    rates(rate);
    if (i > 0) off.col(i - 1) = (C - C_before - 0.5 * step * (rate_before + rate)).cwiseAbs();
    memories.push_back(on.z);
    VecX z = on.z;
    accept_step(on, z);
    on.z = z;
  }
  for (int k = 0; k < m_; ++k) {
    int worst = 0;
    const double most = off.row(k).maxCoeff(&worst);
    std::vector<double> sorted(kSteps);
    for (int i = 0; i < kSteps; ++i) sorted[static_cast<std::size_t>(i)] = off(k, i);
    std::nth_element(sorted.begin(), sorted.begin() + kSteps / 2, sorted.end());
    if (!(most > 1e-6 && most > 20 * sorted[kSteps / 2])) continue;
    // a jump stays what it is in a step 64 times smaller; beside an angle that is not counted on the jacobian does not
    // change, beside another point of a curve it does
    on.z = memories[static_cast<std::size_t>(worst)];
    double jump = 0, bend = 0;
    LockRows before;
    for (int i = 0; i <= 64; ++i) {
      put((worst + i / 64.0) * step);
      bench_.rows(on, r);
      if (i > 0 && std::abs(r.C[k] - before.C[k]) > jump) {
        jump = std::abs(r.C[k] - before.C[k]);
        bend = (r.J.row(k) - before.J.row(k)).norm() / r.J.row(k).norm();
      }
      before = r;
      VecX z = on.z;
      accept_step(on, z);
      on.z = z;
    }
    if (jump < 0.5 * most) continue;
    const std::string what =
        fmt::format("{} jumps by {:.3g} where '{}' has turned by {:.0f} degrees about z of '{}'", row(k), jump,
                    move_p ? p.name : s.name, (worst + 0.5) * step * 180 / kPi, s.name);
    if (bend > 0.01) {
      report_.note(what + ", far off the constraint, and its jacobian with it: it passes to another place there");
      continue;
    }
    add("turns", what,
        link_.n_own_memory() > 0
            ? "accept_step() and start_memory(): the angle at the last accepted step is remembered in z"
            : "its angles: kCountsTurns = true and y.angle_z(), so that they run on past a full turn");
  }
}

}  // namespace lockstep
