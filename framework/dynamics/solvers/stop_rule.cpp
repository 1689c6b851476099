#include "framework/dynamics/solvers/stop_rule.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/dynamics/solvers/products.h"

namespace lockstep {

namespace {

template <class Visit>
void for_each_row(const KktPattern& pattern, Visit&& visit) {
  for (const KktLink& link : pattern.links)
    for (int k = 0; k < link.m; ++k) visit(link.first_row + k, static_cast<std::size_t>(kind_of(link, k)));
}

// The unit of an unknown: 0 for the first three of a slot (m/s^2, N), 1 for the others.
template <class Visit>
void for_each_unknown(const KktPattern& pattern, Visit&& visit) {
  for_each_mass(pattern, [&](int first, int width, std::size_t) {
    for (int i = 0; i < width; ++i) visit(first + i, static_cast<std::size_t>(i < 3 ? 0 : 1));
  });
}

}  // namespace

void StopRule::analyse(const KktPattern& pattern) {
  for (VecX* v : {&r_f_, &size_n_}) v->setZero(pattern.n);
  for (VecX* v : {&r_c_, &scale_}) v->setZero(pattern.m);
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

  Floors largest{};
  for_each_row(kkt.pattern, [&](int j, std::size_t kind) { largest[kind] = std::max(largest[kind], scale_[j]); });
  for_each_row(kkt.pattern,
               [&](int j, std::size_t kind) { scale_[j] = std::max(scale_[j], kScaleFloor * largest[kind]); });
  largest_ = std::numeric_limits<double>::infinity();
}

bool StopRule::met(const Kkt& kkt, const VecX& f, const VecX& c, const VecX& a, const VecX& lambda) {
  const bool rows = rows_met(kkt, c, a);
  return forces_met(kkt, f, a, lambda) && rows;
}

// r = c - J a. The sizes of J a are asked for only when the rows' own scales refuse.
bool StopRule::rows_met(const Kkt& kkt, const VecX& c, const VecX& a) {
  r_c_.setZero();
  add_rows_times(kkt, a, r_c_);
  r_c_ = c - r_c_;
  before_ = largest_;
  find_worst(kkt.pattern, {});
  if (largest_ <= kRowTolerance) return true;
  find_worst(kkt.pattern, size_floors(kkt, a));
  return largest_ <= kRowTolerance;
}

// Where all scales of a unit vanish (a mechanism driven in other directions only, or held at rest), r is rounding that
// came from other units. By Cauchy and Schwarz |J_j a| <= sqrt(J_j M^-1 J_j^T) sqrt(a . M a), in any frame, and
// likewise for a_f = M^-1 f, of which M^-1 J^T lambda takes away what the rows do not let pass. No scale is taken under
// 1e-3 of the largest of these bounds in its unit, with the slot that has most: the tolerance is then 1e-15 of it, a
// few units in the last place.
StopRule::Floors StopRule::size_floors(const Kkt& kkt, const VecX& a) const {
  double most = energy_f_;
  for_each_mass(kkt.pattern, [&](int first, int width, std::size_t at) {
    most = std::max(most, energy_f_ + quadratic_form(kkt.M.data() + at, a.data() + first, width));
  });
  Floors floors{};
  for (const KktLink& link : kkt.pattern.links)
    for (int k = 0; k < link.m; ++k) {
      double S = 0.0;
      std::size_t at = link.J;
      for (int i = 0; i < link.n_slots; ++i) {
        const auto slot = static_cast<std::size_t>(link.slot[static_cast<std::size_t>(i)]);
        const int width = kkt.pattern.width[slot];
        S += quadratic_form(kkt.Minv.data() + kkt.pattern.M[slot],
                            kkt.J.data() + at + static_cast<std::size_t>(k * width), width);
        at += static_cast<std::size_t>(link.m * width);
      }
      double& floor = floors[static_cast<std::size_t>(kind_of(link, k))];
      floor = std::max(floor, kScaleFloor * std::sqrt(S * most));
    }
  return floors;
}

// A NaN passes every comparison here, and stays.
void StopRule::find_worst(const KktPattern& pattern, const Floors& floors) {
  largest_ = 0.0;
  worst_row_ = -1;
  for_each_row(pattern, [&](int j, std::size_t kind) {
    const double r = std::abs(r_c_[j]);
    const double relative = r == 0.0 ? 0.0 : r / std::max(scale_[j], floors[kind]);
    if (worst_row_ >= 0 && (relative <= largest_ || std::isnan(largest_))) return;
    largest_ = relative, worst_row_ = j;
  });
}

// r = f - M a - J^T lambda, against what its terms amount to, with the same floor per unit as the rows.
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
