// LoopClosures: the rows of links that are not in the tree, eliminated along with the recursion
// (framework/docs/solvers.md, section 9).
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include <lockstep/rows.h>
#include "framework/dynamics/tree/closure_rows.h"

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
/// Accelerations are Twists, K and forces are Wrenches: in space or in a plane. What depends on which, the Bodies of the
/// recursion do:
///
///     read_side(view, i, k, node, motion)  the jacobian of row k on the i-th slot, and what it adds to J M^-1 J'
///     move_to_joint(node, K)               takes K from the mass centre to the node's point; returns what l gains
///     acceleration(node)                   of the mass centre
///     joint(tree, node)                    the passes through the node's joint:
///         pass(K, l, kappa, V), pass_again(p, u), solve_again(parent, u, less, dv)
template <class Wrench, class Twist>
class LoopClosures final : public ClosureRows {
 public:
  /// Sizes everything for this tree and the rows of its closures.
  void begin(const JointTree&, const System&, ClosureFronts);

  /// Reads the rows, gathered at these motions; their right sides c are Qhat. After the bodies' outward pass.
  template <class Bodies>
  void read(const Bodies&, std::span<const Motion> motions, const RowTable&);
  /// After the recursion, or a correction: measures J a - c, and says whether it is small enough.
  template <class Bodies>
  bool met(const Bodies&, bool corrected);
  /// Finds the change of the velocities by which these residuals vanish: J (change) = -r, of least kinetic energy.
  template <class Bodies>
  void correct(const Bodies&, const JointTree&, const VecX& r, VecX& dv);
  const VecX& measured() const { return r_; }     ///< the residuals that met() has measured
  void add_correction() { lambda_ += dlambda_; }  ///< of them, as found last
  /// What the last correction changes at a node.
  const Twist& change(std::size_t node) const { return changes_[node]; }

  // Called by the recursion at node k. joint: as above.
  template <class Inertia>
  void close(std::size_t k, Inertia&);
  template <class Joint>
  void pass_on(std::size_t k, int n_v, const Joint& joint);
  void close_at_ground();
  const double* less(std::size_t k, int n_v) { return less(k, n_v, lambda_); }  // V' lambda; null: nothing
  void find(std::size_t k, const Twist& a) { find(k, a, lambda_); }

 private:
  template <class Bodies>
  void raise_sizes(const Bodies&);
  bool has_parent(std::size_t node) const { return fronts_.parents[node] < fronts_.n_nodes; }
  void close_again(const ClosureFront&, Wrench* p);
  template <class Bodies>
  void inward_again(const Bodies&, const JointTree&, const VecX& r);
  template <class Bodies>
  void outward_again(const Bodies&, const JointTree&, VecX& dv);
  template <bool kAtGround>
  void eliminate(const ClosureFront&, int j);
  void add_to_parent(std::size_t k);
  void find_at_ground(VecX& lambda);
  const double* less(std::size_t k, int n_v, const VecX& lambda);
  void find(std::size_t k, const Twist& a, VecX& lambda);

  std::vector<Wrench> K_,       // by place
      J_,                       // by side, of the slot's mass centre
      wrenches_;                // of a correction, by node
  std::vector<Twist> changes_;  // likewise
  double less_[6] = {};
};

template <class Wrench, class Twist>
void LoopClosures<Wrench, Twist>::begin(const JointTree& tree, const System& system, ClosureFronts fronts) {
  const auto mass = [&](const TreeNode& n) { return system.slot(n.slot).mass; };
  const auto [lightest, heaviest] = std::ranges::minmax_element(tree.nodes(), {}, mass);
  ClosureRows::begin(std::move(fronts), system.length(), mass(*heaviest) / mass(*lightest));
  K_.assign(fronts_.rows.size(), {}), J_.assign(fronts_.sides.size(), {});
  wrenches_.assign(fronts_.n_nodes, {}), changes_.assign(fronts_.n_nodes, {});
  du_.setZero(tree.n_v());
}

