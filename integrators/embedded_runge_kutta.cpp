// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/integrators.h>

#include <string>

#include <lockstep/error.h>
#include "framework/dynamics/integrate/singular_passage.h"

namespace lockstep {

namespace {

// b - a_late: the end of the step minus the late stage.
Weights gap_of(const EmbeddedScheme& scheme) {
  std::array<double, Weights::kMost> gap{};
  for (int i = 0; i < scheme.tableau.n_stages; ++i)
    gap[i] = scheme.tableau.b[i] -
             (i < scheme.late_stage ? scheme.tableau.a[scheme.late_stage * scheme.tableau.stride + i] : 0);
  return {gap.data(), scheme.tableau.n_stages};
}

// Fixed steps for a scheme without an estimate, or on request.
std::unique_ptr<StepControl> control_of(const EmbeddedScheme& scheme, const EmbeddedOptions& options) {
  if (options.fixed || !scheme.error) return nullptr;
  return std::make_unique<PiControl>(scheme.tableau.order);
}

}  // namespace

Keys EmbeddedOptions::keys() {
  return {{"fixed", Form::boolean, Unit::none, false, "use the given step, without error control", {}},
          {"stages",
           Form::choice,
           Unit::none,
           "auto",
           "projection of the stages onto the constraints: off, always, or near singular configurations",
           {"plain", "manifold", "auto"}}};
}

EmbeddedOptions EmbeddedOptions::from(const Params& params) {
  const std::string stages = params.text("stages");
  return {params.boolean("fixed"), stages == "manifold" ? StagesWhen::manifold
                                   : stages == "plain"  ? StagesWhen::plain
                                                        : StagesWhen::automatic};
}

EmbeddedRungeKutta::EmbeddedRungeKutta(const EmbeddedScheme& scheme, const EmbeddedOptions& options)
    : AdaptiveStepper(scheme.tableau.order, control_of(scheme, options)),
      scheme_(scheme),
      passage_(std::make_unique<SingularPassage>(
          options.fixed && options.stages == StagesWhen::automatic ? StagesWhen::plain : options.stages, scheme.name)),
      watch_(scheme.stability) {}
EmbeddedRungeKutta::~EmbeddedRungeKutta() = default;

IntegratorInfo EmbeddedRungeKutta::info() const {
  const bool passes_singular = passage_->when() != StagesWhen::plain;
  return {scheme_.name, scheme_.tableau.order, false, !fixed(), scheme_.tableau.n_stages, true, passes_singular};
}

const EmbeddedScheme* EmbeddedRungeKutta::scheme() const {
  return (scheme_.error && fixed()) || passage_->when() == StagesWhen::manifold ? nullptr : &scheme_;
}

void EmbeddedRungeKutta::set_tolerance(const Tolerance& tolerance) {
  AdaptiveStepper::set_tolerance(tolerance);
  passage_->set_tolerance(tolerance.relative);
}

void EmbeddedRungeKutta::begin(Dynamics& dynamics, const State& state) {
  AdaptiveStepper::begin(dynamics, state);
  dynamics_ = &dynamics;
  passage_->begin(scheme_.tableau, state, dynamics);
  stages_.begin(scheme_.tableau, state, passage_->active());
  watch_.begin();
  h_ = h_followed_ = 0;
  dense_ready_ = false;
  if (!scheme_.error) return;
  error_ = gap_ = sized_like(state);
  const int n = scheme_.tableau.n_stages, n_all = scheme_.tableau.n_all;
  error_w_ = Weights(scheme_.error, n);
  if (scheme_.second) second_w_ = Weights(scheme_.second, n);
  gap_w_ = gap_of(scheme_);
  dense_w_.clear();
  for (int i = 0; i < scheme_.n_dense; ++i) dense_w_.emplace_back(scheme_.d + i * n_all, n_all);
  poly_.resize(3 + scheme_.n_dense);
  for (StateRate& p : poly_) p = sized_like(state);
}

// The first stage does not depend on h: rejected attempts keep it. From the rate at the end of the last step, which
// begins this one, and that of its late stage, the watch estimates the fastest mode.
double EmbeddedRungeKutta::start_step(Dynamics& dynamics, double h) {
  const bool follows = h_followed_ > 0 && start_.t == landed_t_ && start_.v.size() > 0;
  const double h_before = h_followed_;
  h_ = h_followed_ = 0;
  dense_ready_ = false;
  passage_->start_step();
  first_done_ = passage_->evaluate(dynamics, start_, 0, 0, 1, stages_);
  if (follows && first_done_ && !fixed())
    watch_.observe(h_before, gap_.v, stages_.k(scheme_.late_stage).v, stages_.k(0).v,
                   start_.coordinates ? 1.0 : dynamics.system().length());
  return fixed() ? h : passage_->longest(h);
}

Attempt EmbeddedRungeKutta::attempt(Dynamics& dynamics, double h) {
  Attempt made;
  if (!first_done_) first_done_ = passage_->evaluate(dynamics, start_, 0, 0, 1, stages_);
  const bool evaluated = first_done_ && passage_->evaluate(dynamics, start_, h, 1, scheme_.tableau.n_stages, stages_);
  if (passage_->enters()) {
    first_done_ = false;
    made.next = fixed() ? h : passage_->longest(h);
    return made;
  }
  if (evaluated) stages_.end(start_, h, end_);
  if (fixed()) {
    made.accepted = evaluated;
    return made;
  }
  if (evaluated) made.error = estimate(h);
  made.accepted = evaluated && passage_->accepts(h, made.error);
  return made;
}

void EmbeddedRungeKutta::finish_step(Dynamics&, StepReport& report) {
  h_ = h_followed_ = report.h;
  landed_t_ = landed_.t;
  report.manifold = passage_->stages_on() == StagesOn::manifold;
  report.stiff = watch_.stiff();
  passage_->finish_step(report);
  if (fixed() || end_.v.size() == 0) return;
  stages_.sum(h_, gap_w_, gap_);
  gap_.v += landed_.v - end_.v;
}

ProjectReport EmbeddedRungeKutta::project_end(Dynamics& dynamics, State& y) { return passage_->land(dynamics, y); }

double EmbeddedRungeKutta::estimate(double h) {
  norm_.scale(start_, stages_.k(0), h, end_);
  stages_.sum(h, error_w_, error_);
  const double error = norm_.of(error_, end_);
  if (!scheme_.second || error == 0) return error;
  stages_.sum(h, second_w_, error_);
  return combined_error(error, norm_.of(error_, end_));
}

std::string EmbeddedRungeKutta::advice() const {
  if (watch_.stiff() && !passage_->near())
    return "damped fast modes limit it (stiffness): use an implicit method (--integrator radau5 or "
           "generalized_alpha)";
  return AdaptiveStepper::advice();
}

bool EmbeddedRungeKutta::dense(double t, State& out) const {
  if (!dynamics_ || !scheme_.error) return false;
  copy_motion(start_, out);
  out.z = start_.z;
  out.modes = start_.modes, out.watched = start_.watched;
  if (h_ == 0) return t == start_.t;
  if (!dense_ready_ && (out.v.size() > 0 || out.s.size() > 0)) prepare_dense();
  const double theta = (t - start_.t) / h_;
  double factor = theta;  // theta, theta (1 - theta), theta^2 (1 - theta), ...
  for (std::size_t i = 0; i < poly_.size(); ++i) {
    out.q += factor * poly_[i].q, out.v += factor * poly_[i].v;
    out.s += factor * poly_[i].s;
    factor *= i % 2 == 0 ? 1 - theta : theta;
  }
  out.t = t;
  dynamics_->normalize(out);
  return true;
}

// y(theta) = y0 + theta (p0 + (1 - theta)(p1 + theta (p2 + (1 - theta)(p3 + ...)))),
// p0 = y1 - y0, p1 = h k(t0) - p0, p2 = p0 - h k(t1) - p1, p3 ... = h sum d_i k_i
void EmbeddedRungeKutta::prepare_dense() const {
  const Tableau& tableau = scheme_.tableau;
  passage_->evaluate(*dynamics_, start_, h_, tableau.n_stages, tableau.n_all, stages_);
  const auto each = [&](auto part, auto state_part) {
    VecX &p0 = poly_[0].*part, &p1 = poly_[1].*part, &p2 = poly_[2].*part;
    p0 = end_.*state_part - start_.*state_part;
    p1 = h_ * (stages_.k(0).*part) - p0;
    p2 = p0 - h_ * (stages_.k(scheme_.end_stage).*part) - p1;
  };
  each(&StateRate::q, &State::q), each(&StateRate::v, &State::v);
  each(&StateRate::s, &State::s);
  for (int i = 0; i < scheme_.n_dense; ++i) stages_.sum(h_, dense_w_[i], poly_[3 + i]);
  dense_ready_ = true;
}

void EmbeddedRungeKutta::save(Snapshot& out) const {
  AdaptiveStepper::save(out);
  passage_->save(out);
  if (fixed()) return;
  watch_.save(out);
  out.put(h_followed_), out.put(landed_t_), out.put_all(gap_.v), out.put_all(stages_.k(scheme_.late_stage).v);
}

void EmbeddedRungeKutta::restore(SnapshotReader& in) {
  AdaptiveStepper::restore(in);
  passage_->restore(in);
  h_ = h_followed_ = 0;
  if (fixed()) return;
  watch_.restore(in);
  h_followed_ = in.get(), landed_t_ = in.get(), in.get_all(gap_.v);
  StateRate late = stages_.k(scheme_.late_stage);
  in.get_all(late.v);
  if (gap_.v.size() != error_.v.size() || late.v.size() != error_.v.size())
    throw ModelError(std::string(scheme_.name) + ": the saved history belongs to another mechanism");
  stages_.put(scheme_.late_stage, late);
}

double EmbeddedRungeKutta::first_step(Dynamics& dynamics, const State& state, double largest) {
  if (fixed()) return 0;
  h_ = h_followed_ = 0;  // the end of the last step is used as scratch
  dense_ready_ = false;
  return AdaptiveStepper::first_step(dynamics, state, largest);
}

}  // namespace lockstep
