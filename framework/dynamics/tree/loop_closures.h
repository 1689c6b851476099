// LoopClosures: the rows of links that are not in the tree, eliminated along with the recursion
// (framework/docs/solvers.md, section 9).
#pragma once

#include <array>
#include <span>
#include <vector>

#include <lockstep/rows.h>
#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/dynamics/tree/articulated.h"
#include "framework/dynamics/tree/column_algebra.h"
#include "framework/dynamics/tree/joint_tree.h"

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
/// and outward  lambda_j = (K_j a + l_j - sum of Lambda_ij lambda_i) / d.  E is a proximal term, corrected away.
class LoopClosures {
 public:
  /// Sizes everything for this tree and the rows of its closures.
  void begin(const JointTree&, const System&, const RowTable&);
  bool empty() const { return sources_.empty(); }

  /// Reads the rows, gathered at these motions; their right sides c are Qhat.
  void read(const JointTree&, std::span<const Motion> motions, const RowTable&);
  /// c <- c - x
  void subtract(const VecX& x);
  /// The residuals C and J v + Ct of rows gathered at these motions, one per row of the table.
  void residuals(std::span<const Motion> motions, const RowTable&, VecX& C, VecX& Cd) const;
  /// The largest number of c, one per row: as Evaluation::norm measures it.
  double norm(const VecX& c) const;

  /// After ArticulatedBodies::accelerate(): measures J a - c, and says whether it is small enough.
  bool met(const ArticulatedBodies&);
  double residual() const { return worst_; }  ///< the largest that met() has measured, relative to its scale
  /// Finds the change of the accelerations by which what met() has measured vanishes.
  void correct(const JointTree&, const ArticulatedBodies&, VecX& dvd);
  /// The change of the velocities by which these residuals vanish: J (change) = -r, of least kinetic energy.
  void correct(const JointTree&, const ArticulatedBodies&, const VecX& r, VecX& dv);
  /// Fills in residual, worst row, pivots and detector.
  void complete(SolveReport&);

  /// Writes what was learned of the pivots, and takes it back; of other rows nothing is taken.
  void save(Snapshot&) const;
  void restore(const Snapshot&);

  const VecX& lambda() const { return lambda_; }  ///< one per row of the table
  /// Adds what the closures do to forces of the slots: f <- f - J' lambda.
  void react(const RowTable&, VecX& f) const;

  /// What the last correction changes at a node, world axes.
  struct alignas(kColumn) Change {
    Column a{}, al{};
  };
  const Change& change(std::size_t node) const { return changes_[node]; }

  // Called by the recursion at node k.
  template <class Inertia>
  void close(std::size_t k, Inertia&);
  void pass_on(std::size_t k, int n_v, const ArticulatedBodies::Node&, const ArticulatedBodies::Dof*,
               const double* inverse);
  void close_at_ground();
  const double* less(std::size_t k, int n_v);
  void find(std::size_t k, const Column& a, const Column& al);

 private:
  struct alignas(kColumn) Row {  // K = (f, t)
    Column f{}, t{};
    double l = 0;
  };
  // The rows at a node: first those that go on to its parent, then those that end here.
  struct Front {
    int first = 0, n_open = 0, n = 0;  // places
    int Lambda = 0;                    // where its n x n numbers begin
    int V = 0;                         // where V begins: n_v numbers for each open row
  };
  // A slot of a row: its jacobian, world axes, its node and its place there.
  struct alignas(kColumn) Side {
    Column f{}, t{};
    int node = 0, place = 0;
  };
  struct Source {  // a row of the table
    int first_side = 0, n_sides = 0;
    RowKind kind = RowKind::translation;
  };
  using Rows = std::vector<int>;
  void add_front(const Rows& open, const Rows& closing, int n_v);
  void add_ground_fronts(const std::vector<Rows>& entries, const std::vector<std::vector<int>>& together);
  void link_fronts();
  void measure_diagonal(const RowTable&);
  double* Lambda(const Front& f, int i) { return Lambda_.data() + f.Lambda + i * f.n; }
  const double* Lambda(const Front& f, int i) const { return Lambda_.data() + f.Lambda + i * f.n; }
  int row_of(const Front& f, int i) const { return row_of_[static_cast<std::size_t>(f.first + i)]; }
  int place_above(const Front& f, int i) const { return above_[static_cast<std::size_t>(f.first + i)]; }
  template <bool kAtGround>
  void eliminate(const Front&, int j);
  void add_to_parent(std::size_t k);
  double multiplier(const Front&, int j, double with, const VecX& lambda) const;
  void inward_again(const JointTree&, const ArticulatedBodies&, const VecX& r);
  void outward_again(const JointTree&, const ArticulatedBodies&, VecX& dv);

