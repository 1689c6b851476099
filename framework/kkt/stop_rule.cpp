#include "framework/kkt/stop_rule.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/kkt/products.h"

namespace lockstep {

namespace {

constexpr std::size_t kKinds = 3;

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
  for (VecX* v : {&r_c_, &scale_, &size_m_}) v->setZero(pattern.m);
}

void StopRule::start(const Kkt& kkt, const VecX& f, const VecX& c) {
  VecX& a_f = size_n_;
  a_f.setZero();
  add_mass_times(kkt.pattern, kkt.Minv, f, a_f);
  scale_.setZero();
  add_rows_times(kkt, a_f, scale_);
  scale_ = scale_.cwiseAbs() + c.cwiseAbs();

  std::array<double, kKinds> largest{};
  for_each_row(kkt.pattern, [&](int j, std::size_t kind) { largest[kind] = std::max(largest[kind], scale_[j]); });
  for_each_row(kkt.pattern,
               [&](int j, std::size_t kind) { scale_[j] = std::max(scale_[j], kScaleFloor * largest[kind]); });
  largest_ = std::numeric_limits<double>::infinity();
}

bool StopRule::met(const Kkt& kkt, const VecX& f, const VecX& c, const VecX& a, const VecX& lambda) {
  const bool rows = rows_met(kkt, c, a);
  return forces_met(kkt, f, a, lambda) && rows;
}

// r = c - J a. Where all scales of a unit vanish (a mechanism driven in other directions), r is rounding of the terms
// of J a; so the scale is not taken under 1e-3 of their sum either: 1e-15 of it, a few units in the last place.
bool StopRule::rows_met(const Kkt& kkt, const VecX& c, const VecX& a) {
  r_c_.setZero();
  add_rows_times(kkt, a, r_c_);
  r_c_ = c - r_c_;
  size_m_.setZero();
  add_sizes_of_rows_times(kkt, a, size_m_);
  before_ = largest_;
  largest_ = 0.0;
  worst_row_ = r_c_.size() > 0 ? 0 : -1;
  for (int j = 0; j < r_c_.size(); ++j) {
    const double r = std::abs(r_c_[j]);
    const double relative = r == 0.0 ? 0.0 : r / std::max(scale_[j], kScaleFloor * size_m_[j]);
    if (relative <= largest_) continue;  // a NaN passes on, and stays
    largest_ = relative, worst_row_ = j;
    if (std::isnan(relative)) break;
  }
  return largest_ <= kRowTolerance;
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
