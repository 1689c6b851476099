#include "framework/dynamics/tree/articulated.h"

#include <algorithm>

#include <Eigen/Cholesky>

#include "framework/dynamics/tree/tree_motion.h"
#include "framework/foundation/math/for_size.h"

namespace lockstep {

namespace {

// r~ B and B r~, 18 products each: skew(r) has zeros.
LOCKSTEP_INLINE Mat3 cross_columns(const Vec3& r, const Mat3& B) {
  Mat3 out;
  out.row(0) = r[1] * B.row(2) - r[2] * B.row(1);
  out.row(1) = r[2] * B.row(0) - r[0] * B.row(2);
  out.row(2) = r[0] * B.row(1) - r[1] * B.row(0);
  return out;
}
LOCKSTEP_INLINE Mat3 columns_cross(const Mat3& B, const Vec3& r) {
  Mat3 out;
  out.col(0) = r[2] * B.col(1) - r[1] * B.col(2);
  out.col(1) = r[0] * B.col(2) - r[2] * B.col(0);
  out.col(2) = r[1] * B.col(0) - r[0] * B.col(1);
  return out;
}

// Adds the inertia and the bias of a reduced node to its parent's, about the parent's mass centre; p + IA c is its bias.
template <class N>
LOCKSTEP_INLINE void pass_on(const N& b, N& parent) {
  const Vec3 pf = b.pf + b.M * b.ca + b.H * b.cal;
  const Vec3 pt = b.pt + b.H.transpose() * b.ca + b.I * b.cal;
  const Mat3 MS = columns_cross(b.M, b.r), SH = cross_columns(b.r, b.H);
  parent.M += b.M;
  parent.H += b.H - MS;
  parent.I += b.I + SH + SH.transpose() - cross_columns(b.r, MS);
  parent.pf += pf;
  parent.pt += pt + cross(b.r, pf);
}

}  // namespace

void ArticulatedBodies::begin(const JointTree& tree, const System& system) {
  nodes_.resize(tree.nodes().size());
  dofs_.resize(static_cast<std::size_t>(tree.n_v()));
  std::size_t size = 0;
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const TreeNode& n = tree.nodes()[k];
    nodes_[k].m = system.slot(n.slot).mass, nodes_[k].J = system.slot(n.slot).J;
    nodes_[k].D_1 = size;
    size += static_cast<std::size_t>(n.n_v() * n.n_v());
  }
  inverse_.resize(size);
}

LOCKSTEP_FLAT_CLONES void ArticulatedBodies::outward(const JointTree& tree, const State& y,
                                                     std::vector<Motion>& motions) {
  motions.resize(nodes_.size() + 1);
  const Vec3 still = Vec3::Zero();
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const TreeNode& n = tree.nodes()[k];
    const bool root = n.parent < 0;
    const std::size_t parent = static_cast<std::size_t>(std::max(n.parent, 0));
    const Motion& p = motions[root ? 0 : static_cast<std::size_t>(tree.nodes()[parent].slot + 1)];
    const Vec3& wp = root ? still : nodes_[parent].w;
    Motion& own = motions[static_cast<std::size_t>(n.slot + 1)];
    Node& b = nodes_[k];
    const Carried c = carry(n, y.q.data() + n.first_q, y.v.data() + n.first_v, p, wp, own);
    b.w = c.w;
    b.r = c.d1 + c.d2;
    // al = al_p + cal,  a = a_p + al_p x r + ca
    b.cal = cross(wp, c.turn);
    b.ca = cross(wp, cross(wp, c.d1)) + cross(c.w, cross(c.w, c.d2)) + cross(b.cal, c.d2);
    if (n.n_slides > 0) b.ca += 2.0 * cross(n.reversed ? c.w : wp, c.slide);
    Dof* dof = dofs_.data() + n.first_v;
    for (int i = 0; i < n.n_slides; ++i, ++dof)
      dof->l = slide_axes(n, p, own) * n.slide[static_cast<std::size_t>(i)], dof->n.setZero();
    for (int i = 0; i < n.n_v() - n.n_slides; ++i, ++dof)
      dof->n = c.turn_axes.col(i), dof->l = cross(dof->n, c.d2);
  }
}

