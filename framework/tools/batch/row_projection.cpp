// Projection of eight states onto their constraints, by the rule of dynamics/evaluate/projection.cpp for each copy; a
// copy that has converged does not move while others go on.
#include <algorithm>
#include <cmath>

#include "framework/dynamics/evaluate/projection_rule.h"
#include "framework/tools/batch/row_batch.h"

namespace lockstep::lanes {
namespace {

// Largest absolute value in each lane, over packs [first, first + width) of every `stride`.
Numbers8 largest(const double* y, std::size_t first, std::size_t stride, std::size_t width, int n_slots) {
  Numbers8 out{};
  for (std::size_t k = 0; k < static_cast<std::size_t>(n_slots); ++k)
    for (std::size_t i = 0; i < width; ++i)
      for (std::size_t l = 0; l < kL; ++l) out[l] = std::max(out[l], std::abs(y[kL * (first + stride * k + i) + l]));
  return out;
}

}  // namespace

void RowBatch::gather_rows(const double* y, const Numbers8& t) {
  z_.y = y;
  pass_.see_bodies(plan_, z_);
  fill_laws(y, t);
  pass_.project_rows(plan_, z_);
  rows_moved_ = true;
}

// M d + J^T z = 0, J d = -c in the wanted lanes, d = 0 in the others; `fresh`: factors first. The stop rule applies
// unless the rows are newer than the factor: then the caller iterates.
void RowBatch::solve_for(const double* c, const Flags8& wanted, bool fresh) {
  for (std::size_t i = 0; i < plan_.size_x; ++i)
    for (std::size_t l = 0; l < kL; ++l) {
      const double x = wanted[l] ? c[kL * i + l] : 0.0;
      x_[kL * i + l] = x, c_[kL * i + l] = -x, scale_[kL * i + l] = std::abs(x);
    }
  std::fill(a_.begin(), a_.end(), 0.0);
  if (fresh) {
    pass_.own_blocks(plan_, z_);
    pass_.factor_and_solve(plan_, z_);
    rows_moved_ = false;
  } else {
    pass_.solve(plan_, z_);
  }
  const int corrections = first_solution();
  if (rows_moved_) return;
  std::fill(af_.begin(), af_.end(), 0.0);
  check_rows(corrections);
}

// x += d, e <- e exp(d): (1.12).
void RowBatch::move(double* y) {
  for (std::size_t k = 0; k < static_cast<std::size_t>(plan_.n_slots); ++k)
    for (std::size_t l = 0; l < kL; ++l) {
      double* q = y + kL * 7 * k + l;
      const double* d = a_.data() + kL * 6 * k + l;
      for (std::size_t i = 0; i < 3; ++i) q[kL * i] += d[kL * i];
      const Quat e =
          Quat{q[3 * kL], q[4 * kL], q[5 * kL], q[6 * kL]} * exponential(Vec3(d[3 * kL], d[4 * kL], d[5 * kL]));
      q[3 * kL] = e.w, q[4 * kL] = e.x, q[5 * kL] = e.y, q[6 * kL] = e.z;
    }
}

void RowBatch::project(double* y, const Numbers8& t, const Flags8& wanted, std::array<Landing, kLanes>& landed) {
  landed.fill({});
  z_.y = y;
  pass_.see_bodies(plan_, z_);
  for (std::size_t k = 0; k < static_cast<std::size_t>(plan_.n_slots); ++k)
    std::copy_n(body_.data() + kL * (body::size * k + body::e), 4 * kL, y + kL * (7 * k + 3));
  if (plan_.nodes.empty()) return;
  if (stabilization_.kind != Stabilization::Kind::project) {
    gather_rows(y, t);
    pass_.norm(plan_, C_.data(), length_.data(), scratch_.data());
    for (std::size_t l = 0; l < kL; ++l) landed[l].before = landed[l].after = scratch_[l];
    return;
  }
  const bool factored = project_positions(y, t, wanted, landed);
  project_velocities(y, wanted, factored);
}

// True if the last factor can be used for the velocities.
bool RowBatch::project_positions(double* y, const Numbers8& t, const Flags8& wanted,
                                 std::array<Landing, kLanes>& landed) {
  const Numbers8 x_max = largest(y, 0, 7, 3, plan_.n_slots);
  const double tolerance = stabilization_.tolerance;
  std::array<PositionRounds, kLanes> rounds;
  for (std::size_t l = 0; l < kL; ++l) rounds[l] = {position_goal_of(tolerance), tolerance, length_[l], x_max[l]};
  Flags8 going = wanted;
  for (;;) {
    gather_rows(y, t);
    alignas(64) Numbers8 C;
    pass_.norm(plan_, C_.data(), length_.data(), C.data());
    const bool chord = next_round(C, rounds, going, landed);
    if (!any(going)) return chord;
    solve_for(C_.data(), going, !chord);
    move(y);
  }
}

void RowBatch::project_velocities(double* y, const Flags8& wanted, bool factored) {
  double* v = y + kL * plan_.v_at();
  const Numbers8 v_max = largest(v, 0, 6, 6, plan_.n_slots);
  for (int round = 0; round < kVelocityRounds; ++round) {
    pass_.velocity_residual(plan_, z_, v, Cd_.data());
    pass_.norm(plan_, Cd_.data(), length_.data(), scratch_.data());
    Flags8 going{};
    for (std::size_t l = 0; l < kL; ++l)
      going[l] = wanted[l] && !(scratch_[l] <= velocity_goal(velocity_goal_of(stabilization_.tolerance), v_max[l]));
    if (!any(going)) return;
    solve_for(Cd_.data(), going, !factored);
    factored = true;
    for (std::size_t i = 0; i < a_.size(); ++i) v[i] += a_[i];
  }
}

}  // namespace lockstep::lanes
