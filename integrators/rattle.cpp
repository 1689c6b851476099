// SPDX-License-Identifier: BSD-3-Clause
// Sources: H. C. Andersen, J. Comput. Phys. 52 (1983) 24; A. Dullweber, B. Leimkuhler & R. McLachlan, J. Chem. Phys.
// 107 (1997) 5840; M. Suzuki, Phys. Lett. A 146 (1990) 319; Hairer, Lubich & Wanner, Geometric Numerical Integration
// (2006), VII.1 and II.4.
#include <lockstep/integrators.h>

#include <spdlog/fmt/fmt.h>

#include <array>
#include <cmath>

#include <lockstep/author/stepping.h>
#include <lockstep/error.h>
#include "framework/dynamics/evaluate/projection_rule.h"
#include "framework/foundation/math/limits.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

struct RattleScheme {
  const char* name;
  const char* help;
  int order, n;
  std::array<double, 5> part;  // of the step, one per substep
};

namespace {

const double suzuki = 1 / (4 - std::cbrt(4.0));
const RattleScheme kSchemes[] = {{"rattle2",
                                  "symplectic, order 2, fixed step: energy over long runs, no dampers or friction",
                                  2,
                                  1,
                                  {1, 0, 0, 0, 0}},
                                 {"rattle4",
                                  "symplectic, order 4, fixed step: energy over long runs, no dampers or friction",
                                  4,
                                  5,
                                  {suzuki, suzuki, 1 - 4 * suzuki, suzuki, suzuki}}};
constexpr int kRounds = 50;  // of the multipliers; a handful is usual

const RattleScheme& scheme_of(int order) { return kSchemes[order == 4 ? 1 : 0]; }

// Arbitrary velocities.
VecX any_velocities(Eigen::Index n, double sign) {
  VecX v(n);
  for (Eigen::Index i = 0; i < n; ++i) v[i] = sign * (0.3 + 0.7 * std::cos(1.7 * static_cast<double>(i)));
  return v;
}

VecX pushed_by(const Force& force, const Inputs& in, Eigen::Index n) {
  VecX f = VecX::Zero(n);
  WrenchSum sum(in.motions, f);
  named(force, in.t, [&] { force.apply(in, sum); });
  return f;
}

}  // namespace

TypeInfo Rattle::type_info(int order) { return {scheme_of(order).name, scheme_of(order).help, {}}; }

std::unique_ptr<Integrator> Rattle::make(int order) { return std::make_unique<Rattle>(order); }

Rattle::Rattle(int order) : scheme_(scheme_of(order)) {}

IntegratorInfo Rattle::info() const { return {scheme_.name, scheme_.order, false, false, scheme_.n}; }

void Rattle::begin(Dynamics& dynamics, const State& state) {
  now_ = next_ = state;
  dynamics.gather(state);
  refuse_unsuited(dynamics, state);
  const System& system = dynamics.system();
  turning_.clear();
  for (int k = 0; k < system.n_slots(); ++k)
    if (system.slot(k).freedoms == Freedoms::spatial) turning_.push_back({k, FreeRotation(system.slot(k).J)});
  const Eigen::Index n = state.v.size(), m = dynamics.gather(state).rows().n_rows;
  v_half_ = guess_ = f_ = d_ = VecX::Zero(n);
  C_ = Cd_ = lambda_ = VecX::Zero(m);
  rate0_ = rate1_ = sized_like(state);
  factor_.emplace(dynamics.new_factor());
  ready_ = restored_ = false;
}