template <class Wrench, class Twist>
template <class Bodies>
LOCKSTEP_INLINE void LoopClosures<Wrench, Twist>::read(const Bodies& bodies, std::span<const Motion> motions,
                                                       const RowTable& table) {
  std::ranges::fill(K_, Wrench{});
  std::ranges::fill(l_, 0.0);
  std::ranges::fill(Lambda_, 0.0);
  diagonal_.setZero();
  n_small_ = 0;
  double arm2 = 0;
  for (const RowEntry& e : table.entries) {
    const RowView block = table.block(e);
    for (int k = 0; k < e.m; ++k) {
      const int row = e.first_row + k;
      c_[row] = block.Qhat(k);
      const ClosureSource& source = fronts_.sources[static_cast<std::size_t>(row)];
      double l = -c_[row];
      for (int i = 0; i < source.n_sides; ++i) {
        const auto at = static_cast<std::size_t>(source.first_side + i);
        const ClosureSide& side = fronts_.sides[at];
        const auto node = static_cast<std::size_t>(side.node);
        const Motion& motion = motions[static_cast<std::size_t>(e.slots[i] + 1)];
        Wrench& J = J_[at];
        J = bodies.read_side(block, i, k, node, motion, diagonal_[row]);
        if (source.kind == RowKind::translation) arm2 = std::max(arm2, moment2(J));
        Wrench K = J;
        l += bodies.move_to_joint(node, K);
        K_[static_cast<std::size_t>(side.place)] += K;
      }
      l_of(static_cast<std::size_t>(row)) = l;
    }
  }
  measure_scales(table, arm2);
}

template <class Wrench, class Twist>
template <class Bodies>
LOCKSTEP_INLINE bool LoopClosures<Wrench, Twist>::met(const Bodies& bodies, bool corrected) {
  for (std::size_t j = 0; j < fronts_.sources.size(); ++j) {
    const ClosureSource& source = fronts_.sources[j];
    const auto row = static_cast<Eigen::Index>(j);
    double r = -c_[row], size = std::abs(c_[row]);
    for (int i = 0; i < source.n_sides; ++i) {
      const auto at = static_cast<std::size_t>(source.first_side + i);
      const double x = dot(J_[at], bodies.acceleration(static_cast<std::size_t>(fronts_.sides[at].node)));
      r += x, size += std::abs(x);
    }
    r_[row] = r, size_[row] = size;
  }
  if (is_met(corrected)) return true;
  raise_sizes(bodies);
  return is_met(corrected);
}

// Where all terms of a row vanish (it is normal to a plane in which all moves), r is rounding of other directions, bounded
// in any frame by |J_f| |a| + |J_t| |al|: raised as residual_floor() raises it by energy.
template <class Wrench, class Twist>
template <class Bodies>
LOCKSTEP_INLINE void LoopClosures<Wrench, Twist>::raise_sizes(const Bodies& bodies) {
  for (std::size_t j = 0; j < fronts_.sources.size(); ++j) {
    const ClosureSource& source = fronts_.sources[j];
    double bound = 0;
    for (int i = 0; i < source.n_sides; ++i) {
      const auto at = static_cast<std::size_t>(source.first_side + i);
      const auto a = bodies.acceleration(static_cast<std::size_t>(fronts_.sides[at].node));
      bound += std::sqrt(force2(J_[at]) * linear2(a)) + std::sqrt(moment2(J_[at]) * angular2(a));
    }
    double& size = size_[static_cast<Eigen::Index>(j)];
    size = std::max(size, kScaleFloor * bound);
  }
}

// Lambda is symmetric: what is right of the diagonal is neither written nor read. At the ground nothing moves, and K is
// of no interest.
template <class Wrench, class Twist>
template <bool kAtGround>
LOCKSTEP_INLINE void LoopClosures<Wrench, Twist>::eliminate(const ClosureFront& front, int j) {
  const int row = row_of(front, j);
  Wrench* K = K_.data() + front.first;
  double* l = l_.data() + front.first;
  const double* at = Lambda(front, j);
  const bool small = at[j] < kSmallPivot * scale_[row];
  const double d = small ? std::max(at[j], 0.0) + E_[row] : at[j], d_1 = 1.0 / d;  // rounding may leave less than zero
  d_[row] = d, n_small_ += small ? 1 : 0;
  for (int i = 0; i < j; ++i) {
    const double x = at[i] * d_1;
    if constexpr (!kAtGround) K[i] -= x * K[j];
    l[i] -= l[j] * x;
    double* to = Lambda(front, i);
    for (int k = 0; k <= i; ++k) to[k] -= x * at[k];
  }
}

