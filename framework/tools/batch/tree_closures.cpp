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
  return static_cast<const MarkerLock&>(*system.links()[static_cast<std::size_t>(link.link)]);
}

// J^-1 of a slot, its own axes: in a plane about its normal alone, and zero for a particle.
Mat3 inverse_inertia(const Slot& slot, const Vec3* normal) {
  if (slot.freedoms == Freedoms::particle) return Mat3::Zero();
  if (!normal) return slot.J.inverse();
  return *normal * normal->transpose() / normal->dot(slot.J * *normal);
}

}  // namespace

void TreeClosures::begin(const Systems& systems, const Layouts& layouts, const Passes& passes) {
  pass_ = &passes;
  plan_ = make_closure_plan(*systems[0], *layouts[0]);
  if (empty()) return;
  const JointTree& tree = *layouts[0]->tree;
  const auto n_nodes = tree.nodes().size(), n_v = static_cast<std::size_t>(tree.n_v()), m = plan_.n_rows();
  const auto size = [](Aligned<double>& v, std::size_t packs) {
    return v.assign(kL * std::max<std::size_t>(packs, 1), 0.0), v.data();
  };
  const auto n_slots = static_cast<std::size_t>(plan_.rows.n_slots);
  z_.rows.body = size(body_, body::size * (n_slots + 1)), z_.rows.frames = size(frames_, plan_.rows.size_frames);
  z_.rows.law = size(law_, plan_.rows.size_law), z_.rows.J = size(rows_J_, plan_.size_J);
  z_.rows.c = size(c_, m), z_.rows.C = size(C_, m), z_.rows.Ct = size(Ct_, m), z_.inverse = size(inverse_, 7 * n_nodes);
  const std::size_t places = plan_.fronts.rows.size();
  z_.J = size(J_, spatial::size * plan_.slots.size()), z_.K = size(K_, spatial::size * places), z_.l = size(l_, places);
  z_.Lambda = size(Lambda_, static_cast<std::size_t>(plan_.fronts.n_Lambda));
  z_.V = size(V_, static_cast<std::size_t>(plan_.fronts.n_V));
  z_.diagonal = size(diagonal_, m), z_.scale = size(scale_, m), z_.d = size(d_, m);
  z_.lambda = size(lambda_, m), z_.dlambda = size(dlambda_, m), z_.r = size(r_, m), z_.size = size(size_, m);
  z_.Cd = size(Cd_, m), z_.wrench = size(wrench_, spatial::size * n_nodes);
  z_.change = size(change_, spatial::size * n_nodes), z_.du = size(du_, n_v);
  size(masked_, m), size(dv_, n_v), size(length_, 1);
  for (int l = 0; l < kLanes; ++l) {
    const System& system = *systems[static_cast<std::size_t>(l)];
    put_number(length_, 0, l, system.length());
    put_matrix(body_, body::size * n_slots + body::A, l, Mat3::Identity());
    put_number(body_, body::size * n_slots + body::e, l, 1.0);
    for (Link& link : plan_.rows.links) put_frames(lock_in(system, link), l, link, frames_);
  }
  for (const Link& link : plan_.rows.links) has_laws_ = has_laws_ || link.has_laws();
  fill_inverses(systems, layouts);
}

void TreeClosures::fill_inverses(const Systems& systems, const Layouts& layouts) {
  for (std::size_t l = 0; l < kL; ++l) {
    const JointTree& tree = *layouts[l]->tree;
    for (std::size_t k = 0; k < tree.nodes().size(); ++k) {
      const Slot& slot = systems[l]->slot(tree.nodes()[k].slot);
      Vec3 normal = Vec3::UnitX();
      if (plan_.normal >= 0) {
        const Posture* posture = tree.planar()->posture(tree.planar()->nodes()[k]);
        normal = posture ? posture->normal : Vec3(Vec3::Unit(plan_.normal));
      }
      const Mat3 J = inverse_inertia(slot, plan_.normal >= 0 ? &normal : nullptr);
      const int lane = static_cast<int>(l);
      put_number(inverse_, 7 * k, lane, 1.0 / slot.mass);
      put_numbers(inverse_, 7 * k + 1, lane, packed(J));
    }
  }
}

void TreeClosures::fill(const System& system, int lane, const Inputs& in) {
  for (const Link& link : plan_.rows.links)
    if (link.has_laws()) put_laws(lock_in(system, link), lane, link, in, law_);
  fill_own_rows(system, lane, in);
}