void Rattle::refuse_unsuited(Dynamics& dynamics, const State& state) const {
  const System& system = dynamics.system();
  const std::string advice = "; use dopri5 or dop853, or generalized_alpha if it is stiff";
  std::string who;
  for (const auto& link : system.links())
    if (const bool holds = link->jointed() != nullptr && link->jointed()->imposed().hold;  // by constants
        link->n_own_states() > 0 && !holds)
      who = "joint '" + link->name() + "' (driven by its speed)";
  for (const auto& auxiliary : system.auxiliaries())
    if (auxiliary->controls_error() && auxiliary->size() > 0) who = "'" + auxiliary->name() + "'";
  if (!who.empty())
    throw ModelError(
        fmt::format("{}: {} has an integrated state, which the method does not support", scheme_.name, who) + advice);
  for (const Force* force : dynamics.gather(state).reacting())
    throw ModelError(fmt::format("{}: force '{}' ({}) depends on the reactions of joints, as friction does; the method "
                                 "conserves energy",
                                 scheme_.name, force->name(), force->type()) +
                     advice);
  State moving = state;
  for (const double sign : {1.0, -1.0})
    for (const auto& force : system.forces()) {
      moving.v.setZero();
      const VecX still = pushed_by(*force, dynamics.gather(moving).inputs(), state.v.size());
      moving.v = any_velocities(state.v.size(), sign);
      const VecX change = pushed_by(*force, dynamics.gather(moving).inputs(), state.v.size()) - still;
      if (change.norm() > kNegligible * still.norm())
        throw ModelError(
            fmt::format(
                "{}: force '{}' ({}) depends on velocities, as a damper does; the method needs forces that do not",
                scheme_.name, force->name(), force->type()) +
            advice);
    }
}

StepReport Rattle::step(Dynamics& dynamics, State& state, double h) {
  dynamics.system().check_size(state);
  const auto n_angles = CountedAngle::kStates * static_cast<Eigen::Index>(dynamics.system().counted_angles().size());
  const bool quadratures = state.s.size() > n_angles;
  if (quadratures) dynamics.rate(state, rate0_);
  if (restored_ && goes_on_from(state)) factor_again(dynamics);
  restored_ = false;
  if (!goes_on_from(state)) {  // M d + J^T nu = f, J d = -(J v + Ct): the first guess
    ready_ = false;
    copy_motion(state, next_);
    if (state.z.size() > 0) next_.z = state.z;
    kick(gather_next(dynamics), 2.0);
  }
  copy_motion(state, now_);
  if (state.z.size() > 0) now_.z = next_.z = state.z;
  for (int i = 0; i < scheme_.n; ++i) {
    const double part = scheme_.part[i] * h;
    substep(dynamics, part);
    if (!quadratures) now_.s = next_.s;  // angles alone
    if (!quadratures) continue;
    dynamics.rate(now_, rate1_);  // symmetric, of order 2, as the substep: what composes the motion composes works too
    now_.s += 0.5 * part * (rate0_.s + rate1_.s);
    rate0_.s.swap(rate1_.s);
  }
  StepReport report;
  report.h = h;
  report.violation = report.violation_after = left_;
  factored_q_ = now_.q, factored_t_ = now_.t;
  now_.t = state.t + h;
  dynamics.normalize(now_);
  copy_motion(now_, state);
  ready_ = true;
  return report;
}

// The matrix of the end of the last step, in an object that did not make it; it was counted then.
void Rattle::factor_again(Dynamics& dynamics) {
  copy_motion(now_, next_);
  next_.q = factored_q_, next_.t = factored_t_, next_.z = now_.z;
  factor_->compute(dynamics.gather(next_));
  --dynamics.work().factors;
}

void Rattle::save(Snapshot& out) const {
  out.put(ready_ ? 1 : 0);
  if (!ready_) return;
  out.put(now_.t), out.put(left_), out.put(factored_t_);
  for (const VecX* v : {&now_.q, &now_.v, &now_.z, &guess_, &factored_q_}) out.put_all(*v);
}

void Rattle::restore(SnapshotReader& in) {
  ready_ = restored_ = in.get_flag();
  if (!ready_) return;
  now_.t = in.get(), left_ = in.get(), factored_t_ = in.get();
  const State own = next_;  // of begin()
  for (VecX* v : {&now_.q, &now_.v, &now_.z, &guess_, &factored_q_}) in.get_all(*v);
  if (now_.q.size() != own.q.size() || now_.v.size() != own.v.size() || now_.z.size() != own.z.size() ||
      guess_.size() != own.v.size() || factored_q_.size() != own.q.size())
    throw ModelError(fmt::format("{}: the saved history belongs to another mechanism", scheme_.name));
}

