// PackedBlocks: the storage of one matrix. A column of a block is one pack: all rows of a link in one instruction.
#pragma once

#include "framework/dynamics/solvers/elimination_passes.h"

namespace lockstep::schur {

#define LOCKSTEP_KERNEL [[gnu::always_inline]] static inline

struct PackedBlocks {
  static constexpr bool kPacked = true;
  static constexpr int kMostTurned = 8, kMostDense = 8;
  using Number = double;
  using Marks = bool;
  template <int m>
  using Slab = Pack<pack_size(m)>;
  static constexpr int slabs(int) { return 1; }
  static constexpr int stride(int m) { return pack_size(m); }
  static constexpr int below(int i, int k, int m, int) { return k * pack_size(m) + i; }
  static constexpr int square(int i, int k, int m) { return k * pack_size(m) + i; }
  static constexpr int columns(int, int m) { return m; }
  /// Rows of a block whose slab is known.
  template <class Slab>
  static constexpr int rows(int) {
    return sizeof(Slab) / sizeof(double);
  }

  template <class T>
  LOCKSTEP_KERNEL T* at(T* p, std::ptrdiff_t i) {
    return p + i;
  }
  LOCKSTEP_KERNEL double number(const double* p, std::ptrdiff_t i) { return p[i]; }
  LOCKSTEP_KERNEL void put(double* p, std::ptrdiff_t i, double v) { p[i] = v; }
  template <class Slab>
  LOCKSTEP_KERNEL Slab load(const double* p) {
    return *reinterpret_cast<const Pack<rows<Slab>(0)>*>(p);
  }
  template <class Slab>
  LOCKSTEP_KERNEL void store(double* p, const Slab& v) {
    *reinterpret_cast<Pack<rows<Slab>(0)>*>(p) = v;
  }
  /// The first nv numbers at p, followed by zeros.
  template <class Slab, int nv>
  LOCKSTEP_KERNEL Slab head(const double* p, int) {
    Slab v, ones{};
    std::memcpy(&v, p, sizeof v);
    for (int i = 0; i < nv; ++i) ones[i] = 1.0;
    return v * ones;
  }

  /// The rows of a column below row k, and those above it; zero elsewhere.
  template <class Slab>
  LOCKSTEP_KERNEL Slab below_row(const Slab& v, int k) {
    Slab ones{};
    for (int i = k + 1; i < rows<Slab>(0); ++i) ones[i] = 1.0;
    return v * ones;
  }
  template <class Slab>
  LOCKSTEP_KERNEL Slab above_row(const Slab& v, int k) {
    Slab ones{};
    for (int i = 0; i < k; ++i) ones[i] = 1.0;
    return v * ones;
  }

  template <class Slab>
  LOCKSTEP_KERNEL double row(const Slab* y, int k) {
    return y[0][k];
  }
  template <class Slab>
  LOCKSTEP_KERNEL void set_row(Slab* y, int k, double v) {
    y[0][k] = v;
  }
  template <class Slab>
  LOCKSTEP_KERNEL void add_row(Slab& y, int, int k, double v) {
    y[k] += v;
  }

  template <int M>
  struct Square {
    using Column = Slab<M>;
    static constexpr int ld = pack_size(M);
    Column d[M];

    [[gnu::always_inline]] Column& slab(int, int j) { return d[j]; }
    [[gnu::always_inline]] double number(int i, int j) const { return d[j][i]; }
    [[gnu::always_inline]] void add_to_diagonal(int i, double v) { d[i][i] += v; }
    [[gnu::always_inline]] void load(const double* p, double sign) {
      for (int k = 0; k < M; ++k) d[k] = PackedBlocks::load<Column>(p + k * ld) * sign;
    }
    [[gnu::always_inline]] void store(double* p, double sign = 1.0) const {
      for (int k = 0; k < M; ++k) PackedBlocks::store(p + k * ld, Column(d[k] * sign));
    }
    /// Step k of the factorisation; p: the inverse of its pivot. Before: T[0..k), with T^T above, and what is left of D.
    /// Column j > k, row i > k: D_ij - p D_ik D_jk;   row k: T_jk = -p D_jk;   rows i < k: T_ji - p T_ki D_jk.
    /// Columns j < k have the last from row k + 1 on. Both u c: c = D_jk or T_kj, u = p column k with p in row k.
    [[gnu::always_inline]] void eliminate(int k, double p) {
      const Column c = d[k];
      Column u = c * p;
      const Column u_below = below_row(u, k);
      u[k] = p;
      for (int j = 0; j < k; ++j) d[j] -= u_below * c[j];
      for (int j = k + 1; j < M; ++j) {
        Column Dj = d[j];
        Dj[k] = 0.0;
        d[j] = Dj - u * c[j];
      }
      d[k] = above_row(c, k) - u_below;
    }
    /// A number of the stored block, read from memory so that the load broadcasts it to a pack.
    [[gnu::always_inline]] double stored(const double* p, int k, int j) const { return p[k * ld + j]; }
  };

  /// y <- T y and y <- T^T y; D: a stored block, T below its diagonal and T^T above.
  template <int M>
  LOCKSTEP_KERNEL void times_T(const double* D, Slab<M>* y) {
    const Slab<M> x = y[0];
#pragma GCC unroll 8
    for (int k = 0; k + 1 < M; ++k) y[0] += below_row(load<Slab<M>>(D + k * pack_size(M)), k) * x[k];
  }
  template <int M>
  LOCKSTEP_KERNEL void times_T_transposed(const double* D, Slab<M>* y) {
    const Slab<M> x = y[0];
#pragma GCC unroll 8
    for (int k = 1; k < M; ++k) y[0] += above_row(load<Slab<M>>(D + k * pack_size(M)), k) * x[k];
  }

  template <class Slab>
  LOCKSTEP_KERNEL Slab floor(const Numbers& z, const Node& node, int) {
    constexpr int ld = rows<Slab>(0);
    const double* kind = z.kind + 3 * node.x;
    return load<Slab>(kind) * z.floors[0] + load<Slab>(kind + ld) * z.floors[1] +
           load<Slab>(kind + 2 * ld) * z.floors[2];
  }
  template <class Slab>
  LOCKSTEP_KERNEL void mark(bool& unmet, const Slab& size, const Slab& limit) {
    const auto within = size <= limit;
    for (int i = 0; i < rows<Slab>(0); ++i) unmet = unmet || !within[i];
  }
  template <class F>
  LOCKSTEP_KERNEL void with_slab(int m, F&& f) {
    switch (pack_size(m)) {
      case 2:
        return f.template operator()<Pack<2>>();
      case 4:
        return f.template operator()<Pack<4>>();
      default:
        return f.template operator()<Pack<8>>();
    }
  }
};

#undef LOCKSTEP_KERNEL

}  // namespace lockstep::schur