template <class Wrench, class Twist>
template <class Inertia>
LOCKSTEP_INLINE void LoopClosures<Wrench, Twist>::close(std::size_t k, Inertia& IA) {
  const ClosureFront& front = fronts_.all[k];
  for (int j = front.n - 1; j >= front.n_open; --j) {
    eliminate<false>(front, j);
    const auto place = static_cast<std::size_t>(front.first + j);
    IA.add_row(K_[place], l_[place], 1.0 / d_[row_of(front, j)]);
  }
}

// Adds the open rows of a front of the ground to those of its parent.
template <class Wrench, class Twist>
LOCKSTEP_INLINE void LoopClosures<Wrench, Twist>::add_to_parent(std::size_t k) {
  const ClosureFront &front = fronts_.all[k], &up = fronts_.all[fronts_.parents[k]];
  const int* above = fronts_.above.data() + front.first;
  for (int i = 0; i < front.n_open; ++i) {
    l_[static_cast<std::size_t>(up.first + above[i])] += l_[static_cast<std::size_t>(front.first + i)];
    const double* from = Lambda(front, i);
    double* to = Lambda(up, above[i]);
    for (int j = 0; j <= i; ++j) to[above[j]] += from[j];
  }
}

template <class Wrench, class Twist>
LOCKSTEP_INLINE void LoopClosures<Wrench, Twist>::close_at_ground() {
  for (std::size_t k = fronts_.n_nodes; k < fronts_.all.size(); ++k) {
    const ClosureFront& front = fronts_.all[k];
    for (int j = front.n - 1; j >= front.n_open; --j) eliminate<true>(front, j);
    if (front.n_open > 0) add_to_parent(k);
  }
  find_at_ground(lambda_);
}

template <class Wrench, class Twist>
LOCKSTEP_INLINE void LoopClosures<Wrench, Twist>::find_at_ground(VecX& lambda) {
  for (std::size_t k = fronts_.all.size(); k-- > fronts_.n_nodes;) find(k, {}, lambda);
}

// What is open goes to the parent at once: here it is not read again.
template <class Wrench, class Twist>
template <class Joint>
LOCKSTEP_INLINE void LoopClosures<Wrench, Twist>::pass_on(std::size_t k, int n_v, const Joint& joint) {
  const ClosureFront& front = fronts_.all[k];
  if (front.n_open == 0) return;
  const ClosureFront& up = fronts_.all[fronts_.parents[k]];
  const int* above = fronts_.above.data() + front.first;
  const Wrench* K = K_.data() + front.first;
  const double *l = l_.data() + front.first, *row = Lambda(front, 0);
  Wrench* K_up = K_.data() + up.first;
  double *l_up = l_.data() + up.first, *V = V_.data() + front.V, *Vi = V;
  for (int i = 0; i < front.n_open; ++i, row += front.n, Vi += n_v) {
    Wrench through = K[i];
    double with = l[i], kappa[6];
    joint.pass(through, with, kappa, Vi);
    K_up[above[i]] += through, l_up[above[i]] += with;
    double* to = Lambda(up, above[i]);
    const double* Vj = V;
    for (int j = 0; j <= i; ++j, Vj += n_v) {
      double sum = row[j];
      for (int x = 0; x < n_v; ++x) sum += kappa[x] * Vj[x];
      to[above[j]] += sum;
    }
  }
}

template <class Wrench, class Twist>
LOCKSTEP_INLINE const double* LoopClosures<Wrench, Twist>::less(std::size_t k, int n_v, const VecX& lambda) {
  const ClosureFront& front = fronts_.all[k];
  if (front.n_open == 0) return nullptr;
  for (int v = 0; v < n_v; ++v) {
    const double* V = V_.data() + front.V + v;
    less_[v] = 0;
    for (int i = 0; i < front.n_open; ++i) less_[v] += V[i * n_v] * lambda[row_of(front, i)];
  }
  return less_;
}