// False when an event has changed the state.
bool Rattle::goes_on_from(const State& state) const {
  return ready_ && state.t == now_.t && state.q == now_.q && state.v == now_.v;
}

// Advances now_, whose matrix is factored, by a time h, and its matrix with it.
void Rattle::substep(Dynamics& dynamics, double h) {
  v_half_ = now_.v + 0.5 * h * guess_;
  kick(find_multipliers(dynamics, h, now_.t + h), h);
  next_.v += 0.5 * h * guess_;
  now_.q.swap(next_.q), now_.v.swap(next_.v), now_.t = next_.t;
}

// Solves C(q1) = 0 for mu with the matrix at q0: J(q0) d = -C(q1)/h, M d = -J(q0)^T mu. To round-off, since a residual
// is not symplectic. Returns the evaluation at q1. Throws StepError.
const Evaluation& Rattle::find_multipliers(Dynamics& dynamics, double h, double t) {
  double before = HUGE_VAL;
  for (int round = 0;; ++round) {
    drift(h);
    next_.t = t;
    lead_angles(dynamics, now_, next_);
    const Evaluation& e = gather_next(dynamics);
    const double left = e.norm(C_);
    const double floor = position_rounding(dynamics.system().length(), next_.q.lpNorm<Eigen::Infinity>());
    const bool rests = round > 1 && left > 0.5 * before && left <= 100 * floor;
    if (left <= floor || rests || round == kRounds || !std::isfinite(left)) {
      left_ = left;
      if (left <= dynamics.options().stabilization.tolerance) return e;
      ready_ = false;
      fail(h, left);
    }
    before = left;
    C_ /= -h;
    f_.setZero();
    factor_->solve(e, f_, C_, d_, lambda_);
    v_half_ += d_;
  }
}

// q1 and v of the drift from q0 with v_half_.
void Rattle::drift(double h) {
  next_.q = now_.q;
  next_.v = v_half_;
  for (Eigen::Index k = 0; k < next_.v.size() / 6; ++k) next_.q.segment<3>(7 * k) += h * next_.v.segment<3>(6 * k);
  for (const Turning& body : turning_) {
    Quat e = Quat::from(next_.q.segment<4>(7 * body.slot + 3));
    Vec3 w = next_.v.segment<3>(6 * body.slot + 3);
    body.rotation.turn(h, e, w);
    next_.q.segment<4>(7 * body.slot + 3) = e.coefficients();
    next_.v.segment<3>(6 * body.slot + 3) = w;
  }
}

// Gathers next_, with C and J v + Ct.
const Evaluation& Rattle::gather_next(Dynamics& dynamics) {
  const Evaluation& e = dynamics.gather(next_);
  e.residuals(C_, Cd_);
  ++dynamics.work().evaluations;
  return e;
}

// The second kick at next_, where `e` was gathered: M d = h/2 f - J^T nu, J d = -(J v + Ct). guess_ is 2 d/h.
void Rattle::kick(const Evaluation& e, double h) {
  f_ = e.force();
  for (const Turning& body : turning_) {  // the drift contains -w x J w
    const Vec3 w = next_.v.segment<3>(6 * body.slot + 3);
    f_.segment<3>(6 * body.slot + 3) += cross(w, Vec3(e.system().slot(body.slot).J * w));
  }
  f_ *= 0.5 * h;
  Cd_ = -Cd_;
  factor_->compute(e);
  factor_->solve(e, f_, Cd_, d_, lambda_);
  guess_ = (2 / h) * d_;
}

void Rattle::fail(double h, double left) const {
  throw StepError(
      fmt::format("{}: the multipliers of the substep of {:.6g} s from t = {:.9g} s did not converge (constraint "
                  "violation {:.3g} m); use a smaller step (--step), or dop853 near a singular configuration",
                  scheme_.name, h, now_.t, left),
      now_.t);
}

}  // namespace lockstep
