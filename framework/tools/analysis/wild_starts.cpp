#include "framework/tools/analysis/wild_starts.h"

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>

namespace lockstep {
namespace {

bool fit_newton(Dynamics& dynamics, State& state) {
  constexpr int kRounds = 60;
  constexpr double kFits = 1e-12, kShortest = 1e-3;
  const double goal = kFits * std::max(1.0, dynamics.system().length());
  VecX C, Cd, d, lambda;
  const VecX zero = VecX::Zero(state.v.size());
  const auto residual = [&] {
    const Evaluation& e = dynamics.gather_rows(state);
    e.residuals(C, Cd);
    return e.norm(C);
  };
  double now = residual();
  for (int round = 0; round < kRounds && now > goal; ++round) {
    const Evaluation& e = dynamics.gather_rows(state);
    dynamics.factor(e).solve(e, zero, VecX(-C), d, lambda);
    if (!d.allFinite()) return false;
    const State from = state;
    double next = now;
    for (double share = 1; share > kShortest; share *= 0.5) {
      state = from;
      advance_state(state, share, d);
      normalize_state(state);
      next = residual();
      if (next < now) break;
    }
    if (!(next < 0.999 * now)) return next < 1e2 * goal;
    now = next;
  }
  return now <= goal;
}

}  // namespace

Vec3 Scatter::vector(double size) {
  const double x = number(size), y = number(size), z = number(size);
  return {x, y, z};
}

void scatter(const System& system, double size, Scatter& random, State& state) {
  const Plane plane = system.plane();
  for (int k = 0; k < system.n_slots(); ++k) {
    Pose pose = state.slot_pose(k);
    Vec3 move = random.vector(size), turn = random.vector(kPi);
    if (plane) {
      move[plane.n] = 0;
      turn = turn[plane.n] * Vec3::Unit(plane.n);
    }
    pose.x += move;
    if (system.slot(k).freedoms == Freedoms::spatial) pose.q = normalized(pose.q * exponential(turn));
    state.set_slot_pose(k, pose);
  }
}

bool fit(Dynamics& dynamics, State& state) {
  try {
    return fit_newton(dynamics, state);
  } catch (const SolveError&) {
  } catch (const NonFiniteError&) {
  }
  return false;
}

double apart(const System& system, const State& a, const State& b, std::string& body) {
  double most = 0;
  for (int k = 0; k < system.n_slots(); ++k) {
    const Pose p = a.slot_pose(k), q = b.slot_pose(k);
    const double turn = system.slot(k).freedoms == Freedoms::spatial
                            ? rotation_vector(conjugate(normalized(p.q)) * normalized(q.q)).norm()
                            : 0.0;
    if (const double d = std::max((p.x - q.x).norm(), system.length() * turn); d > most)
      most = d, body = system.body_of_slot(k).name;
  }
  return most;
}

}  // namespace lockstep
