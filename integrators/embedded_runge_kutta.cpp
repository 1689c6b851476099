#include "integrators/embedded_runge_kutta.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/foundation/support/error.h"

namespace lockstep {

namespace {

constexpr int kFailures = 8;             // tries whose stages cannot be evaluated before the error goes on its way
constexpr double kSmallestStep = 1e-14;  // of max(|t|, step asked for)
constexpr double kViolation = 1e-3;      // of the scene's length, before projection
constexpr double kTurn = 0.5;            // rad a step, with the stages on the constraints
constexpr double kSingular = 1e-2;       // detector below which the stages go onto the constraints,
constexpr double kLeave = 0.1;           // rad: a first step that leads out of a singular position
constexpr double kNowhere = 1e-7;        // detector below which it says no more than the proximal term
constexpr double kRedundant = 1e-6;      // pivot of a row that others make redundant
constexpr double kRoundOff = 1e-17;      // of the accelerations, times the detector
constexpr double kShift = 0.93;          // a step that avoids such a place,
constexpr int kShifts = 12;              // tried so often; then the best of them is taken,
constexpr double kCross = 100;           // with an error up to this
constexpr double kRegular = 3e-2;        // and above which they leave them again

// Steps that only creep towards a place where nothing can be evaluated: the error there is the news, not the small
// step.
bool creeps(double t, double h) { return h < 1e-10 * std::max(std::abs(t), 1e-3); }

// b - a_late: the end of the step less the late stage.
Weights gap_of(const EmbeddedScheme& scheme) {
  std::array<double, Weights::kMost> gap{};
  for (int i = 0; i < scheme.tableau.n_stages; ++i)
    gap[static_cast<std::size_t>(i)] =
        scheme.tableau.b[i] -
        (i < scheme.late_stage ? scheme.tableau.a[scheme.late_stage * scheme.tableau.stride + i] : 0);
  return {gap.data(), scheme.tableau.n_stages};
}

}  // namespace

Keys EmbeddedOptions::keys() {
  return {{"fixed", Form::boolean, Unit::none, false, "steps as told, without error control", {}},
          {"stages",
           Form::choice,
           Unit::none,
           "plain",
           "where stages are evaluated: as they are, on the constraints (singular positions), or there when needed",
           {"plain", "manifold", "auto"}}};
}

EmbeddedOptions EmbeddedOptions::from(const Params& params) {
  const std::string stages = params.text("stages");
  return {params.boolean("fixed"), stages == "manifold" ? StagesWhen::manifold
                                   : stages == "auto"   ? StagesWhen::automatic
                                                        : StagesWhen::plain};
}

void EmbeddedRungeKutta::begin(Dynamics& dynamics, const State& state) {
  dynamics_ = &dynamics;
  stages_.begin(scheme_.tableau, state, options_.stages != StagesWhen::plain);
  start_ = end_ = landed_ = state;
  error_ = gap_ = sized_like(state);
  a_before_ = gap_.v;
  const int n = scheme_.tableau.n_stages, n_all = scheme_.tableau.n_all;
  error_w_ = Weights(scheme_.error, n);
  if (scheme_.second) second_w_ = Weights(scheme_.second, n);
  gap_w_ = gap_of(scheme_);
  dense_w_.clear();
  for (int i = 0; i < scheme_.n_dense; ++i) dense_w_.emplace_back(scheme_.d + i * n_all, n_all);
  poly_.resize(static_cast<std::size_t>(3 + scheme_.n_dense));
  for (StateRate& p : poly_) p = sized_like(state);
  norm_.set_states(dynamics.system().n_steering_states());
  norm_.scale(state, 1.0);
  control_.begin();
  watch_.begin();
  singular_ = looked_aside_ = false;
  through_.begin(state);
  h_ = 0;
  dense_ready_ = false;
}

StepReport EmbeddedRungeKutta::step(Dynamics& dynamics, State& state, double h) {
  StepReport report;
  const double smallest = kSmallestStep * std::max(std::abs(state.t), h);
  int failures = 0, shifts = 0;
  double limit = 1;  // of the error
  struct {
    double h = 0, error = kCross;
  } best;  // of the shifted ones
  start_step(dynamics, state);
  h = longest(h);
  for (;; ++report.rejected) {
    double factor = 0.5;
    try {
      const Try t = attempt(dynamics, h, limit);
      const bool shift = shifts < kShifts && misplaced(t);
      if (t.landed && !shift && (fixed() || t.error <= limit)) {
        finish_step(t, h, shifts, state, report);
        return report;
      }
      if (t.singular) {
        on_ = StagesOn::manifold;
        first_done_ = false;
        h = longest(h);
        continue;
      }
      factor = t.error > 1 ? control_.reject(t.error) : 0.5;
      if (shift) {
        if (t.error < best.error && !blind(scheme_.late_stage)) best = {h, t.error};
        const bool cross = ++shifts == kShifts && best.h > 0;
        factor = cross ? best.h / h : kShift;
        if (cross) limit = kCross;
      }
    } catch (const NonFiniteError&) {
      if (fixed() || ++failures > kFailures || creeps(state.t, 0.5 * h)) throw;
    } catch (const SolveError&) {
      if (fixed() || ++failures > kFailures || creeps(state.t, 0.5 * h)) throw;
    }
    h *= factor;
    if (h < smallest || state.t + h == state.t) throw StepError(blame(h, state.t, report.rejected + 1), state.t);
  }
}

// The first stage depends on no h: rejected tries keep it.
void EmbeddedRungeKutta::start_step(Dynamics& dynamics, const State& state) {
  const bool follows = h_ > 0 && state.t == landed_t_;
  const double h = h_;
  copy_motion(state, start_);
  if (state.z.size() > 0) start_.z = end_.z = landed_.z = state.z;
  h_ = 0;
  dense_ready_ = false;
  on_ = options_.stages == StagesWhen::manifold || singular_ ? StagesOn::manifold : StagesOn::plain;
  first_done_ = first_stage(dynamics);
  if (follows && first_done_ && !fixed()) watch_stiffness(dynamics, h);
}

// Where the step begins. In a singular position no solve tells the branch: the rates there come from both sides of it.
// A start in one looks like any with redundant rows until one has looked aside.
bool EmbeddedRungeKutta::first_stage(Dynamics& dynamics) {
  if (!stages_.evaluate(dynamics, start_, 0, 0, 1, on_)) return false;
  if (options_.stages == StagesWhen::plain) return true;
  const bool starts = !looked_aside_ && stages_.sight(0).pivot < kRedundant;
  looked_aside_ = true;
  if (!starts && !blind(0)) return true;
  const bool found = through_.find(dynamics, start_, error_);
  if (starts && !stages_.evaluate(dynamics, start_, 0, 0, 1, on_)) return false;
  if (!blind(0)) return true;
  from_both_sides_ = found;
  if (found) stages_.put(0, error_);
  if (!found && starts)
    throw StepError(
        fmt::format(
            "{}: the state at t = {:.9g} s is a singular position from which more than one motion goes on; start "
            "a little beside it, and with the velocity that is meant",
            scheme_.name, start_.t),
        start_.t);
  return true;
}

EmbeddedRungeKutta::Try EmbeddedRungeKutta::attempt(Dynamics& dynamics, double h, double limit) {
  Try t;
  if (!first_done_) first_done_ = first_stage(dynamics);
  const bool evaluated = first_done_ && stages_.evaluate(dynamics, start_, h, 1, scheme_.tableau.n_stages, on_);
  t.singular = options_.stages == StagesWhen::automatic && on_ == StagesOn::plain && detector() < kSingular;
  if (t.singular || !evaluated) return t;
  stages_.end(start_, h, end_);
  t.error = fixed() ? 0 : estimate(h);
  if (t.error > limit) return t;
  copy_motion(end_, landed_);
  if (fixed()) {
    const ProjectReport report = land_or_throw(dynamics, landed_, scheme_.name, start_.t, h, on_);
    t.violation = report.before, t.violation_after = report.after, t.landed = true;
    return t;
  }
  const bool projected = dynamics.options().stabilization.kind == Stabilization::Kind::project;
  const ProjectReport report = land(dynamics, landed_, on_);
  t.violation = report.before, t.violation_after = report.after;
  t.landed = !projected || (report.converged && report.before <= kViolation * dynamics.system().length());
  return t;
}

void EmbeddedRungeKutta::finish_step(const Try& t, double h, int shifts, State& state, StepReport& report) {
  report.h = h_ = h;
  report.error = t.error;
  report.violation = t.violation;
  report.violation_after = t.violation_after;
  report.manifold = on_ == StagesOn::manifold;
  report.stiff = watch_.stiff();
  if (!fixed()) {
    report.h_next = h * control_.accept(t.error, report.rejected > shifts);
    stages_.sum(h, gap_w_, gap_);
    gap_.v += landed_.v - end_.v;
  }
  if (options_.stages == StagesWhen::automatic)
    singular_ = detector() < (on_ == StagesOn::manifold ? kRegular : kSingular);
  landed_t_ = landed_.t;
  take_motion(landed_, state);
}

// dop853: e5^2 / sqrt(e5^2 + 0.01 e3^2), Hairer, Norsett & Wanner 1993, II.10.
double EmbeddedRungeKutta::estimate(double h) {
  norm_.scale(start_, stages_.k(0), h, end_);
  stages_.sum(h, error_w_, error_);
  const double e5 = norm_.of(error_, end_);
  if (!scheme_.second || e5 == 0) return e5;
  stages_.sum(h, second_w_, error_);
  const double e3 = norm_.of(error_, end_);
  return std::isfinite(e5) && std::isfinite(e3) ? e5 * (e5 / std::hypot(e5, 0.1 * e3)) : HUGE_VAL;
}

// Where a solve sees badly the estimate is spoilt whatever the step: a slightly different one lands elsewhere.
bool EmbeddedRungeKutta::misplaced(const Try& t) const {
  if (fixed() || on_ == StagesOn::plain || blind(0)) return false;
  if (blind(scheme_.late_stage)) return true;  // the next step would begin there
  return t.error > 1 && detector() < kSingular;
}

// A solver without a detector is taken at its smallest pivot, which redundant rows make small everywhere.
double EmbeddedRungeKutta::detector() const {
  double smallest = HUGE_VAL;
  for (int i = 0; i < scheme_.tableau.n_stages; ++i) {
    const Sight& s = stages_.sight(i);
    smallest = std::min(smallest, std::isfinite(s.detector) ? s.detector : s.pivot);
  }
  return smallest;
}

// Accelerations are uncertain where the rows could not be met, and by round-off over the detector.
bool EmbeddedRungeKutta::blind(int stage) const {
  const Sight& s = stages_.sight(stage);
  return s.residual > kRowTolerance || s.detector < kNowhere || s.detector * norm_.tolerance().relative < kRoundOff;
}

double EmbeddedRungeKutta::longest(double h) const {
  return fixed() || on_ == StagesOn::plain ? h : std::min(h, time_to_turn(kTurn));
}

// s, by the body that turns fastest at the start of the step.
double EmbeddedRungeKutta::time_to_turn(double angle) const {
  double w2 = 0;
  for (Eigen::Index i = 3; i < start_.v.size(); i += 6) w2 = std::max(w2, start_.v.segment<3>(i).squaredNorm());
  return w2 > 0 ? angle / std::sqrt(w2) : HUGE_VAL;
}

// The rate at the end of the last step, which the new one begins with, against its late stage's.
void EmbeddedRungeKutta::watch_stiffness(const Dynamics& dynamics, double h) {
  const VecX &a1 = stages_.k(0).v, &a0 = stages_.k(scheme_.late_stage).v;
  const double L2 = dynamics.system().length() * dynamics.system().length();
  if (watch_.fresh()) a_before_ = a1;
  double dv2 = 0, da2 = 0, da_dv = 0, a2 = 0, change2 = 0;
  for (Eigen::Index i = 0; i < a1.size(); ++i) {
    const double dv = gap_.v[i], da = a1[i] - a0[i], change = a1[i] - a_before_[i], weight = i % 6 < 3 ? 1.0 : L2;
    dv2 += weight * dv * dv, da2 += weight * da * da, da_dv += weight * da * dv;
    a2 += weight * a1[i] * a1[i], change2 += weight * change * change;
  }
  watch_.look(h, dv2, da2, da_dv, a2 > 0 ? std::sqrt(change2 / a2) : 1.0);
}

std::string EmbeddedRungeKutta::blame(double h, double t, int rejected) const {
  const std::string text = fmt::format("{}: the step shrank to {:.3g} s at t = {:.9g} s after {} rejections; ",
                                       scheme_.name, h, t, rejected);
  if (watch_.stiff() && detector() > kSingular)
    return text +
           "damped fast modes limit it (stiffness): take an implicit method (--integrator radau5 or "
           "generalized_alpha)";
  return text + "take another method (--integrator), a wider tolerance, or look for a singular place (lockstep check)";
}

bool EmbeddedRungeKutta::dense(double t, State& out) const {
  if (!dynamics_) return false;
  copy_motion(start_, out);
  out.z = start_.z;
  out.modes = start_.modes;
  if (h_ == 0) return t == start_.t;
  if (!dense_ready_) prepare_dense();
  const double theta = (t - start_.t) / h_;
  double factor = theta;  // theta, theta (1 - theta), theta^2 (1 - theta), ...
  for (std::size_t i = 0; i < poly_.size(); ++i) {
    out.q += factor * poly_[i].q;
    out.v += factor * poly_[i].v;
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
  stages_.evaluate(*dynamics_, start_, h_, tableau.n_stages, tableau.n_all, on_);
  const auto each = [&](auto part, auto state_part) {
    VecX &p0 = poly_[0].*part, &p1 = poly_[1].*part, &p2 = poly_[2].*part;
    p0 = end_.*state_part - start_.*state_part;
    p1 = h_ * (stages_.k(0).*part) - p0;
    p2 = p0 - h_ * (stages_.k(scheme_.end_stage).*part) - p1;
  };
  each(&StateRate::q, &State::q);
  each(&StateRate::v, &State::v);
  each(&StateRate::s, &State::s);
  for (int i = 0; i < scheme_.n_dense; ++i)
    stages_.sum(h_, dense_w_[static_cast<std::size_t>(i)], poly_[static_cast<std::size_t>(3 + i)]);
  dense_ready_ = true;
}

void EmbeddedRungeKutta::save(Snapshot& out) const {
  control_.save(out);
  watch_.save(out);
  out.put(singular_ ? 1 : 0);
}

void EmbeddedRungeKutta::restore(const Snapshot& in) {
  control_.restore(in);
  watch_.restore(in);
  singular_ = in.get() != 0;
  h_ = 0;
}

double EmbeddedRungeKutta::first_step(Dynamics& dynamics, const State& state, double largest) {
  if (fixed()) return 0;
  h_ = 0;  // its scratch is the dense output's
  dense_ready_ = false;
  const double guess =
      guess_first_step(dynamics, state, scheme_.tableau.order, largest, norm_, poly_[0], poly_[1], end_);
  if (options_.stages == StagesWhen::plain) return guess;
  copy_motion(state, start_);
  on_ = StagesOn::manifold;
  from_both_sides_ = false;
  first_stage(dynamics);
  return from_both_sides_ ? std::min(largest, std::max(guess, time_to_turn(kLeave))) : guess;
}

}  // namespace lockstep