  // By node, then those of the ground: one for each link that ends there, in the order of their elimination.
  std::vector<Front> fronts_;
  std::vector<std::size_t> parents_;  // of each front the one that its open rows go to
  std::size_t n_nodes_ = 0;
  std::vector<Row> rows_;      // by place
  std::vector<int> row_of_, above_;  // of each place: the row of the table, the place at the parent (open rows)
  std::vector<double> Lambda_, V_;
  std::vector<Side> sides_;
  std::vector<Source> sources_;
  std::vector<Mat3> inverse_inertia_;  // by node, slot axes
  std::vector<double> inverse_mass_;
  VecX c_, E_, diagonal_, scale_, d_, lambda_, r_, size_;  // by row; scale_: s_j
  // Of a correction: by place, by node, by row, by coordinate.
  std::vector<double> l_;
  std::vector<Row> wrenches_;
  std::vector<Change> changes_;
  VecX dlambda_, du_;
  std::array<double, 6> less_{};
  PivotWatch watch_;
  std::array<double, 3> pivot_floors_{};
  bool floors_known_ = false;
  double length_ = 1, worst_ = 0;
  int worst_row_ = -1;
};

// What the recursion is compiled with.

// Lambda is symmetric: what is right of the diagonal is neither written nor read. At the ground nothing moves, and K is
// of no interest.
template <bool kAtGround>
LOCKSTEP_INLINE void LoopClosures::eliminate(const Front& front, int j) {
  constexpr double kLeast = 1e-14;  // of the scale: what rounding may leave of a pivot
  const int row = row_of(front, j);
  Row* rows = rows_.data() + front.first;
  const double* at = Lambda(front, j);
  const double d = std::max(at[j] + E_[row], kLeast * scale_[row]), d_1 = 1.0 / d;
  d_[row] = d;
  for (int i = 0; i < j; ++i) {
    const double x = at[i] * d_1;
    if constexpr (!kAtGround) rows[i].f -= rows[j].f * x, rows[i].t -= rows[j].t * x;
    rows[i].l -= rows[j].l * x;
    double* to = Lambda(front, i);
    for (int k = 0; k <= i; ++k) to[k] -= x * at[k];
  }
}

template <class Inertia>
LOCKSTEP_INLINE void LoopClosures::close(std::size_t k, Inertia& I) {
  const Front& front = fronts_[k];
  for (int j = front.n - 1; j >= front.n_open; --j) {
    eliminate<false>(front, j);
    const Row& row = rows_[static_cast<std::size_t>(front.first + j)];
    const double w = -1.0 / d_[row_of(front, j)];
    const Column f = row.f * w, t = row.t * w;
    subtract_dyad(I.M, f, row.f), subtract_dyad(I.H, f, row.t);
    subtract_dyad(I.H_t, t, row.f), subtract_dyad(I.I, t, row.t);
    I.pf -= f * row.l, I.pt -= t * row.l;
  }
}