void TreeClosures::fill_own_rows(const System& system, int lane, const Inputs& in) {
  for (const OwnRows& rows : plan_.own) {
    const Lock* const link = system.links()[static_cast<std::size_t>(rows.link)].get();
    const RowShape shape = link->shape();
    link->gather(Group(&link, 1), in, scratch_.spatial_span(shape));
    const RowBlock block = scratch_.spatial(shape);
    for (std::size_t k = 0; k < rows.m; ++k) {
      const int own = rows.own[k];
      put_number(C_, rows.first_row + k, lane, block.C(own));
      put_number(Ct_, rows.first_row + k, lane, block.Ct(own));
      put_number(c_, rows.first_row + k, lane, block.Qhat(own));
      for (std::size_t i = 0; i < rows.n_sides; ++i) {
        const std::array<double, 6> J = block.J(static_cast<int>(i), own);
        for (std::size_t x = 0; x < 6; ++x) put_number(rows_J_, rows.J + (6 * i + x) * rows.m + k, lane, J[x]);
      }
    }
  }
}

Numbers8 TreeClosures::norm(const Aligned<double>& x) {
  alignas(64) Numbers8 out;
  pass_->closure_norm(plan_, x.data(), length_.data(), out.data());
  return out;
}

bool TreeClosures::Residuals::met(std::size_t lane) const { return all[lane] <= kRowTolerance; }

// Of J a - c: with scales raised where that is needed.
TreeClosures::Residuals TreeClosures::residuals(const TreeNumbers& tree) {
  alignas(64) std::array<double, 2 * kLanes> now, raised;
  pass_->closure_residuals(tree, plan_, z_, false, now.data());
  const bool all_met = std::all_of(now.begin(), now.begin() + kLanes, [](double x) { return x <= kRowTolerance; });
  if (!all_met) pass_->closure_residuals(tree, plan_, z_, true, raised.data());
  Residuals out;
  for (std::size_t l = 0; l < kL; ++l) {
    const auto& of = all_met || now[l] <= kRowTolerance ? now : raised;
    out.all[l] = of[l], out.regular[l] = of[kL + l];
  }
  return out;
}

// Dynamics::joint_accelerations for each lane. One whose rows are not met then goes on alone: but for redundant ones that
// miss by rounding, as those do in which nothing moves.
Flags8 TreeClosures::accelerate(const TreePlan& tree, const TreeNumbers& z, int n, double* rate) {
  pass_->accelerate_closed(tree, z, plan_, z_, rate);
  Residuals now = residuals(z);
  Numbers8 before;
  before.fill(HUGE_VAL);
  for (;;) {
    Flags8 going{};
    for (std::size_t l = 0; l < static_cast<std::size_t>(n); ++l) {
      going[l] = !now.met(l) && now.all[l] < kStalledRows * before[l];
      if (going[l]) before[l] = now.all[l];
    }
    if (!any(going)) break;
    const double* dv = correct(tree, z, r_, going);
    pass_->add_correction(tree, z, plan_, z_, dv, rate);
    now = residuals(z);
  }
  Flags8 unmet{};
  for (std::size_t l = 0; l < kL; ++l)
    unmet[l] = !now.met(l) && !(now.regular[l] <= kRowTolerance && now.all[l] <= kRedundantRounding);
  return unmet;
}

const double* TreeClosures::correct(const TreePlan& tree, const TreeNumbers& z, const Aligned<double>& r,
                                    const Flags8& wanted) {
  for (std::size_t i = 0; i < masked_.size(); ++i) masked_[i] = wanted[i % kL] ? r[i] : 0.0;
  pass_->correct_closures(tree, z, plan_, z_, masked_.data(), dv_.data());
  return dv_.data();
}

void TreeClosures::see_pivots() {
  if (!floors_known_) measure_floors();
  pass_->closure_pivots(plan_, z_, pivot_floors_.data(), pivots_.data());
}

// As ClosureRows::measure_scales, once.
void TreeClosures::measure_floors() {
  floors_known_ = true;
  for (std::size_t l = 0; l < kL; ++l) {
    PivotFloors floors;
    for (std::size_t j = 0; j < plan_.n_rows(); ++j) {
      const ClosureSource& source = plan_.fronts.sources[j];
      floors.add(source.kind, kClosureProximal * scale_[kL * j + l]);
      for (int i = 0; i < source.n_sides && source.kind == RowKind::translation; ++i) {
        const double* J = J_.data() + kL * spatial::size * static_cast<std::size_t>(source.first_side + i) + l;
        floors.arm2 = std::max(floors.arm2, J[3 * kL] * J[3 * kL] + J[4 * kL] * J[4 * kL] + J[5 * kL] * J[5 * kL]);
      }
    }
    for (const RowKind kind : {RowKind::translation, RowKind::rotation, RowKind::function})
      pivot_floors_[kL * static_cast<std::size_t>(kind) + l] = floors.of(kind);
  }
}

}  // namespace lockstep::lanes
