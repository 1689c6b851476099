// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/batch/tree_closures.h"

#include <cmath>

#include <Eigen/LU>

#include <lockstep/author/lock.h>
#include <lockstep/body.h>
#include "framework/dynamics/tree/closure_rows.h"

namespace lockstep::lanes {

namespace {

constexpr double kRedundantRounding = 1e-9;  // of the scale of a redundant row

const MarkerLock& lock_in(const System& system, const Link& link) {
  return static_cast<const MarkerLock&>(*system.links()[link.link]);
}

// Writes the markers of one copy's lock; where they are not parallel, the link's turn is no more Turn::parallel.
void put_frames(const MarkerLock& lock, int lane, Link& link, std::span<double> to) {
  const MarkerFrame P(lock.p()), S(lock.s());
  if (link.turn == Turn::parallel && !(P.parallel() && S.parallel())) link.turn = Turn::plain;
  put_numbers(to, link.frames + frames::uP, lane, P.u0), put_numbers(to, link.frames + frames::uS, lane, S.u0);
  put_numbers(to, link.frames + frames::qP, lane, P.q0.coefficients());
  put_numbers(to, link.frames + frames::qS, lane, S.q0.coefficients());
  put_matrix(to, link.frames + frames::AP, lane, P.A0), put_matrix(to, link.frames + frames::AS, lane, S.A0);
}

// Writes the laws of one copy's lock. Throws what they throw.
void put_laws(const MarkerLock& lock, int lane, const Link& link, const Inputs& in, std::span<double> to) {
  if (link.moved) {
    const ImposedTranslation D = lock.imposed_translation(in);
    put_numbers(to, link.law + law::p, lane, D.p), put_numbers(to, link.law + law::pd, lane, D.pd);
    put_numbers(to, link.law + law::pdd, lane, D.pdd);
  }
  if (link.turn != Turn::law) return;
  const ImposedRotation D = lock.imposed_rotation(in);
  put_numbers(to, link.law + law::q, lane, D.q.coefficients()), put_matrix(to, link.law + law::A, lane, D.A);
  put_numbers(to, link.law + law::w, lane, D.w), put_numbers(to, link.law + law::a, lane, D.a);
}

// J^-1 of the slot of node k, its own axes: in a plane with this normal about it alone, and zero for a particle.
Mat3 inverse_inertia(const Slot& slot, const JointTree& tree, std::size_t k, int normal) {
  if (slot.freedoms == Freedoms::particle) return Mat3::Zero();
  if (normal < 0) return slot.J.inverse();
  const Posture* posture = tree.planar()->posture(tree.planar()->nodes()[k]);
  const Vec3 n = posture ? posture->normal : Vec3(Vec3::Unit(normal));
  return n * n.transpose() / n.dot(slot.J * n);
}

}  // namespace

TreeClosures::TreeClosures(const Systems& systems, const Layouts& layouts, LaneData& data, const Passes& passes)
    : data_(data), pass_(passes) {
  data_.loops = make_closure_plan(*systems[0], *layouts[0]);
  if (empty()) return;
  const ClosurePlan& plan = data_.loops;
  ClosureStore& c = data_.c;
  const std::size_t n_nodes = data_.plan.nodes.size(), n_v = data_.plan.n_v, m = plan.n_rows();
  const std::size_t places = plan.fronts.rows.size(), ground = body::size * plan.n_slots;
  const auto size = [&](std::size_t packs) { return arrays_.add(packs); };
  c.rows.body = size(ground + body::size), c.rows.frames = size(plan.size_frames), c.rows.law = size(plan.size_law);
  c.rows.J = size(plan.size_J), c.inverse = size(7 * n_nodes), c.J = size(struct_size::wrench * plan.slots.size());
  c.l = size(places), c.Lambda = size(static_cast<std::size_t>(plan.fronts.n_Lambda));
  c.V = size(static_cast<std::size_t>(plan.fronts.n_V));
  for (auto* of_rows :
       {&c.rows.c, &c.rows.C, &c.rows.Ct, &c.diagonal, &c.scale, &c.d, &c.lambda, &c.dlambda, &c.r, &c.size, &c.Cd})
    *of_rows = size(m);
  c.du = size(n_v), c.K = size(struct_size::wrench * places);
  c.wrench = size(struct_size::wrench * n_nodes), c.change = size(struct_size::wrench * n_nodes);
  masked_.assign(kL * m, 0.0), dv_.assign(kL * std::max<std::size_t>(n_v, 1), 0.0);
  for (int l = 0; l < kLanes; ++l) {
    const System& system = *systems[l];
    length_[l] = system.length();
    put_matrix(c.rows.body, ground + body::A, l, Mat3::Identity());
    put_number(c.rows.body, ground + body::e, l, 1.0);
    for (Link& link : data_.loops.masks) put_frames(lock_in(system, link), l, link, c.rows.frames);
    for (std::size_t k = 0; k < n_nodes; ++k) {
      const JointTree& own = *layouts[l]->tree;
      const Slot& slot = system.slot(own.nodes()[k].slot);
      const Mat3 J = in_order(data_.plan.axes(), inverse_inertia(slot, own, k, plan.normal));
      put_number(c.inverse, 7 * k, l, 1.0 / slot.mass);
      put_numbers(c.inverse, 7 * k + 1, l, packed(J));
    }
  }
  for (const Link& link : data_.loops.masks) has_laws_ = has_laws_ || link.has_laws();
}

void TreeClosures::fill(const System& system, int lane, const Inputs& in) {
  for (const Link& link : data_.loops.masks)
    if (link.has_laws()) put_laws(lock_in(system, link), lane, link, in, data_.c.rows.law);
  for (const OwnRows& rows : data_.loops.own) {
    const RowBlock block = gather_alone(*system.links()[rows.link], in, scratch_);
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
  Numbers8 translation{}, other{};
  for (std::size_t j = 0; j < data_.loops.n_rows(); ++j) {
    Numbers8& most = data_.loops.fronts.sources[j].kind == RowKind::translation ? translation : other;
    for (int l = 0; l < kLanes; ++l) most[l] = largest_or_nan(most[l], std::abs(x[kL * j + l]));
  }
  for (int l = 0; l < kLanes; ++l) translation[l] = largest_or_nan(translation[l], 2.0 * length_[l] * other[l]);
  return translation;
}

// Of J a - c: with scales raised where that is needed.
TreeClosures::Residuals TreeClosures::residuals() {
  alignas(64) std::array<double, 2 * kLanes> now, raised;
  pass_.closure_residuals(data_, false, now.data());
  const bool all_met = std::all_of(now.begin(), now.begin() + kLanes, [](double x) { return x <= kRowTolerance; });
  if (!all_met) pass_.closure_residuals(data_, true, raised.data());
  Residuals out;
  for (int l = 0; l < kLanes; ++l) {
    const auto& of = all_met || now[l] <= kRowTolerance ? now : raised;
    out.all[l] = of[l], out.regular[l] = of[kLanes + l];
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
  for (int l = 0; l < kLanes; ++l)
    unmet[l] = !now.met(l) && !(now.regular[l] <= kRowTolerance && now.all[l] <= kRedundantRounding);
  return unmet;
}

const double* TreeClosures::correct(std::span<const double> r, const Flags8& wanted) {
  for (std::size_t i = 0; i < masked_.size(); ++i) masked_[i] = wanted[i % kL] ? r[i] : 0.0;
  pass_.correct_closures(data_, masked_.data(), dv_.data());
  return dv_.data();
}

void TreeClosures::see_pivots() {
  n_small_.fill(0), smallest_pivot_.fill(1);
  for (std::size_t j = 0; j < data_.loops.n_rows(); ++j) {
    for (int l = 0; l < kLanes; ++l) {
      const double pivot = data_.c.d[kL * j + l], diagonal = data_.c.diagonal[kL * j + l];
      if (pivot < kSmallPivot * diagonal)
        ++n_small_[l];
      else
        smallest_pivot_[l] = std::min(smallest_pivot_[l], pivot / diagonal);
    }
  }
}

}  // namespace lockstep::lanes
