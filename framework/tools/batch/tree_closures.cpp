// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/batch/tree_closures.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include <lockstep/body.h>
#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/dynamics/tree/closure_rows.h"
#include "framework/tools/batch/link_numbers.h"

namespace lockstep::lanes {

namespace {

constexpr double kRedundantRounding = 1e-9;  // of the scale of a redundant row

const MarkerLock& lock_in(const System& system, const Link& link) {
  return static_cast<const MarkerLock&>(*system.links()[link.link]);
}

// J^-1 of a slot, its own axes: in a plane about its normal alone, and zero for a particle.
Mat3 inverse_inertia(const Slot& slot, const Vec3* normal) {
  if (slot.freedoms == Freedoms::particle) return Mat3::Zero();
  if (!normal) return slot.J.inverse();
  return *normal * normal->transpose() / normal->dot(slot.J * *normal);
}

}  // namespace

TreeClosures::TreeClosures(const Systems& systems, const Layouts& layouts, LaneData& data, const Passes& passes)
    : data_(data), pass_(passes) {
  data_.loops = make_closure_plan(*systems[0], *layouts[0]);
  if (empty()) return;
  const JointTree& tree = *layouts[0]->tree;
  const auto n_nodes = tree.nodes().size(), n_v = static_cast<std::size_t>(tree.n_v()), m = data_.loops.n_rows();
  const std::size_t n_slots = data_.loops.n_slots, places = data_.loops.fronts.rows.size();
  const auto size = [&](std::size_t packs) { return arrays_.add(packs); };
  data_.c.rows = {size(body::size * (n_slots + 1)),
                  size(data_.loops.size_frames),
                  size(data_.loops.size_law),
                  size(data_.loops.size_J),
                  size(m),
                  size(m),
                  size(m)};
  data_.c.inverse = size(7 * n_nodes), data_.c.J = size(spatial::size * data_.loops.slots.size()),
  data_.c.l = size(places);
  data_.c.Lambda = size(static_cast<std::size_t>(data_.loops.fronts.n_Lambda)),
  data_.c.V = size(static_cast<std::size_t>(data_.loops.fronts.n_V));
  for (auto* of_rows : {&data_.c.diagonal, &data_.c.scale, &data_.c.d, &data_.c.lambda, &data_.c.dlambda, &data_.c.r,
                        &data_.c.size, &data_.c.Cd})
    *of_rows = size(m);
  data_.c.du = size(n_v), data_.c.K = size(spatial::size * places);
  data_.c.wrench = size(spatial::size * n_nodes), data_.c.change = size(spatial::size * n_nodes);
  masked_.assign(kL * m, 0.0), dv_.assign(kL * std::max<std::size_t>(n_v, 1), 0.0), length_.assign(kL, 0.0);
  for (int l = 0; l < kLanes; ++l) {
    const System& system = *systems[l];
    put_number(length_, 0, l, system.length());
    put_matrix(data_.c.rows.body, body::size * n_slots + body::A, l, Mat3::Identity());
    put_number(data_.c.rows.body, body::size * n_slots + body::e, l, 1.0);
    for (Link& link : data_.loops.masks) put_frames(lock_in(system, link), l, link, data_.c.rows.frames);
  }
  for (const Link& link : data_.loops.masks) has_laws_ = has_laws_ || link.has_laws();
  fill_inverses(systems, layouts);
}

void TreeClosures::fill_inverses(const Systems& systems, const Layouts& layouts) {
  for (std::size_t l = 0; l < kL; ++l) {
    const JointTree& tree = *layouts[l]->tree;
    for (std::size_t k = 0; k < tree.nodes().size(); ++k) {
      const Slot& slot = systems[l]->slot(tree.nodes()[k].slot);
      Vec3 normal = Vec3::UnitX();
      if (data_.loops.normal >= 0) {
        const Posture* posture = tree.planar()->posture(tree.planar()->nodes()[k]);
        normal = posture ? posture->normal : Vec3(Vec3::Unit(data_.loops.normal));
      }
      const Mat3 J = in_order(data_.plan.axes(), inverse_inertia(slot, data_.loops.normal >= 0 ? &normal : nullptr));
      const int lane = static_cast<int>(l);
      put_number(data_.c.inverse, 7 * k, lane, 1.0 / slot.mass);
      put_numbers(data_.c.inverse, 7 * k + 1, lane, packed(J));
    }
  }
}

void TreeClosures::fill(const System& system, int lane, const Inputs& in) {
  for (const Link& link : data_.loops.masks)
    if (link.has_laws()) put_laws(lock_in(system, link), lane, link, in, data_.c.rows.law);
  fill_own_rows(system, lane, in);
}

void TreeClosures::fill_own_rows(const System& system, int lane, const Inputs& in) {
  for (const OwnRows& rows : data_.loops.own) {
    const Lock* const link = system.links()[rows.link].get();
    const RowShape shape = link->shape();
    link->gather(Group(&link, 1), in, scratch_.spatial_span(shape));
    const RowBlock block = scratch_.spatial(shape);
    for (std::size_t k = 0; k < rows.m; ++k) {
      const int own = rows.own[k];
      put_number(data_.c.rows.C, rows.first_row + k, lane, block.C(own));
      put_number(data_.c.rows.Ct, rows.first_row + k, lane, block.Ct(own));
      put_number(data_.c.rows.c, rows.first_row + k, lane, block.Qhat(own));
      for (std::size_t i = 0; i < rows.n_sides; ++i) {
        const std::array<double, 6> J = block.J(static_cast<int>(i), own);
        for (std::size_t x = 0; x < 6; ++x) put_number(data_.c.rows.J, rows.J + (6 * i + x) * rows.m + k, lane, J[x]);
      }
    }
  }
}

Numbers8 TreeClosures::norm(std::span<const double> x) {
  alignas(64) Numbers8 out;
  pass_.closure_norm(data_, x.data(), length_.data(), out.data());
  return out;
}

bool TreeClosures::Residuals::met(std::size_t lane) const { return all[lane] <= kRowTolerance; }

// Of J a - c: with scales raised where that is needed.
TreeClosures::Residuals TreeClosures::residuals() {
  alignas(64) std::array<double, 2 * kLanes> now, raised;
  pass_.closure_residuals(data_, false, now.data());
  const bool all_met = std::all_of(now.begin(), now.begin() + kLanes, [](double x) { return x <= kRowTolerance; });
  if (!all_met) pass_.closure_residuals(data_, true, raised.data());
  Residuals out;
  for (std::size_t l = 0; l < kL; ++l) {
    const auto& of = all_met || now[l] <= kRowTolerance ? now : raised;
    out.all[l] = of[l], out.regular[l] = of[kL + l];
  }
  return out;
}

// Dynamics::joint_accelerations for each lane. One whose rows are not met then continues alone: except for redundant
// ones that miss by rounding, as those do in which nothing moves.
Flags8 TreeClosures::accelerate(int n, double* rate) {
  pass_.accelerate_closed(data_, rate);
  Residuals now = residuals();
  Numbers8 before;
  before.fill(HUGE_VAL);
  for (;;) {
    Flags8 going{};
    for (int l = 0; l < n; ++l) {
      going[l] = !now.met(l) && now.all[l] < kStalledRows * before[l];
      if (going[l]) before[l] = now.all[l];
    }
    if (!any(going)) break;
    const double* dv = correct(data_.c.r, going);
    pass_.add_correction(data_, dv, rate);
    now = residuals();
  }
  Flags8 unmet{};
  for (std::size_t l = 0; l < kL; ++l)
    unmet[l] = !now.met(l) && !(now.regular[l] <= kRowTolerance && now.all[l] <= kRedundantRounding);
  return unmet;
}

const double* TreeClosures::correct(std::span<const double> r, const Flags8& wanted) {
  for (std::size_t i = 0; i < masked_.size(); ++i) masked_[i] = wanted[i % kL] ? r[i] : 0.0;
  pass_.correct_closures(data_, masked_.data(), dv_.data());
  return dv_.data();
}

void TreeClosures::see_pivots() {
  if (!floors_known_) measure_floors();
  pass_.closure_pivots(data_, pivot_floors_.data(), pivots_.data());
}

// As ClosureRows::measure_scales, once.
void TreeClosures::measure_floors() {
  floors_known_ = true;
  for (std::size_t l = 0; l < kL; ++l) {
    PivotFloors floors;
    for (std::size_t j = 0; j < data_.loops.n_rows(); ++j) {
      const ClosureSource& source = data_.loops.fronts.sources[j];
      floors.add(source.kind, kClosureProximal * data_.c.scale[kL * j + l]);
      for (int i = 0; i < source.n_sides && source.kind == RowKind::translation; ++i) {
        const double* J = data_.c.J.data() + kL * spatial::size * static_cast<std::size_t>(source.first_side + i) + l;
        floors.arm2 = std::max(floors.arm2, J[3 * kL] * J[3 * kL] + J[4 * kL] * J[4 * kL] + J[5 * kL] * J[5 * kL]);
      }
    }
    for (const RowKind kind : {RowKind::translation, RowKind::rotation, RowKind::function})
      pivot_floors_[kL * static_cast<std::size_t>(kind) + l] = floors.of(kind);
  }
}

}  // namespace lockstep::lanes