// Adds the open rows of a front to those of its parent.
LOCKSTEP_INLINE void LoopClosures::add_to_parent(std::size_t k) {
  const Front &front = fronts_[k], &up = fronts_[parents_[k]];
  const int* above = above_.data() + front.first;
  for (int i = 0; i < front.n_open; ++i) {
    const Row& row = rows_[static_cast<std::size_t>(front.first + i)];
    Row& there = rows_[static_cast<std::size_t>(above[i])];
    there.f += row.f, there.t += row.t, there.l += row.l;
    const double* from = Lambda(front, i);
    const int at = above[i] - up.first;
    for (int j = 0; j <= i; ++j) {
      const int to = above[j] - up.first;
      (to <= at ? Lambda(up, at)[to] : Lambda(up, to)[at]) += from[j];
    }
  }
}

LOCKSTEP_INLINE void LoopClosures::close_at_ground() {
  for (std::size_t k = n_nodes_; k < fronts_.size(); ++k) {
    const Front& front = fronts_[k];
    for (int j = front.n - 1; j >= front.n_open; --j) eliminate<true>(front, j);
    if (front.n_open > 0) add_to_parent(k);
  }
  for (std::size_t k = fronts_.size(); k-- > n_nodes_;) {
    const Front& front = fronts_[k];
    for (int j = front.n_open; j < front.n; ++j) {
      const double l = rows_[static_cast<std::size_t>(front.first + j)].l;
      lambda_[row_of(front, j)] = multiplier(front, j, l, lambda_);
    }
  }
}

LOCKSTEP_INLINE void LoopClosures::pass_on(std::size_t k, int n_v, const ArticulatedBodies::Node& b,
                                           const ArticulatedBodies::Dof* dof, const double* inverse) {
  const Front& front = fronts_[k];
  if (front.n_open == 0) return;
  double kappa[6];
  for (int i = 0; i < front.n_open; ++i) {
    Row& row = rows_[static_cast<std::size_t>(front.first + i)];
    double* V = V_.data() + front.V + i * n_v;
    for (int x = 0; x < n_v; ++x) kappa[x] = dot(row.f, dof[x].l) + dot(row.t, dof[x].n);
    for (int x = 0; x < n_v; ++x) {
      V[x] = 0;
      for (int y = 0; y < n_v; ++y) V[x] += inverse[n_v * x + y] * kappa[y];
      row.f -= dof[x].Uf * V[x], row.t -= dof[x].Ut * V[x], row.l += V[x] * dof[x].u;
    }
    for (int j = 0; j <= i; ++j) {
      const double* Vj = V_.data() + front.V + j * n_v;
      double sum = 0;
      for (int x = 0; x < n_v; ++x) sum += kappa[x] * Vj[x];
      Lambda(front, i)[j] += sum;
    }
    row.l += dot(row.f, b.ca) + dot(row.t, b.cal);
    row.t += Skew(b.r) * row.f;
  }
  add_to_parent(k);
}

// lambda_j = (K_j a + l_j - sum of Lambda_ij lambda_i) / d_j over the rows that were eliminated later; `with`: K_j a + l_j
LOCKSTEP_INLINE double LoopClosures::multiplier(const Front& front, int j, double with, const VecX& lambda) const {
  const double* at = Lambda(front, j);
  for (int i = 0; i < j; ++i) with -= at[i] * lambda[row_of(front, i)];
  return with / d_[row_of(front, j)];
}

LOCKSTEP_INLINE const double* LoopClosures::less(std::size_t k, int n_v) {
  const Front& front = fronts_[k];
  if (front.n_open == 0) return nullptr;
  less_.fill(0.0);
  for (int i = 0; i < front.n_open; ++i) {
    const double x = lambda_[row_of(front, i)];
    for (int v = 0; v < n_v; ++v) less_[static_cast<std::size_t>(v)] += V_[static_cast<std::size_t>(front.V + i * n_v + v)] * x;
  }
  return less_.data();
}

LOCKSTEP_INLINE void LoopClosures::find(std::size_t k, const Column& a, const Column& al) {
  const Front& front = fronts_[k];
  for (int j = front.n_open; j < front.n; ++j) {
    const Row& row = rows_[static_cast<std::size_t>(front.first + j)];
    lambda_[row_of(front, j)] = multiplier(front, j, row.l + dot(row.f, a) + dot(row.t, al), lambda_);
  }
}

}  // namespace lockstep
