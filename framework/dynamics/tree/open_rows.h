// SPDX-License-Identifier: BSD-3-Clause
// OpenRows: the elimination of the rows of links that are not in the tree, along with the recursion
// (framework/docs/solvers.md, section 9). One text for all spaces and numbers.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/dynamics/tree/closure_fronts.h"
#include "framework/dynamics/tree/spaces.h"

namespace lockstep {

/// A row j of a closure is  K a + l - Lambda lambda - E lambda = 0,  where a is the acceleration of the node that the
/// recursion has come to. From a node to its parent, with S, U, D, u of the recursion, kappa = K S and V = kappa D^-1:
///
///     K <- K - V U',   l <- l + V u,   Lambda <- Lambda + kappa V',   then l <- l + K c, and K about the parent
///
/// A row ends where the paths of all its slots meet, at the ground if it touches that. There it is eliminated, by
/// d = Lambda_jj + E_j, and changes the node and the rows that are still open; at the ground by minimum degree over the
/// links that end there:
///
///     IA <- IA + K_j' K_j / d,   p <- p + K_j' l_j / d,   K_i <- K_i - Lambda_ij K_j / d,   l_i and Lambda_ik likewise
///
/// and outward  lambda_j = (K_j a + l_j - sum of Lambda_ij lambda_i) / d.  E is a proximal term of rows whose pivot is small,
/// corrected away; of others, which need none, it is zero.
///
/// E_j = kClosureProximal s_j.  Numbers: an array; [i] is its number i, + i what begins there.
///
/// Where rows are redundant, those that end in one front are eliminated by a Cholesky decomposition with pivoting: which of
/// them are independent depends on the pose, and a fixed order would divide by pivots that vanish between two poses.

/// The rows as pivots have ordered them.
struct PivotOrder {
  std::vector<int> row_at,  ///< by place
      ended_at;             ///< by row: its place in the front in which it ends
};

template <class Space, class Numbers = typename Space::Number*>
struct OpenRows {
  using Number = typename Space::Number;
  using Wrench = typename Space::Wrench;
  using Twist = typename Space::Twist;
  using Inertia = typename Space::Inertia;

  const ClosureFronts& fronts;
  Wrench* K;                    ///< by place
  Numbers l, Lambda_of, V_of,   ///< by place; of fronts, from ClosureFront::Lambda and V on
      scale, d, lambda,         ///< by row; scale: s_j
      dlambda, du;              ///< of a correction, by row and by coordinate
  Wrench* wrenches;             ///< likewise, by node
  Twist* changes;               ///< likewise
  PivotOrder* order = nullptr;  ///< null: no row is redundant, or numbers cannot be compared one by one
  Number n_small{};             ///< pivots that got a proximal term
  std::array<Number, 6> less_{};

  /// Called by the recursion at node k: rows that end there are eliminated,
  LOCKSTEP_INLINE void close(std::size_t k, Inertia& IA) {
    const ClosureFront& front = fronts.all[k];
    begin_order(front);
    for (int j = front.n - 1; j >= front.n_open; --j) {
      const Number d_1 = eliminate<false>(front, j);
      const Wrench &of = K[front.first + j], by = -d_1 * of;
      IA.subtract(by, of);
      IA.p -= l[front.first + j] * by;
    }
  }
  /// and the others pass its joint: to the parent at once, as they are not read here again.
  template <class Joint>
  LOCKSTEP_INLINE void pass_on(std::size_t k, const Joint& joint) {
    const ClosureFront& front = fronts.all[k];
    if (front.n_open == 0) return;
    const ClosureFront& up = fronts.all[fronts.parents[k]];
    const int *above = fronts.above.data() + front.first, n_v = joint.n_v();
    const Numbers V = V_of + front.V;
    for (int i = 0; i < front.n_open; ++i) {
      Wrench through = K[front.first + i];
      Number with = l[front.first + i], kappa[6];
      joint.pass(through, with, kappa, V + i * n_v);
      const int there = up.first + above[i];
      K[there] += through, l[there] += with;
      const Numbers row = Lambda(front, i), to = Lambda(up, above[i]);
      for (int j = 0; j <= i; ++j) {
        Number sum = row[j];
        for (int x = 0; x < n_v; ++x) sum += kappa[x] * V[j * n_v + x];
        to[above[j]] += sum;
      }
    }
  }
  LOCKSTEP_INLINE void close_at_ground() {
    for (std::size_t k = fronts.n_nodes; k < fronts.all.size(); ++k) {
      const ClosureFront& front = fronts.all[k];
      begin_order(front);
      for (int j = front.n - 1; j >= front.n_open; --j) eliminate<true>(front, j);
      if (front.n_open > 0) add_to_parent(k);
    }
    find_at_ground(lambda);
  }
  /// Outward: V' lambda; null: nothing.
  LOCKSTEP_INLINE const Number* less(std::size_t k, int n_v) { return less(k, n_v, lambda); }
  LOCKSTEP_INLINE void find(std::size_t k, const Twist& a) { find(k, a, lambda); }

