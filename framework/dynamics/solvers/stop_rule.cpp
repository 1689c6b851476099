// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/solvers/stop_rule.h"

namespace lockstep {

namespace {

// The unit of an unknown: 0 for the first three of a slot (m/s^2, N), 1 for the others.
template <class Visit>
void for_each_unknown(const KktPattern& pattern, Visit&& visit) {
  for_each_mass(pattern, [&](int first, int width, std::size_t) {
    for (int i = 0; i < width; ++i) visit(first + i, static_cast<std::size_t>(i < 3 ? 0 : 1));
  });
}

}  // namespace

void StopRule::analyse(const KktPattern& pattern, double eps) {
  eps_ = eps;
  for (VecX* v : {&r_f_, &size_n_, &da_, &zero_}) v->setZero(pattern.n);
  for (VecX* v : {&r_c_, &scale_, &S_, &dl_}) v->setZero(pattern.m);
  gradients_.size(pattern.m);
}

void StopRule::start(const Kkt& kkt, const VecX& f, const VecX& c) {
  VecX& a_f = size_n_;
  a_f.setZero();
  add_mass_times(kkt.pattern, kkt.Minv, f, a_f);
  energy_f_ = 0.0;
  for_each_mass(kkt.pattern, [&](int first, int width, std::size_t) {
    energy_f_ = std::max(energy_f_, f.segment(first, width).dot(a_f.segment(first, width)));
  });
  scale_.setZero();
  add_rows_times(kkt, a_f, scale_);
  scale_ = scale_.cwiseAbs() + c.cwiseAbs();

  largest_scale_ = {};
  for_each_row(kkt.pattern,
               [&](int j, std::size_t kind) { largest_scale_[kind] = std::max(largest_scale_[kind], scale_[j]); });
  for (std::size_t k = 0; k < 3; ++k) floors_[k] = residual_floor(largest_scale_[k]);
  largest_ = std::numeric_limits<double>::infinity();
}

bool StopRule::met(const Kkt& kkt, const VecX& f, const VecX& c, const VecX& a, const VecX& lambda) {
  measure(kkt, f, c, a, lambda);
  return within(kkt.pattern) || (raise_floors(kkt, a) && within(kkt.pattern));
}

void StopRule::measure(const Kkt& kkt, const VecX& f, const VecX& c, const VecX& a, const VecX& lambda) {
  before_ = largest_;
  r_c_.setZero();
  add_rows_times(kkt, a, r_c_);
  r_c_ = c - r_c_;
  forces_met_ = forces_met(kkt, f, a, lambda);
}

bool StopRule::raise_floors(const Kkt& kkt, const VecX& a) {
  if (largest_ <= kRowTolerance) return false;
  double energy = 0.0;
  for_each_mass(kkt.pattern, [&](int first, int width, std::size_t at) {
    energy = std::max(energy, quadratic_form(kkt.M.data() + at, a.data() + first, width));
  });
  std::array<double, 3> S{};
  row_diagonal(kkt, S_);
  for_each_row(kkt.pattern, [&](int j, std::size_t kind) { S[kind] = std::max(S[kind], S_[j]); });
  for (std::size_t k = 0; k < 3; ++k) floors_[k] = residual_floor(largest_scale_[k], S[k], energy + energy_f_);
  return true;
}

// Finds the worst row. A NaN counts as worst, and stays.
bool StopRule::within(const KktPattern& pattern) {
  largest_ = 0.0;
  worst_row_ = -1;
  for_each_row(pattern, [&](int j, std::size_t kind) {
    const double r = std::abs(r_c_[j]);
    const double relative = r == 0.0 ? 0.0 : r / std::max(scale_[j], floors_[kind]);
    if (worst_row_ >= 0 && (relative <= largest_ || std::isnan(largest_))) return;
    largest_ = relative, worst_row_ = j;
  });
  return largest_ <= kRowTolerance && forces_met_;
}

bool StopRule::differ_in_mass(const Kkt& kkt) {
  double lightest = HUGE_VAL, heaviest = 0;
  for_each_mass(kkt.pattern, [&](int, int, std::size_t at) {
    lightest = std::min(lightest, kkt.M[at]), heaviest = std::max(heaviest, kkt.M[at]);
  });
  gradients_.set(eps_, lightest / heaviest);
  return gradients_.needed();
}

// a <- a - length M^-1 J^T lambda
void StopRule::add_reaction_of(const Kkt& kkt, double length, const VecX& lambda, VecX& a) {
  VecX& force = size_n_;
  force.setZero();
  subtract_rows_transposed_times(kkt, lambda, force);
  force *= length;
  add_mass_times(kkt.pattern, kkt.Minv, force, a);
}

// r = f - M a - J^T lambda, relative to the size of its terms, with the same floor per unit as the rows.
bool StopRule::forces_met(const Kkt& kkt, const VecX& f, const VecX& a, const VecX& lambda) {
  r_f_.setZero();
  add_mass_times(kkt.pattern, kkt.M, a, r_f_);
  r_f_ = f - r_f_;
  subtract_rows_transposed_times(kkt, lambda, r_f_);
  size_n_ = f.cwiseAbs();
  add_sizes_of_mass_times(kkt.pattern, kkt.M, a, size_n_);
  add_sizes_of_rows_transposed_times(kkt, lambda, size_n_);

  std::array<double, 2> largest{};
  for_each_unknown(kkt.pattern, [&](int i, std::size_t unit) { largest[unit] = std::max(largest[unit], size_n_[i]); });
  bool met = true;
  for_each_unknown(kkt.pattern, [&](int i, std::size_t unit) {
    met = met && std::abs(r_f_[i]) <= kForceTolerance * std::max(size_n_[i], kScaleFloor * largest[unit]);
  });
  return met;
}

}  // namespace lockstep
