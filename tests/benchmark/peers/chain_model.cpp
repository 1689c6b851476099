// SPDX-License-Identifier: BSD-3-Clause
#include "tests/benchmark/peers/chain_model.h"

#include <cmath>

namespace lockstep::peers {

ChainModel::ChainModel(const Mechanism& m) : mechanism_(m), links_(static_cast<std::size_t>(m.n)) {
  const Real g = 9.81L;  // the decimal, not its double
  gravity_ = m.kind == Kind::spatial_chain ? V3(0, -g * 0.8L, -g * 0.6L) : V3(0, -g, 0);
}

void ChainModel::turn(const RealVector& y) {
  const std::size_t n = links_.size();
  for (std::size_t k = 0; k < n; ++k) {
    Link& l = links_[k];
    const M3 R = k > 0 ? links_[k - 1].R : M3(M3::Identity());
    const Real s = std::sin(y[k]), c = std::cos(y[k]);
    const int a = turns_about_y(mechanism_, static_cast<int>(k)) ? 1 : 2;
    l.axis = R.col(a);
    l.R.col(a) = R.col(a);
    const int i = (a + 1) % 3, j = (a + 2) % 3;
    l.R.col(i) = c * R.col(i) + s * R.col(j);
    l.R.col(j) = c * R.col(j) - s * R.col(i);
    l.w = l.axis * y[n + k];
    if (k > 0) l.w += links_[k - 1].w;
    l.c = l.R.col(0) / 2;
  }
}

// About the joint: A = J - m c~ c~, B = m c~, C = m 1; bias: w x A w - m c x g and m (w x (w x c) - g); m = 1 kg.
void ChainModel::own_inertia(const RealVector& y, int k) {
  Link& l = links_[k];
  const Real transverse = 1.0L / 12 + 0.25L, axial = 1e-2L;
  const V3 d = l.R.col(0);
  l.A = transverse * M3::Identity() + (axial - transverse) * d * d.transpose();
  l.B = skew(l.c);
  l.C = M3::Identity();
  l.z_n = cross(l.w, l.A * l.w) - cross(l.c, gravity_);
  l.z_f = cross(l.w, cross(l.w, l.c)) - gravity_;
  l.a_n = l.a_f = V3::Zero();
  if (k == 0) return;
  const Link& parent = links_[k - 1];
  l.a_n = cross(parent.w, l.axis * y[links_.size() + k]);
  l.a_f = cross(parent.w, cross(parent.w, 2 * parent.c));
}

// The joint lets its axis go free; what is left is moved to the parent's joint, r further back.
void ChainModel::fold_into_parent(int k) {
  Link& l = links_[k];
  l.U_n = l.A * l.axis;
  l.U_f = l.B.transpose() * l.axis;
  l.D = l.axis.dot(l.U_n);
  V3 z_n = l.A * l.a_n + l.B * l.a_f + l.z_n;
  V3 z_f = l.B.transpose() * l.a_n + l.C * l.a_f + l.z_f;
  l.load = l.axis.dot(z_n);
  if (k == 0) return;
  z_n -= l.U_n * (l.load / l.D);
  z_f -= l.U_f * (l.load / l.D);
  const M3 A = l.A - l.U_n * l.U_n.transpose() / l.D;
  const M3 B = l.B - l.U_n * l.U_f.transpose() / l.D;
  const M3 C = l.C - l.U_f * l.U_f.transpose() / l.D;
  Link& parent = links_[k - 1];
  const V3 r = 2 * parent.c;
  const M3 rx = skew(r), Brx = B * rx;
  parent.A += A - Brx - Brx.transpose() - rx * C * rx;
  parent.B += B + rx * C;
  parent.C += C;
  parent.z_n += z_n + cross(r, z_f);
  parent.z_f += z_f;
}

void ChainModel::accelerate(const RealVector& y, RealVector& dy) {
  const std::size_t n = links_.size();
  V3 a_n = V3::Zero(), a_f = V3::Zero();
  for (std::size_t k = 0; k < n; ++k) {
    Link& l = links_[k];
    if (k > 0) a_f += cross(a_n, 2 * links_[k - 1].c);
    const Real qdd = -(l.load + l.U_n.dot(a_n) + l.U_f.dot(a_f)) / l.D;
    a_n += l.a_n + l.axis * qdd;
    a_f += l.a_f;
    dy[k] = y[n + k];
    dy[n + k] = qdd;
  }
}

void ChainModel::rate(const RealVector& y, RealVector& dy) {
  turn(y);
  const int n = static_cast<int>(links_.size());
  for (int k = 0; k < n; ++k) own_inertia(y, k);
  for (int k = n - 1; k >= 0; --k) fold_into_parent(k);
  accelerate(y, dy);
}

Positions ChainModel::positions(const RealVector& y) {
  turn(y);
  Positions x;
  V3 joint = V3::Zero();
  for (const Link& l : links_) {
    x.push_back((joint + l.c).cast<double>());
    joint += 2 * l.c;
  }
  return x;
}

}  // namespace lockstep::peers