  /// The elimination again, for p = 0, c = 0 and l = r: the change of the velocities, of least kinetic energy, by which
  /// these residuals vanish: J (change) = -r.
  template <class Joints, class Residuals>
  LOCKSTEP_INLINE void correct(Joints& joints, Residuals r, Numbers dv) {
    inward_again(joints, r);
    for (std::size_t k = 0; k < fronts.n_nodes; ++k) {
      const int at = joints.first_v(k);
      joints.with_joint(
          k, [&](const auto& joint) __attribute__((always_inline)) {
            changes[k] = joint.solve_again(has_parent(k) ? changes[fronts.parents[k]] : Twist{}, du + at,
                                           less(k, joint.n_v(), dlambda), dv + at);
          });
      find(k, changes[k], dlambda);
    }
  }

  LOCKSTEP_INLINE Number& l_of(std::size_t row) const { return l[static_cast<int>(fronts.place_of(row))]; }
  /// Nothing is open, and no place has a row.
  LOCKSTEP_INLINE void clear() {
    for (std::size_t i = 0; i < fronts.rows.size(); ++i) K[i] = Wrench{}, l[static_cast<int>(i)] = Number{};
    for (int i = 0; i < fronts.n_Lambda; ++i) Lambda_of[i] = Number{};
  }

 private:
  LOCKSTEP_INLINE Numbers Lambda(const ClosureFront& f, int i) const { return Lambda_of + (f.Lambda + i * f.n); }
  LOCKSTEP_INLINE bool has_parent(std::size_t node) const { return fronts.parents[node] < fronts.n_nodes; }

