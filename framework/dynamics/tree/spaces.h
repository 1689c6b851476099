// SPDX-License-Identifier: BSD-3-Clause
// InSpace, InColumns and InPlane: what the recursion asks of a space. Forces, accelerations and inertias, of numbers or of packs of
// them. For files that are compiled for several instruction sets.
#pragma once

#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>

#include <lockstep/author/jet.h>
#include <lockstep/detail/vec.h>
#include <lockstep/math.h>
#include "framework/dynamics/tree/planar_joints.h"

// As arguments of templates packs lose that they may alias, which is not needed there.
#pragma GCC diagnostic ignored "-Wignored-attributes"

namespace lockstep::bodies {

// Vectors of three numbers in packs of four, matrices of three such columns, and what is done with them: a column in one
// instruction.

/// The fourth number is zero. If a struct holds columns they come first, and it has alignas(kColumn): the compiler
/// takes 16 bytes where it does not count on AVX, and 32 where it does.
using Column = Pack<4>;
inline constexpr std::size_t kColumn = 32;  ///< bytes

struct alignas(kColumn) Columns {
  Column c[3];
};

LOCKSTEP_INLINE Column column(const Vec3& v) { return Column{v[0], v[1], v[2], 0.0}; }
LOCKSTEP_INLINE Vec3 vector(const Column& v) { return {v[0], v[1], v[2]}; }
LOCKSTEP_INLINE Columns columns(const Mat3& A) { return {{column(A.col(0)), column(A.col(1)), column(A.col(2))}}; }

LOCKSTEP_INLINE double dot(const Column& a, const Column& b) {
  const Column p = a * b;
  return p[0] + p[1] + p[2];
}
LOCKSTEP_INLINE Column operator*(const Columns& A, const Column& b) {
  return A.c[0] * b[0] + A.c[1] * b[1] + A.c[2] * b[2];
}
LOCKSTEP_INLINE Column operator*(const Columns& A, const Vec3& b) {
  return A.c[0] * b[0] + A.c[1] * b[1] + A.c[2] * b[2];
}

/// r~: one side of a cross product, with its two rotations by one place.
struct Skew {
  Column yzx, zxy, r;
  LOCKSTEP_INLINE explicit Skew(const Column& v)
      : yzx(__builtin_shufflevector(v, v, 1, 2, 0, 3)), zxy(__builtin_shufflevector(v, v, 2, 0, 1, 3)), r(v) {}
};
/// r x b
LOCKSTEP_INLINE Column operator*(const Skew& S, const Column& b) {
  return S.yzx * __builtin_shufflevector(b, b, 2, 0, 1, 3) - S.zxy * __builtin_shufflevector(b, b, 1, 2, 0, 3);
}
/// A <- A - B r~
LOCKSTEP_INLINE void subtract_product(Columns& A, const Columns& B, const Skew& S) {
  A.c[0] -= B.c[1] * S.r[2] - B.c[2] * S.r[1];
  A.c[1] -= B.c[2] * S.r[0] - B.c[0] * S.r[2];
  A.c[2] -= B.c[0] * S.r[1] - B.c[1] * S.r[0];
}
/// A <- A + r~ B
LOCKSTEP_INLINE void add_product(Columns& A, const Skew& S, const Columns& B) {
  for (int k = 0; k < 3; ++k) A.c[k] += S * B.c[k];
}
/// A <- A - x y'
LOCKSTEP_INLINE void subtract_dyad(Columns& A, const Column& x, const Column& y) {
  for (int k = 0; k < 3; ++k) A.c[k] -= x * y[k];
}

/// A struct of columns needs kColumn.
template <class L>
inline constexpr std::size_t kAlign = alignof(L);
template <>
inline constexpr std::size_t kAlign<Column> = kColumn;

/// A force and its moment, about a point. L: a vector; A: an axial one.
template <class L, class A = L>
struct alignas(kAlign<L>) Wrench {
  using Linear = L;
  L f{};
  A t{};
};
/// An acceleration of a point, or its velocity, and an angular one.
template <class L, class A = L>
struct alignas(kAlign<L>) Twist {
  using Linear = L;
  L a{};
  A al{};
};
/// Either of them.
template <class S>
concept Screw = requires {
  typename S::Linear;
};

/// Whether numbers of this type cannot be compared, since they are those of many states: pivots are taken as they are.
template <class T>
inline constexpr bool kUncompared = false;

template <class T>
LOCKSTEP_INLINE T magnitude(const T& x) {
  return x < 0.0 ? -x : x;
}
template <class T>
LOCKSTEP_INLINE T square_root(const T& x) {
  T r{};
  using std::sqrt;
  if constexpr (requires { sqrt(x); })
    r = sqrt(x);
  else  // of packs
    for (std::size_t l = 0; l < sizeof(T) / sizeof(double); ++l) r[l] = std::sqrt(x[l]);
  return r;
}

using lockstep::cross;
using lockstep::dot;
// In the plane an axial vector is a number, along the normal.
template <class T>
LOCKSTEP_INLINE T cross(const FlatOf<T>& a, const FlatOf<T>& b) {
  return a.i * b.j - a.j * b.i;
}
template <class T>
LOCKSTEP_INLINE FlatOf<T> cross(const T& a, const FlatOf<T>& b) {
  return a * across(b);
}
LOCKSTEP_INLINE Column cross(const Column& a, const Column& b) { return Skew(a) * b; }

template <Screw S>
LOCKSTEP_INLINE S& operator+=(S& a, const S& b) {
  auto& [x, y] = a;
  const auto& [u, v] = b;
  x = x + u, y = y + v;
  return a;
}
template <Screw S>
LOCKSTEP_INLINE S& operator-=(S& a, const S& b) {
  auto& [x, y] = a;
  const auto& [u, v] = b;
  x = x - u, y = y - v;
  return a;
}
template <class N, Screw S>
LOCKSTEP_INLINE S operator*(const N& x, const S& a) {
  const auto& [u, v] = a;
  return {x * u, x * v};
}
/// a . b of axial vectors: in the plane their product. L: the vectors of their space.
template <class L, class A>
LOCKSTEP_INLINE auto axial_dot(const A& a, const A& b) {
  if constexpr (std::is_same_v<L, A>)
    return dot(a, b);
  else
    return a * b;
}
template <class L, class A>
LOCKSTEP_INLINE auto dot(const Wrench<L, A>& a, const Twist<L, A>& b) {
  return dot(a.f, b.a) + axial_dot<L>(a.t, b.al);
}
/// Squares of both parts.
template <Screw S>
LOCKSTEP_INLINE auto squares(const S& a) {
  const auto& [u, v] = a;
  return std::pair(dot(u, u), axial_dot<typename S::Linear>(v, v));
}
/// Of the point at r from this one in a rigid body, beyond what its velocity makes: a + al x r.
template <class L, class A>
LOCKSTEP_INLINE Twist<L, A> at(const L& r, const Twist<L, A>& s) {
  return {s.a + cross(s.al, r), s.al};
}
/// About the point from which this one is at r: t + r x f.
template <class L, class A>
LOCKSTEP_INLINE Wrench<L, A> about(const L& r, const Wrench<L, A>& K) {
  return {K.f, K.t + cross(r, K.f)};
}

/// A symmetric matrix.
template <class T>
struct Symmetric {
  T xx, xy, xz, yy, yz, zz;

