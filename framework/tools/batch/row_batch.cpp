#include "framework/tools/batch/row_batch.h"

#include <algorithm>
#include <cmath>

#include <lockstep/body.h>
#include <lockstep/lock.h>
#include "framework/dynamics/solvers/graph.h"
#include "framework/dynamics/solvers/schur_floors.h"
#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/tools/batch/link_numbers.h"

namespace lockstep::lanes {

RowBatch::RowBatch(std::span<System* const> systems, int first, const CopiesOptions& options)
    : Batch(systems, first, 7 * static_cast<std::size_t>(systems[0]->n_slots()),
            6 * static_cast<std::size_t>(systems[0]->n_slots()), options),
      stabilization_(options.stabilization),
      plan_(make_plan(*systems[0])) {
  const auto n = static_cast<std::size_t>(plan_.n_slots), x = plan_.size_x;
  const auto size = [](Aligned<double>& v, std::size_t packs) { return v.assign(kL * packs, 0.0), v.data(); };
  z_.gravity = size(gravity_, 3), z_.frames = size(frames_, plan_.size_frames), z_.law = size(law_, plan_.size_law);
  z_.mass = size(mass_, schur::Spatial::mass * n), z_.inverse = size(inverse_, schur::Spatial::mass * n);
  z_.body = size(body_, body::size * (n + 1)), z_.af = size(af_, 6 * n), z_.a = size(a_, 6 * n);
  z_.rows = z_.J = size(J_, plan_.size_Y), z_.Y = size(Y_, plan_.size_Y), z_.A = size(A_, plan_.size_A);
  z_.x = size(x_, x), z_.c = size(c_, x), z_.scale = size(scale_, x), z_.diagonal = size(diagonal_, x);
  z_.p = size(p_, x), z_.E = size(E_, x), z_.r = size(r_, x), z_.C = size(C_, x), z_.Ct = size(Ct_, x);
  size(Cd_, x), size(length_, 1);
  z_.floors = floors_.data();
  z_.eps = plan_.tree ? 0.0 : kClosureProximal;
  for (std::size_t l = 0; l < kL; ++l) length_[l] = systems_[l]->length();
  if (has_forces_) z_.wrench = wrench_.data();
  fill_masses();
  fill_frames();
}

void RowBatch::fill_masses() {
  for (int l = 0; l < kLanes; ++l) {
    const System& system = *systems_[l];
    put_numbers(gravity_, 0, l, system.gravity());
    for (int k = 0; k < plan_.n_slots; ++k) {
      double mass[schur::Spatial::mass] = {}, inverse[schur::Spatial::mass] = {};
      BodyMass(system.slot(k), {}).write_packed(mass, inverse);
      for (std::size_t i = 0; i < schur::Spatial::mass; ++i) {
        put_number(mass_, schur::Spatial::mass * k + i, l, mass[i]);
        put_number(inverse_, schur::Spatial::mass * k + i, l, inverse[i]);
      }
    }
    const std::size_t ground = body::size * static_cast<std::size_t>(plan_.n_slots);
    put_matrix(body_, ground + body::A, l, Mat3::Identity());
    put_number(body_, ground + body::e, l, 1.0);
  }
}

void RowBatch::fill_frames() {
  for (Link& node : plan_.links) {
    has_laws_ = has_laws_ || node.has_laws();
    for (int l = 0; l < kLanes; ++l) put_frames(lock(l, node), l, node, frames_);
  }
}

void RowBatch::fill_laws(const double* y, const Numbers8& t) {
  if (!has_laws_) return;
  for (int l = 0; l < kLanes; ++l) {
    const Inputs in = inputs(l, y, t[static_cast<std::size_t>(l)]);
    guarded(l, [&] {
      for (const Link& node : plan_.links)
        if (node.has_laws()) put_laws(lock(l, node), l, node, in, law_);
    });
  }
}

void RowBatch::read_motion(int lane, int slot, Motion& O) const {
  const double* b = body_.data() + kL * body::size * static_cast<std::size_t>(slot) + static_cast<std::size_t>(lane);
  const auto at = [&](std::size_t i) { return b[kL * i]; };
  for (std::size_t i = 0; i < 3; ++i) {
    const auto r = static_cast<Eigen::Index>(i);
    O.x[r] = at(body::x + i), O.v[r] = at(body::v + i), O.w[r] = at(body::w + i);
    for (std::size_t j = 0; j < 3; ++j) O.A(r, static_cast<Eigen::Index>(j)) = at(body::A + 3 * i + j);
  }
  O.e = {at(body::e), at(body::e + 1), at(body::e + 2), at(body::e + 3)};
}

// ------------------------------------------------------------------------------------------------------ evaluation

Flags8 RowBatch::evaluate(const double* y, const Numbers8& t, double* rate) {
  z_.y = y, lost_ = {};
  pass_.see_bodies(plan_, z_);
  fill_laws(y, t);
  fill_wrench(y, t);
  pass_.free_motion(plan_, z_);
  pass_.accelerate_rows(plan_, z_);
  pass_.factor_and_solve(plan_, z_);
  const int corrections = first_solution();
  Flags8 unmet = check_rows(corrections);
  pass_.rates(plan_, z_, rate);
  state_rates(y, t, rate);
  if (watches_) see_pivots();
  for (std::size_t l = 0; l < kL; ++l) unmet[l] = unmet[l] || lost_[l];
  return unmet;
}

void RowBatch::watch_pivots() { watches_ = has_loops(*systems_[0], systems_[0]->start().modes); }

void RowBatch::see_pivots() {
  for (std::size_t l = 0; l < kL && !floors_known_; ++l) {
    const auto of_lane = [&](const double* numbers) { return [=](std::size_t i) { return numbers[kL * i + l]; }; };
    const auto floors = schur::measure_pivot_floors(plan_, of_lane(E_.data()), of_lane(J_.data()));
    for (std::size_t k = 0; k < floors.size(); ++k) pivot_floors_[kL * k + l] = floors[k];
  }
  floors_known_ = true;
  pass_.pivots(plan_, z_, pivot_floors_.data(), pivots_.data());
}

// a from x = lambda, and the one correction that closed loops always need; returns the number of corrections.
int RowBatch::first_solution() {
  pass_.apply(plan_, z_);
  if (z_.eps == 0) return 0;
  for (std::size_t i = 0; i < x_.size(); ++i) x_[i] *= E_[i];  // r = E lambda, known without a residual
  pass_.solve(plan_, z_);
  pass_.apply(plan_, z_);
  return 1;
}

// The stop rule per copy; all copies are corrected while one of them needs it.
Flags8 RowBatch::check_rows(int corrections) {
  alignas(64) std::array<double, 3 * kL> largest;
  pass_.largest_scales(plan_, z_, largest.data());
  for (std::size_t i = 0; i < largest.size(); ++i) floors_[i] = residual_floor(largest[i]);
  bool raised = false;
  const auto measure = [&] { pass_.residual(plan_, z_); };
  const auto within = [&] {
    pass_.unmet(plan_, z_, kRowTolerance, unmet_.data());
    return std::none_of(unmet_.begin(), unmet_.begin() + n_, [](double x) { return x != 0; });
  };
  const auto raise = [&] {
    if (raised) return false;
    alignas(64) std::array<double, 4 * kL> S;  // followed by the energy
    pass_.energies(plan_, z_, S.data());
    for (std::size_t i = 0; i < largest.size(); ++i) floors_[i] = residual_floor(largest[i], S[i], S[3 * kL + i % kL]);
    return raised = true;
  };
  const auto corrected = [&] {
    std::copy(r_.begin(), r_.end(), x_.begin());
    pass_.solve(plan_, z_);
    pass_.apply(plan_, z_);
  };
  refine(corrections, measure, within, raise, corrected);  // a copy that needs more goes on alone
  Flags8 out{};
  for (std::size_t l = 0; l < kL; ++l) out[l] = unmet_[l] != 0;
  return out;
}

}  // namespace lockstep::lanes
