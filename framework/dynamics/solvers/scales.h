// SPDX-License-Identifier: BSD-3-Clause
// The scales s_j of the rows, in which the proximal term E = eps s_j is measured (framework/docs/solvers.md, section
// 5).
#pragma once

#include <algorithm>

#include <lockstep/detail/rows.h>

namespace lockstep {

/// What a row's value is in lengths, m per unit, in a mechanism of this length: an error quaternion's component is half an
/// angle.
inline double length_per_unit(RowKind kind, double length) {
  return kind == RowKind::translation ? 1.0 : kind == RowKind::rotation ? 2.0 * length : length;
}

/// Bits of the rows of a link by kind; the others are functions.
struct KindBits {
  unsigned translations = 0, rotations = 0;
  KindBits() = default;
  template <class Kinds>
  KindBits(const Kinds& kind, int m) {
    for (int k = 0; k < m; ++k) {
      translations |= kind[k] == RowKind::translation ? 1u << k : 0u;
      rotations |= kind[k] == RowKind::rotation ? 1u << k : 0u;
    }
  }
  RowKind of(int k) const {
    return translations >> k & 1u ? RowKind::translation : rotations >> k & 1u ? RowKind::rotation : RowKind::function;
  }
};

/// The diagonal S_jj = (J M^-1 J^T)_jj of one link's rows becomes s_j: force rows get their mean, moment rows get
/// theirs, a function keeps its own. Reactions of redundant rows then do not depend on the frame. A link without a
/// slot, or one whose rows vanish, has no scale; any positive number keeps the matrix definite.
/// T: double, or a pack of them, one per lane.
template <class T>
[[gnu::always_inline]] inline void average_scales(T* s, int m, const KindBits& kinds) {
  const auto translates = [&](int k) __attribute__((always_inline)) { return (kinds.translations >> k & 1u) != 0; };
  const auto turns = [&](int k) __attribute__((always_inline)) { return (kinds.rotations >> k & 1u) != 0; };
  T t{}, r{};
  for (int k = 0; k < m; ++k) t += translates(k) ? s[k] : T{}, r += turns(k) ? s[k] : T{};
  t = t / static_cast<double>(std::max(1, __builtin_popcount(kinds.translations)));
  r = r / static_cast<double>(std::max(1, __builtin_popcount(kinds.rotations)));
  for (int k = 0; k < m; ++k) {
    const T mean = translates(k) ? t : turns(k) ? r : s[k];
    s[k] = mean > 0.0 ? mean : T{} + 1.0;
  }
}

}  // namespace lockstep