template <class Wrench, class Twist>
LOCKSTEP_INLINE void LoopClosures<Wrench, Twist>::find(std::size_t k, const Twist& a, VecX& lambda) {
  const ClosureFront& front = fronts_.all[k];
  for (int j = front.n_open; j < front.n; ++j) {
    const auto place = static_cast<std::size_t>(front.first + j);
    lambda[row_of(front, j)] = multiplier(front, j, l_[place] + dot(K_[place], a), lambda);
  }
}

// The elimination again, for p = 0, c = 0 and l = r.
template <class Wrench, class Twist>
template <class Bodies>
LOCKSTEP_INLINE void LoopClosures<Wrench, Twist>::correct(const Bodies& bodies, const JointTree& tree, const VecX& r,
                                                          VecX& dv) {
  inward_again(bodies, tree, r);
  outward_again(bodies, tree, dv);
}

template <class Wrench, class Twist>
LOCKSTEP_INLINE void LoopClosures<Wrench, Twist>::close_again(const ClosureFront& front, Wrench* p) {
  double* l = l_.data() + front.first;
  for (int j = front.n - 1; j >= front.n_open; --j) {
    const double* at = Lambda(front, j);
    const double x = l[j] / d_[row_of(front, j)];
    if (p) *p += x * K_[static_cast<std::size_t>(front.first + j)];
    for (int i = 0; i < j; ++i) l[i] -= at[i] * x;
  }
}

template <class Wrench, class Twist>
template <class Bodies>
LOCKSTEP_INLINE void LoopClosures<Wrench, Twist>::inward_again(const Bodies& bodies, const JointTree& tree,
                                                               const VecX& r) {
  std::ranges::fill(l_, 0.0);
  std::ranges::fill(wrenches_, Wrench{});
  for (std::size_t j = 0; j < fronts_.sources.size(); ++j) l_of(j) = r[static_cast<Eigen::Index>(j)];
  for (std::size_t k = fronts_.n_nodes; k-- > 0;) {
    const ClosureFront& front = fronts_.all[k];
    const int n_v = tree.nodes()[k].n_v();
    Wrench& p = wrenches_[k];
    close_again(front, &p);
    double* u = du_.data() + tree.nodes()[k].first_v;
    bodies.joint(tree, k).pass_again(p, u);
    for (int i = 0; i < front.n_open; ++i) {
      double l = l_[static_cast<std::size_t>(front.first + i)];
      for (int x = 0; x < n_v; ++x) l += V_[static_cast<std::size_t>(front.V + i * n_v + x)] * u[x];
      l_above(k, i) += l;
    }
    if (has_parent(k)) wrenches_[fronts_.parents[k]] += p;
  }
  for (std::size_t k = fronts_.n_nodes; k < fronts_.all.size(); ++k) {
    const ClosureFront& front = fronts_.all[k];
    close_again(front, nullptr);
    for (int i = 0; i < front.n_open; ++i) l_above(k, i) += l_[static_cast<std::size_t>(front.first + i)];
  }
  find_at_ground(dlambda_);
}

template <class Wrench, class Twist>
template <class Bodies>
LOCKSTEP_INLINE void LoopClosures<Wrench, Twist>::outward_again(const Bodies& bodies, const JointTree& tree, VecX& dv) {
  dv.resize(tree.n_v());
  for (std::size_t k = 0; k < fronts_.n_nodes; ++k) {
    const TreeNode& n = tree.nodes()[k];
    const double* by_rows = less(k, n.n_v(), dlambda_);
    changes_[k] = bodies.joint(tree, k).solve_again(has_parent(k) ? changes_[fronts_.parents[k]] : Twist{},
                                                    du_.data() + n.first_v, by_rows, dv.data() + n.first_v);
    find(k, changes_[k], dlambda_);
  }
}

/// What a tree without closures does in their place.
struct NoClosures {
  template <class Inertia>
  void close(std::size_t, Inertia&) {}
  template <class Joint>
  void pass_on(std::size_t, int, const Joint&) {}
  void close_at_ground() {}
  const double* less(std::size_t, int) const { return nullptr; }
  template <class Twist>
  void find(std::size_t, const Twist&) {}
};

}  // namespace lockstep