// U = IA S, D = S' U, u = -S' p
template <int k>
void ArticulatedBodies::eliminate(const TreeNode& n, Node& b) {
  Dof* dof = dofs_.data() + n.first_v;
  for (int i = 0; i < k; ++i) {
    dof[i].Uf = b.M * dof[i].l + b.H * dof[i].n;
    dof[i].Ut = b.H.transpose() * dof[i].l + b.I * dof[i].n;
    dof[i].u = -(dof[i].l.dot(b.pf) + dof[i].n.dot(b.pt));
  }
  double* inverse = inverse_.data() + b.D_1;
  if constexpr (k == 1) {
    inverse[0] = 1.0 / (dof->l.dot(dof->Uf) + dof->n.dot(dof->Ut));
  } else if constexpr (k > 1) {
    Eigen::Matrix<double, k, k> D = Eigen::Matrix<double, k, k>::Zero();
    for (int i = 0; i < k; ++i)
      for (int j = 0; j <= i; ++j) D(i, j) = dof[i].l.dot(dof[j].Uf) + dof[i].n.dot(dof[j].Ut);
    Eigen::Map<Eigen::Matrix<double, k, k>> out(inverse);
    out = D.template selfadjointView<Eigen::Lower>().llt().solve(Eigen::Matrix<double, k, k>::Identity());
  }
}

// IA <- IA - U D^-1 U', p <- p + U D^-1 u
template <int k>
void ArticulatedBodies::reduce(const TreeNode& n, Node& b) {
  const Dof* dof = dofs_.data() + n.first_v;
  const double* inverse = inverse_.data() + b.D_1;
  for (int i = 0; i < k; ++i) {
    Vec3 Vf = dof[0].Uf * inverse[i], Vt = dof[0].Ut * inverse[i];  // column i of U D^-1
    for (int j = 1; j < k; ++j) Vf += dof[j].Uf * inverse[k * j + i], Vt += dof[j].Ut * inverse[k * j + i];
    b.M -= Vf * dof[i].Uf.transpose();
    b.H -= Vf * dof[i].Ut.transpose();
    b.I -= Vt * dof[i].Ut.transpose();
    b.pf += Vf * dof[i].u, b.pt += Vt * dof[i].u;
  }
}

// vd = D^-1 (u - U' a'), a' = (a_p + al_p x r + ca, al_p + cal)
template <int k>
void ArticulatedBodies::solve(const TreeNode& n, Node& b, VecX& vd) {
  const Dof* dof = dofs_.data() + n.first_v;
  const double* inverse = inverse_.data() + b.D_1;
  double left[k];
  for (int i = 0; i < k; ++i) left[i] = dof[i].u - dof[i].Uf.dot(b.a) - dof[i].Ut.dot(b.al);
  for (int i = 0; i < k; ++i) {
    double x = 0;
    for (int j = 0; j < k; ++j) x += inverse[k * i + j] * left[j];
    vd[n.first_v + i] = x;
  }
  for (int i = 0; i < k; ++i) b.a += dof[i].l * vd[n.first_v + i], b.al += dof[i].n * vd[n.first_v + i];
}

LOCKSTEP_FLAT_CLONES void ArticulatedBodies::accelerate(const JointTree& tree, std::span<const Motion> motions,
                                                        const VecX& f, VecX& vd) {
  vd.resize(tree.n_v());
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const TreeNode& n = tree.nodes()[k];
    Node& b = nodes_[k];
    const Mat3& A = motions[static_cast<std::size_t>(n.slot + 1)].A;
    b.M = b.m * Mat3::Identity();
    b.H.setZero();
    b.I = A * b.J * A.transpose();
    b.pf = -f.segment<3>(6 * n.slot);
    b.pt = -(A * f.segment<3>(6 * n.slot + 3));
  }
  for (std::size_t k = nodes_.size(); k-- > 0;) {
    const TreeNode& n = tree.nodes()[k];
    Node& b = nodes_[k];
    const bool root = n.parent < 0;
    if (n.n_v() > 0)  // else a weld that was kept
      for_size<1, 6>(n.n_v(), [&](auto count) {
        eliminate<count>(n, b);
        if (!root) reduce<count>(n, b);
      });
    if (!root) pass_on(b, nodes_[static_cast<std::size_t>(n.parent)]);
  }
  double a2 = 0, al2 = 0;
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const TreeNode& n = tree.nodes()[k];
    Node& b = nodes_[k];
    b.a = b.ca, b.al = b.cal;
    if (n.parent >= 0) {
      const Node& p = nodes_[static_cast<std::size_t>(n.parent)];
      b.a += p.a + cross(p.al, b.r), b.al += p.al;
    }
    if (n.n_v() > 0) for_size<1, 6>(n.n_v(), [&](auto count) { solve<count>(n, b, vd); });
    a2 = std::max(a2, b.a.squaredNorm()), al2 = std::max(al2, b.al.squaredNorm());
  }
  largest_a_ = std::sqrt(a2), largest_alpha_ = std::sqrt(al2);
}

}  // namespace lockstep
