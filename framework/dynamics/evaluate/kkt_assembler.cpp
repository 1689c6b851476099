// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/dynamics.h>

#include <lockstep/error.h>
#include "framework/dynamics/evaluate/loop_rows.h"

namespace lockstep {

void KktAssembler::lay_out_direct(const RowTable& rows) {
  KktPattern& p = kkt_.pattern;
  p = {};
  const int n = system_.n_slots();
  p.rows = &rows;
  p.n = 6 * n, p.m = rows.n_rows;
  p.width.assign(n, 6);
  kkt_.masses.clear();
  p.plane = system_.plane();
  for (int k = 0; k < n; ++k) {
    const Slot& s = system_.slot(k);
    kkt_.masses.push_back({s.mass, s.J, s.freedoms == Freedoms::particle});
  }
}

void KktAssembler::equal_masses(const LoopSizes& loops) {
  for (int k = 0; k < system_.n_slots(); ++k) {
    SlotMass& slot = kkt_.masses[k];
    slot = {1.0, loops.length(k) * loops.length(k) * Mat3::Identity(), slot.particle};
  }
}

void KktAssembler::lay_out(const RowTable& rows, bool direct) {
  if (direct && formulation_ == Formulation::quaternion)
    throw ModelError(
        "formulation quaternion has seven coordinates per body, which this solver does not support; use solver sparse, "
        "block or dense");
  if (direct) return lay_out_direct(rows);
  if (system_.plane() && formulation_ == Formulation::quaternion)
    throw ModelError(
        "formulation quaternion has seven coordinates per body and does not support \"planar\"; use formulation omega, "
        "or set \"planar\" to \"off\"");
  KktPattern& p = kkt_.pattern;
  p = {};
  const int n = system_.n_slots();
  masses_.clear();
  for (int k = 0; k < n; ++k) {
    const BodyMass& mass = masses_.emplace_back(system_.slot(k), system_.plane());
    const int width = formulation_ == Formulation::quaternion && mass.width() == 6 ? 7 : mass.width();
    p.width.push_back(width);
    p.first.push_back(p.n);
    p.M.push_back(p.size_M);
    p.n += width;
    p.size_M += width * width;
  }
  const auto add = [&](KktLink link) {
    link.J = p.size_J;
    for (int i = 0; i < link.n_slots; ++i) p.size_J += static_cast<std::size_t>(link.m * p.width[link.slot[i]]);
    link.first_row = p.m;
    p.m += link.m;
    p.links.push_back(link);
  };
  for (const RowEntry& e : rows.entries) add({e.link, 0, e.m, e.slots.n, e.slots.slot, e.kind, 0});
  n_links_ = static_cast<int>(p.links.size());
  if (formulation_ == Formulation::quaternion)
    for (int k = 0; k < n; ++k)
      if (p.width[k] == 7) add({-1, 0, 1, 1, {k}, {RowKind::function}, 0});

  kkt_.M.assign(p.size_M, 0.0);
  kkt_.Minv.assign(p.size_M, 0.0);
  kkt_.J.assign(p.size_J, 0.0);
  kkt_.E.setZero(p.m);
  for (int k = 0; k < n; ++k) write_mass(k, Motion{});
}

void KktAssembler::write_mass(int slot, const Motion& O) {
  const int width = kkt_.pattern.width[slot];
  const BodyMass& mass = masses_[slot];
  double *M = kkt_.M.data() + kkt_.pattern.M[slot], *inverse = kkt_.Minv.data() + kkt_.pattern.M[slot];
  if (width != 7) return mass.write_blocks(M, inverse);
  // (2.7) with k = the mean of the three eigenvalues 4 J of G^T J G
  const Mat34 G = G_matrix(O.e);
  const Vec4 q = O.e.coefficients();
  const double c = 4.0 / 3.0 * mass.J().trace();
  Eigen::Map<Eigen::Matrix<double, 7, 7>> M7(M), inverse7(inverse);  // symmetric
  M7.topLeftCorner<3, 3>() = mass.m() * Mat3::Identity();
  inverse7.topLeftCorner<3, 3>() = 1.0 / mass.m() * Mat3::Identity();
  M7.bottomRightCorner<4, 4>() = G.transpose() * mass.J() * G + c * q * q.transpose();
  inverse7.bottomRightCorner<4, 4>() = G.transpose() * mass.inverse_J() * G / 16.0 + q * q.transpose() / c;
}

void KktAssembler::read(const RowTable& rows) {
  if (direct()) kkt_.pattern.rows = &rows;
}

void KktAssembler::update(const RowTable& rows, std::span<const Motion> motions) {
  if (direct()) return read(rows);
  const KktPattern& p = kkt_.pattern;
  if (formulation_ == Formulation::quaternion)
    for (int k = 0; k < system_.n_slots(); ++k)
      if (p.width[k] == 7) write_mass(k, motions[k + 1]);

  const std::array<int, 6> columns = unknown_velocities(system_.plane());
  for (int l = 0; l < static_cast<int>(p.links.size()); ++l) {
    const KktLink& link = p.links[l];
    double* out = kkt_.J.data() + link.J;
    if (l >= n_links_) {  // (2.6) Nq = q^T
      const Quat& q = motions[link.slot[0] + 1].e;
      out[0] = out[1] = out[2] = 0.0;
      out[3] = q.w, out[4] = q.x, out[5] = q.y, out[6] = q.z;
      continue;
    }
    const RowView block = rows.block(rows.entries[l]);
    for (int i = 0; i < link.n_slots; ++i) {
      const int slot = link.slot[i], width = p.width[slot];
      for (int k = 0; k < link.m; ++k, out += width) {
        const auto r = block.J(i, k);
        if (width <= 6) {
          for (int c = 0; c < width; ++c) out[c] = r[columns[c]];
          continue;
        }
        out[0] = r[0], out[1] = r[1], out[2] = r[2];
        const Quat& q = motions[slot + 1].e;  // (2.12) Jh_w G
        const double a = 2 * r[3], b = 2 * r[4], c = 2 * r[5];
        out[3] = -a * q.x - b * q.y - c * q.z;
        out[4] = a * q.w - b * q.z + c * q.y;
        out[5] = a * q.z + b * q.w - c * q.x;
        out[6] = -a * q.y + b * q.x + c * q.w;
      }
    }
  }
  kkt_.update_scales();
}

void KktAssembler::load(const VecX& f6, const VecX& c6, std::span<const Motion> motions, bool moving, VecX& f,
                        VecX& c) const {
  const KktPattern& p = kkt_.pattern;
  f.resize(p.n);
  c.resize(p.m);
  c.head(c6.size()) = c6;
  int norm_row = static_cast<int>(c6.size());
  const std::array<int, 6> columns = unknown_velocities(system_.plane());
  for (int k = 0; k < system_.n_slots(); ++k) {
    const int at = p.first[k], width = p.width[k];
    if (width <= 6) {
      for (int i = 0; i < width; ++i) f[at + i] = f6[6 * k + columns[i]];
      continue;
    }
    f.segment<3>(at) = f6.segment<3>(6 * k);
    const Motion& O = motions[k + 1];
    const Vec3 tau = f6.segment<3>(6 * k + 3);
    if (!moving) {
      f.segment<4>(at + 3) = G_matrix(O.e).transpose() * tau;
      c[norm_row++] = 0.0;
      continue;
    }
    // (2.4), (2.5): G^T tau - 2 G(qd)^T J w, with the moment tau without the -w x J w of the 6-velocity form
    const Slot& b = system_.slot(k);
    const Vec3 Jw = b.J * O.w;
    const Quat qd = rate(O.e, O.w);
    const double qd2 = norm2(qd), kq = 4.0 / 3.0 * b.J.trace();
    f.segment<4>(at + 3) = G_matrix(O.e).transpose() * (tau + cross(O.w, Jw)) - 2.0 * G_matrix(qd).transpose() * Jw -
                           kq * qd2 * O.e.coefficients();
    c[norm_row++] = -qd2;  // (2.6)
  }
}

void KktAssembler::unload(const VecX& a, const VecX& lambda, std::span<const Motion> motions, int n_rows, VecX& a6,
                          VecX& lambda6) const {
  const KktPattern& p = kkt_.pattern;
  lambda6 = lambda.head(n_rows);
  const std::array<int, 6> columns = unknown_velocities(system_.plane());
  for (int k = 0; k < system_.n_slots(); ++k) {
    const int at = p.first[k], width = p.width[k];
    if (width <= 6) {
      a6.segment<6>(6 * k).setZero();
      for (int c = 0; c < width; ++c) a6[6 * k + columns[c]] = a[at + c];
      continue;
    }
    a6.segment<3>(6 * k) = a.segment<3>(at);
    // (1.9) al = G qdd
    a6.segment<3>(6 * k + 3) = G_matrix(motions[k + 1].e) * a.segment<4>(at + 3);
  }
}

}  // namespace lockstep
