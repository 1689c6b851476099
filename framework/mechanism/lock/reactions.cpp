// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/lock.h>

#include <lockstep/author/relative.h>

namespace lockstep {
namespace {

// (2.1) The generalised force -J_i^T lambda on the joint's i-th slot, with its moment about `point`.
LinkWrench on_slot(const Lock& link, const RowView& block, const RowEntry& e, const double* lambda, int i, int part,
                   const Motion& O, const Vec3& point) {
  Vec3 F = Vec3::Zero(), m = Vec3::Zero();
  for (int k = 0; k < e.m; ++k) {
    if (!Reactions::belongs(link.row(e.own[k]), part)) continue;
    const auto r = block.J(i, k);
    for (std::size_t c = 0; c < 6; ++c)  // a multiplier without a value is in the directions of its row alone
      if (r[c] != 0) (c < 3 ? F : m)[static_cast<Eigen::Index>(c % 3)] -= lambda[k] * r[c];
  }
  return {F, O.A * m - cross(Vec3(point - O.x), F)};
}

}  // namespace

// A fixed body has no Jacobian: its wrench is minus the sum of the wrenches on the others.
LinkWrench Reactions::on_body_of(const MarkerFrame& at, const Lock& link, const Inputs& in, int part) const {
  if (entry(link) < 0) return {};
  const RowEntry& e = rows_.entries[entry(link)];
  const RowView block = rows_.block(e);
  const double* lambda = lambda_.data() + e.first_row;
  const Vec3 point = MarkerOn<double>{in.slot(at.slot), at.at(in.t)}.x();
  if (const int i = e.slots.position(at.slot); i >= 0)
    return on_slot(link, block, e, lambda, i, part, in.slot(at.slot), point);
  LinkWrench sum;
  for (int i = 0; i < e.slots.n; ++i) {
    const LinkWrench w = on_slot(link, block, e, lambda, i, part, in.slot(e.slots[i]), point);
    sum.force -= w.force, sum.moment -= w.moment;
  }
  return sum;
}

}  // namespace lockstep