  LOCKSTEP_INLINE friend vec::Vector<T> operator*(const Symmetric& S, const vec::Vector<T>& a) {
    return {S.xx * a.x + S.xy * a.y + S.xz * a.z, S.xy * a.x + S.yy * a.y + S.yz * a.z,
            S.xz * a.x + S.yz * a.y + S.zz * a.z};
  }
  LOCKSTEP_INLINE friend Symmetric operator+(const Symmetric& a, const Symmetric& b) {
    return {a.xx + b.xx, a.xy + b.xy, a.xz + b.xz, a.yy + b.yy, a.yz + b.yz, a.zz + b.zz};
  }
  /// S <- S - x y', which is symmetric.
  LOCKSTEP_INLINE void subtract(const vec::Vector<T>& x, const vec::Vector<T>& y) {
    xx -= x.x * y.x, xy -= x.x * y.y, xz -= x.x * y.z, yy -= x.y * y.y, yz -= x.y * y.z, zz -= x.z * y.z;
  }
  /// A J A'
  LOCKSTEP_INLINE static Symmetric turned(const vec::Matrix<vec::Vector<T>>& A, const Symmetric& J) {
    const vec::Vector<T> a = J * A.r0, b = J * A.r1, c = J * A.r2;
    return {dot(A.r0, a), dot(A.r0, b), dot(A.r0, c), dot(A.r1, b), dot(A.r1, c), dot(A.r2, c)};
  }
};

/// Three dimensions. An inertia: force = M a + H al + p.f, moment = H' a + I al + p.t; H by its columns.
template <class T>
struct InSpace {
  using Number = T;
  using Linear = vec::Vector<T>;
  using Axial = Linear;
  using Wrench = bodies::Wrench<Linear>;
  using Twist = bodies::Twist<Linear>;
  LOCKSTEP_INLINE static const Linear& from(const Linear& a) { return a; }
  LOCKSTEP_INLINE static const Linear& from_axial(const Linear& a) { return a; }

  struct Inertia {
    Symmetric<T> M{}, I{};
    Linear h0, h1, h2;
    Wrench p;

