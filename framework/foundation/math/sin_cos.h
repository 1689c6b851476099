// SPDX-License-Identifier: BSD-3-Clause
// Sines and cosines of many angles at once. For files that are compiled for several instruction sets.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <lockstep/detail/export.h>

namespace lockstep {

/// Writes sines and cosines of n angles, rad, right to one unit in the last place of 1. The four arrays overlap nowhere.
///
/// x = k pi/2 + r, |r| <= pi/4, with pi/2 in three parts, so that k times each of the first two is exact (Cody & Waite);
/// polynomials of r as in fdlibm's kernels, which k mod 4 exchanges and changes in sign.
LOCKSTEP_INLINE void sin_cos(const double* __restrict x, std::size_t n, double* __restrict s, double* __restrict c) {
  constexpr double kShift = 6755399441055744.0;  // 1.5 2^52: the sum's last bits are those of the nearest integer
  constexpr double kLargest = 1e5;               // beyond it the parts of pi/2 are too few
  std::uint64_t beyond = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double shifted = x[i] * 6.36619772367581382433e-01 + kShift, k = shifted - kShift;
    const double r =
        ((x[i] - k * 1.57079632673412561417e+00) - k * 6.07710050630396597660e-11) - k * 2.02226624879595063154e-21;
    const double z = r * r;
    const double sine = r + r * z *
                                (-1.66666666666666324348e-01 +
                                 z * (8.33333333332248946124e-03 +
                                      z * (-1.98412698298579493134e-04 +
                                           z * (2.75573137070700676789e-06 +
                                                z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)))));
    const double half = 0.5 * z, w = 1.0 - half;
    const double cosine =
        w + ((1.0 - w) - half +
             z * z *
                 (4.16666666666666019037e-02 +
                  z * (-1.38888888888741095749e-03 +
                       z * (2.48015872894767294178e-05 +
                            z * (-2.75573143513906633035e-07 +
                                 z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))))));
    const auto q = std::bit_cast<std::uint64_t>(shifted);
    const std::uint64_t exchange = 0 - (q & 1);  // all bits or none
    const auto a = std::bit_cast<std::uint64_t>(sine), b = std::bit_cast<std::uint64_t>(cosine);
    const std::uint64_t other = (a ^ b) & exchange;
    s[i] = std::bit_cast<double>((a ^ other) ^ ((q & 2) << 62));
    c[i] = std::bit_cast<double>((b ^ other) ^ (((q + 1) & 2) << 62));
    beyond |= std::bit_cast<std::uint64_t>(kLargest - std::abs(x[i]));  // its sign
  }
  if (beyond >> 63 == 0) return;
  for (std::size_t i = 0; i < n; ++i)
    if (!(std::abs(x[i]) <= kLargest)) s[i] = std::sin(x[i]), c[i] = std::cos(x[i]);
}

/// Sines and cosines of the angles of a loop, found 64 at once.
class SinCosAhead {
 public:
  /// Before round k of n; angle(i): that of round i, rad.
  template <class Angle>
  LOCKSTEP_INLINE void see(std::size_t k, std::size_t n, Angle&& angle) {
    at_ = k % kAtOnce;
    if (at_ != 0) return;
    const std::size_t count = std::min(kAtOnce, n - k), packed = (count + 7) / 8 * 8;  // packs of up to 8
    for (std::size_t i = 0; i < count; ++i) x_[i] = angle(k + i);
    for (std::size_t i = count; i < packed; ++i) x_[i] = 0;
    sin_cos(x_, packed, s_, c_);
  }
  LOCKSTEP_INLINE double sine() const { return s_[at_]; }    ///< of this round
  LOCKSTEP_INLINE double cosine() const { return c_[at_]; }  ///< likewise

 private:
  static constexpr std::size_t kAtOnce = 64;
  double x_[kAtOnce], s_[kAtOnce], c_[kAtOnce];  // written by see(), no more of them than there are rounds
  std::size_t at_ = 0;
};

}  // namespace lockstep
