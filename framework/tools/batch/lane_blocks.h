// LaneBlocks: the storage of several matrices at once, for the elimination (dynamics/solvers/elimination.h). Every
// number is a pack, one matrix per lane; of a diagonal block the lower triangle is kept. Private to the room.
#pragma once

#include "framework/dynamics/solvers/elimination_passes.h"
#include "framework/tools/batch/lane_math.h"

namespace lockstep::lanes::LOCKSTEP_SET {

struct LaneBlocks {
  static constexpr bool kPacked = false;
  static constexpr int kMostTurned = 6, kMostDense = 5;  // six rows are a full lock, whose translation is turned
  using Number = V;
  using Marks = V;  // ones in the lanes that are marked
  template <int m>
  using Slab = V;
  static constexpr int slabs(int m) { return m; }
  static constexpr int stride(int m) { return m; }
  static constexpr int below(int i, int k, int, int n) { return i * n + k; }
  static constexpr int square(int i, int k, int) { return i >= k ? i * (i + 1) / 2 + k : k * (k + 1) / 2 + i; }
  static constexpr int columns(int i, int) { return i + 1; }
  template <class Slab>
  static constexpr int rows(int m) {
    return m;
  }

  template <class T>
  LOCKSTEP_LANE static T* at(T* p, std::ptrdiff_t i) {
    return p + kLanes * i;
  }
  LOCKSTEP_LANE static V number(const double* p, std::ptrdiff_t i) {
    return *reinterpret_cast<const V*>(p + kLanes * i);
  }
  LOCKSTEP_LANE static void put(double* p, std::ptrdiff_t i, const V& v) { *reinterpret_cast<V*>(p + kLanes * i) = v; }
  template <class Slab>
  LOCKSTEP_LANE static V load(const double* p) {
    return number(p, 0);
  }
  LOCKSTEP_LANE static void store(double* p, const V& v) { put(p, 0, v); }
  template <class Slab, int nv>
  LOCKSTEP_LANE static V head(const double* p, int i) {
    return i < nv ? number(p, i) : V{};
  }

  LOCKSTEP_LANE static V row(const V* y, int k) { return y[k]; }
  LOCKSTEP_LANE static void set_row(V* y, int k, const V& v) { y[k] = v; }
  LOCKSTEP_LANE static void add_row(V& y, int i, int k, const V& v) {
    if (i == k) y += v;
  }

  template <int M>
  struct Square {
    static constexpr int n = M * (M + 1) / 2;
    V d[n];

    LOCKSTEP_LANE V& slab(int i, int j) { return d[square(i, j, M)]; }
    LOCKSTEP_LANE V number(int i, int j) const { return d[square(i, j, M)]; }
    LOCKSTEP_LANE void add_to_diagonal(int i, const V& v) { d[square(i, i, M)] += v; }
    LOCKSTEP_LANE void load(const double* p, double) {
      for (int k = 0; k < n; ++k) d[k] = LaneBlocks::number(p, k);
    }
    LOCKSTEP_LANE void store(double* p, double = 1.0) const {
      for (int k = 0; k < n; ++k) put(p, k, d[k]);
    }
    /// Step k of the factorisation; p: the inverse of its pivot. Row i > k: D_ij - p D_ik D_jk for j > k, T_ik = -p D_ik,
    /// T_ij - p D_ik T_kj for j < k.
    LOCKSTEP_LANE void eliminate(int k, const V& p) {
      V column[M];
      for (int i = k + 1; i < M; ++i) column[i] = slab(i, k);
      for (int i = k + 1; i < M; ++i) {
        const V u = column[i] * p;
        for (int j = 0; j < k; ++j) slab(i, j) -= u * slab(k, j);
        slab(i, k) = -u;
        for (int j = k + 1; j <= i; ++j) slab(i, j) -= u * column[j];
      }
    }
    LOCKSTEP_LANE V stored(const double*, int k, int j) const { return number(k, j); }
  };

  /// y <- T y and y <- T^T y; D: a stored block, T below its diagonal.
  template <int M>
  LOCKSTEP_LANE static void times_T(const double* D, V* y) {
#pragma GCC unroll 8
    for (int i = M - 1; i > 0; --i)
      for (int k = 0; k < i; ++k) y[i] += number(D, square(i, k, M)) * y[k];
  }
  template <int M>
  LOCKSTEP_LANE static void times_T_transposed(const double* D, V* y) {
#pragma GCC unroll 8
    for (int k = 0; k + 1 < M; ++k)
      for (int i = k + 1; i < M; ++i) y[k] += number(D, square(i, k, M)) * y[i];
  }

  template <class Slab>
  LOCKSTEP_LANE static V floor(const schur::Numbers& z, const schur::Node& node, int i) {
    return number(z.floors, static_cast<int>(node.kinds.of(i)));
  }
  LOCKSTEP_LANE static void mark(V& unmet, const V& size, const V& limit) { unmet = size <= limit ? unmet : V{} + 1.0; }
  template <class F>
  LOCKSTEP_LANE static void with_slab(int, F&& f) {
    f.template operator()<V>();
  }
};

}  // namespace lockstep::lanes::LOCKSTEP_SET