    LOCKSTEP_INLINE Wrench operator*(const Twist& s) const {
      return {M * s.a + s.al.x * h0 + s.al.y * h1 + s.al.z * h2,
              Linear{dot(h0, s.a), dot(h1, s.a), dot(h2, s.a)} + I * s.al};
    }
    LOCKSTEP_INLINE void add(const Inertia& b) {
      M = M + b.M, I = I + b.I, p += b.p;
      h0 = h0 + b.h0, h1 = h1 + b.h1, h2 = h2 + b.h2;
    }
    /// Less V U', which is symmetric.
    LOCKSTEP_INLINE void subtract(const Wrench& V, const Wrench& U) {
      M.subtract(V.f, U.f), I.subtract(V.t, U.t);
      h0 = h0 - U.t.x * V.f, h1 = h1 - U.t.y * V.f, h2 = h2 - U.t.z * V.f;
    }
    /// About the point r before: X' IA X and X' p with X = [1 -r~; 0 1].
    LOCKSTEP_INLINE void move(const Linear& r) {
      const Linear k0 = cross(r, h0), k1 = cross(r, h1), k2 = cross(r, h2);
      // H <- H - M r~
      const Linear m0{M.xx, M.xy, M.xz}, m1{M.xy, M.yy, M.yz}, m2{M.xz, M.yz, M.zz};
      h0 = h0 - (r.z * m1 - r.y * m2), h1 = h1 - (r.x * m2 - r.z * m0), h2 = h2 - (r.y * m0 - r.x * m1);
      // I <- I - H' r~ + r~ H of before and after
      const Linear n0 = cross(r, h0), n1 = cross(r, h1), n2 = cross(r, h2);
      I.xx += k0.x + n0.x, I.xy += k0.y + n1.x, I.xz += k0.z + n2.x;
      I.yy += k1.y + n1.y, I.yz += k1.z + n2.y, I.zz += k2.z + n2.z;
      p = about(r, p);
    }
  };
};

/// The same in columns of four, which one instruction adds. H' has its own columns.
struct InColumns {
  using Number = double;
  using Linear = Column;
  using Axial = Column;
  using Wrench = bodies::Wrench<Column>;
  using Twist = bodies::Twist<Column>;
  LOCKSTEP_INLINE static Column from(const Vec3& a) { return column(a); }
  LOCKSTEP_INLINE static Column from_axial(const Vec3& a) { return column(a); }

  struct alignas(kColumn) Inertia {
    Columns M{}, H{}, H_t{}, I{};
    Wrench p;

    LOCKSTEP_INLINE Wrench operator*(const Twist& s) const { return {M * s.a + H * s.al, H_t * s.a + I * s.al}; }
    LOCKSTEP_INLINE void add(const Inertia& b) {
      for (int k = 0; k < 3; ++k) M.c[k] += b.M.c[k], H.c[k] += b.H.c[k], H_t.c[k] += b.H_t.c[k], I.c[k] += b.I.c[k];
      p += b.p;
    }
    LOCKSTEP_INLINE void subtract(const Wrench& V, const Wrench& U) {
      subtract_dyad(M, V.f, U.f), subtract_dyad(H, V.f, U.t);
      subtract_dyad(H_t, V.t, U.f), subtract_dyad(I, V.t, U.t);
    }
    LOCKSTEP_INLINE void move(const Column& by) {
      const Skew r(by);
      subtract_product(I, H_t, r);
      subtract_product(H, M, r);
      add_product(I, r, H);
      add_product(H_t, r, M);
      p.t += r * p.f;
    }
  };
};

/// Two dimensions: force = M a + h al + p.f, moment = h' a + I al + p.t.
template <class T>
struct InPlane {
  using Number = T;
  using Linear = FlatOf<T>;
  using Axial = T;
  using Wrench = bodies::Wrench<Linear, T>;
  using Twist = bodies::Twist<Linear, T>;
  /// Of vectors of three components, of which those out of the plane are zero; the normal is the third axis.
  template <class Z>
  LOCKSTEP_INLINE static Linear from(const vec::Vector<T, T, Z>& a) {
    return {a.x, a.y};
  }
  template <class X>
  LOCKSTEP_INLINE static Axial from_axial(const vec::Vector<X, X, T>& a) {
    return a.z;
  }

  struct Inertia {
    T Mii{}, Mij{}, Mjj{}, I{};
    Linear h;
    Wrench p;

    LOCKSTEP_INLINE Linear M(const Linear& a) const { return {Mii * a.i + Mij * a.j, Mij * a.i + Mjj * a.j}; }
    LOCKSTEP_INLINE Wrench operator*(const Twist& s) const { return {M(s.a) + s.al * h, dot(h, s.a) + I * s.al}; }
    LOCKSTEP_INLINE void add(const Inertia& b) {
      Mii += b.Mii, Mij += b.Mij, Mjj += b.Mjj, I += b.I, h += b.h, p += b.p;
    }
    LOCKSTEP_INLINE void subtract(const Wrench& V, const Wrench& U) {
      Mii -= V.f.i * U.f.i, Mij -= V.f.i * U.f.j, Mjj -= V.f.j * U.f.j;
      h -= U.t * V.f, I -= V.t * U.t;
    }
    LOCKSTEP_INLINE void move(const Linear& r) {
      const Linear s = across(r), Ms = M(s);
      I += dot(s, Ms) + 2.0 * dot(s, h);
      h += Ms;
      p = about(r, p);
    }
  };
};

}  // namespace lockstep::bodies