  // Lambda is symmetric: what is right of the diagonal is neither written nor read. At the ground nothing moves, and K is
  // of no interest. Returns 1 / d.
  template <bool kAtGround>
  LOCKSTEP_INLINE Number eliminate(const ClosureFront& front, int j) {
    if constexpr (std::is_same_v<Number, double>)
      if (order && j > front.n_open) choose_pivot(front, j);
    const int row = row_of(front, j), last = front.first + j;
    const Numbers at = Lambda(front, j);
    Number pivot = at[j];
    if constexpr (!bodies::kUncompared<Number>) {
      const auto small = at[j] < kSmallPivot * scale[row];
      const Number positive = at[j] > 0.0 ? at[j] : Number{};  // rounding may leave less than zero
      pivot = small ? positive + kClosureProximal * scale[row] : pivot;
      n_small += small ? Number{} + 1.0 : Number{};
    }
    const Number d_1 = 1.0 / pivot;
    d[row] = pivot;
    for (int i = 0; i < j; ++i) {
      const Number x = at[i] * d_1;
      if constexpr (!kAtGround) K[front.first + i] -= x * K[last];
      l[front.first + i] -= l[last] * x;
      const Numbers to = Lambda(front, i);
      for (int k = 0; k <= i; ++k) to[k] -= x * at[k];
    }
    return d_1;
  }
  LOCKSTEP_INLINE void begin_order(const ClosureFront& front) {
    if (!order) return;
    for (int i = front.n_open; i < front.n; ++i) {
      const int place = front.first + i, row = fronts.row_of(front, i);
      order->row_at[place] = row, order->ended_at[row] = place;
    }
  }
  /// Exchanges the row that is eliminated next, j, with the one of the largest pivot, relative to its scale.
  [[gnu::noinline]] void choose_pivot(const ClosureFront& front, int j) {
    const auto pivot = [&](int i) { return Lambda(front, i)[i] / scale[row_of(front, i)]; };
    int most = j;
    for (int i = j; i-- > front.n_open;)
      if (pivot(i) > pivot(most)) most = i;
    if (most == j) return;
    const int a = front.first + most, b = front.first + j;
    std::swap(K[a], K[b]), std::swap(l[a], l[b]);
    for (int i = 0; i <= j; ++i) {  // of the lower triangle
      if (i == most) continue;
      Number& of_most = i < most ? Lambda(front, most)[i] : i == j ? Lambda(front, most)[most] : Lambda(front, i)[most];
      std::swap(of_most, Lambda(front, j)[i]);
    }
    for (int i = j + 1; i < front.n; ++i)
      std::swap(Lambda(front, i)[most], Lambda(front, i)[j]);  // of those eliminated
    std::swap(order->row_at[a], order->row_at[b]);
    order->ended_at[order->row_at[a]] = a, order->ended_at[order->row_at[b]] = b;
  }
  LOCKSTEP_INLINE int row_of(const ClosureFront& front, int i) const {
    return order ? order->row_at[front.first + i] : fronts.row_of(front, i);
  }
  /// Where a row of this number in a front is now.
  LOCKSTEP_INLINE int place_now(const ClosureFront& front, int i) const {
    return order && i >= front.n_open ? order->ended_at[fronts.row_of(front, i)] : front.first + i;
  }
  LOCKSTEP_INLINE int above_now(std::size_t k, int i) const {
    return place_now(fronts.all[fronts.parents[k]], fronts.above[fronts.all[k].first + i]);
  }
  // Adds the open rows of a front of the ground to those of its parent.
  LOCKSTEP_INLINE void add_to_parent(std::size_t k) {
    const ClosureFront &front = fronts.all[k], &up = fronts.all[fronts.parents[k]];
    const int* above = fronts.above.data() + front.first;
    for (int i = 0; i < front.n_open; ++i) {
      l[up.first + above[i]] += l[front.first + i];
      const Numbers from = Lambda(front, i), to = Lambda(up, above[i]);
      for (int j = 0; j <= i; ++j) to[above[j]] += from[j];
    }
  }
  LOCKSTEP_INLINE void find_at_ground(Numbers multipliers) {
    for (std::size_t k = fronts.all.size(); k-- > fronts.n_nodes;) find(k, Twist{}, multipliers);
  }
  LOCKSTEP_INLINE const Number* less(std::size_t k, int n_v, Numbers multipliers) {
    const ClosureFront& front = fronts.all[k];
    if (front.n_open == 0) return nullptr;
    for (int v = 0; v < n_v; ++v) {
      const Numbers V = V_of + (front.V + v);
      Number sum{};
      for (int i = 0; i < front.n_open; ++i) sum += V[i * n_v] * multipliers[row_of(front, i)];
      less_[v] = sum;
    }
    return less_.data();
  }
  // lambda_j = (K_j a + l_j - sum of Lambda_ij lambda_i) / d_j over the rows that were eliminated later.
  LOCKSTEP_INLINE void find(std::size_t k, const Twist& a, Numbers multipliers) {
    const ClosureFront& front = fronts.all[k];
    for (int j = front.n_open; j < front.n; ++j) {
      const Numbers at = Lambda(front, j);
      Number sum = l[front.first + j] + dot(K[front.first + j], a);
      for (int i = 0; i < j; ++i) sum -= at[i] * multipliers[row_of(front, i)];
      const int row = row_of(front, j);
      multipliers[row] = sum / d[row];
    }
  }
  LOCKSTEP_INLINE void close_again(const ClosureFront& front, Wrench* p) {
    for (int j = front.n - 1; j >= front.n_open; --j) {
      const Numbers at = Lambda(front, j);
      const Number x = l[front.first + j] / d[row_of(front, j)];
      if (p) *p += x * K[front.first + j];
      for (int i = 0; i < j; ++i) l[front.first + i] -= at[i] * x;
    }
  }
  template <class Joints, class Residuals>
  LOCKSTEP_INLINE void inward_again(Joints& joints, Residuals r) {
    for (std::size_t i = 0; i < fronts.rows.size(); ++i) l[static_cast<int>(i)] = Number{};
    for (std::size_t k = 0; k < fronts.n_nodes; ++k) wrenches[k] = Wrench{};
    for (std::size_t j = 0; j < fronts.sources.size(); ++j) {
      const ClosureSide& side = fronts.sides[fronts.sources[j].first_side];
      const ClosureFront& front = fronts.all[side.node];
      l[place_now(front, side.place - front.first)] = r[static_cast<int>(j)];
    }
    for (std::size_t k = fronts.n_nodes; k-- > 0;) {
      const ClosureFront& front = fronts.all[k];
      Wrench p = wrenches[k];
      close_again(front, &p);
      const Numbers u = du + joints.first_v(k);
      int n_v = 0;
      joints.with_joint(
          k, [&](const auto& joint) __attribute__((always_inline)) { joint.pass_again(p, u), n_v = joint.n_v(); });
      for (int i = 0; i < front.n_open; ++i) {
        Number with = l[front.first + i];
        for (int x = 0; x < n_v; ++x) with += V_of[front.V + i * n_v + x] * u[x];
        l[above_now(k, i)] += with;
      }
      if (has_parent(k)) wrenches[fronts.parents[k]] += p;
    }
    for (std::size_t k = fronts.n_nodes; k < fronts.all.size(); ++k) {
      const ClosureFront& front = fronts.all[k];
      close_again(front, nullptr);
      for (int i = 0; i < front.n_open; ++i) l[above_now(k, i)] += l[front.first + i];
    }
    find_at_ground(dlambda);
  }
};

/// r = J a - c of a row, and the sum of the sizes of its terms; side(i, take) gives its J and a of a slot. If all terms vanish
/// (the row is normal to a plane in which all moves), r is rounding of other directions, bounded in any frame by
/// |J_f| |a| + |J_t| |al|: with `raised` the size is at least as residual_floor() raises it by energy.
template <class Number, class Side>
LOCKSTEP_INLINE void measure_row(const ClosureSource& source, bool raised, const Number& c, Number& r, Number& size,
                                 Side&& side) {
  using bodies::magnitude, bodies::square_root, bodies::dot;
  const double normal = std::numeric_limits<double>::min();  // squares below it may have vanished
  Number sum = -c, sizes = magnitude(c), bound{};
  for (int i = 0; i < source.n_sides; ++i)
    side(
        static_cast<std::size_t>(source.first_side + i), [&](const auto& J,
                                                             const auto& a) __attribute__((always_inline)) {
          const Number x = dot(J, a);
          sum += x, sizes += magnitude(x);
          if (!raised) return;
          const auto [f2, t2] = squares(J);
          const auto [a2, al2] = squares(a);
          bound += square_root(f2 * a2 + normal) + square_root(t2 * al2 + normal);
        });
  const Number least = kScaleFloor * bound;
  r = sum, size = sizes < least ? least : sizes;
}

/// What a tree without closures does in their place.
struct NoRows {
  template <class Inertia>
  LOCKSTEP_INLINE void close(std::size_t, Inertia&) const {}
  template <class Joint>
  LOCKSTEP_INLINE void pass_on(std::size_t, const Joint&) const {}
  LOCKSTEP_INLINE void close_at_ground() const {}
  LOCKSTEP_INLINE std::nullptr_t less(std::size_t, int) const { return nullptr; }
  template <class Twist>
  LOCKSTEP_INLINE void find(std::size_t, const Twist&) const {}
};

}  // namespace lockstep
