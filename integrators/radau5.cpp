// SPDX-License-Identifier: BSD-3-Clause
// Sources: E. Hairer & G. Wanner, Solving Ordinary Differential Equations II (1996), IV.5 (method) and IV.8
// (transformed Newton iteration, its stop rule, error estimate).
#include <lockstep/integrators.h>

#include <algorithm>
#include <cmath>
#include <utility>


namespace lockstep {

namespace {

constexpr double kTurn = 2.5;  // rad per step: the rotation vector must stay well away from a full revolution
constexpr double kSqrt6 = 2.4494897427831780982;

constexpr double kC[3] = {(4 - kSqrt6) / 10, (4 + kSqrt6) / 10, 1};
// T^-1 A^-1 T = (real | alpha, -beta; beta, alpha); Z = T W. Computed from the eigenvectors of A^-1.
constexpr double kReal = 3.6378342527444957322, kAlpha = 2.6810828736277521339, kBeta = 3.0504301992474105694;
constexpr double kT[3][3] = {{0.09123239487089294279, -0.14125529502095420843, -0.030029194105147424492},
                             {0.24171793270710701896, 0.20412935229379993199, 0.38294211275726193779},
                             {0.96604818261509293619, 1, 0}};
constexpr double kTi[3][3] = {{4.3255798900631553510, 0.33919925181580986954, 0.54177053993587487119},
                              {-4.1787185915519047273, -0.32768282076106238708, 0.47662355450055045196},
                              {-0.50287263494578687595, 2.5719269498556054292, -0.59603920482822492497}};
constexpr double kEndRate[3] = {-1 + 8 * kSqrt6 / 3, -1 - 8 * kSqrt6 / 3, 5};  // last row of A^-1
// error = (real/h - f')^-1 (f0 + sum e_i Z_i / h), IV.8 (8.19)
constexpr double kError[3] = {-(13 + 7 * kSqrt6) / 3, (-13 + 7 * kSqrt6) / 3, -1.0 / 3};

template <class M>
auto row(const double (&w)[3], const M& columns) {
  return w[0] * columns.col(0) + w[1] * columns.col(1) + w[2] * columns.col(2);
}

// Weights of the stages in the polynomial through 0 at x = 0 and the stages at x = c_i.
void collocation_weights(double x, double (&w)[3]) {
  for (int i = 0; i < 3; ++i) {
    w[i] = x / kC[i];
    for (int j = 0; j < 3; ++j)
      if (j != i) w[i] *= (x - kC[j]) / (kC[i] - kC[j]);
  }
}

}  // namespace

TypeInfo Radau5::type_info() {
  return {"radau5",
          "implicit Runge-Kutta of order 5 with error control and dense output: stiff and accurate",
          {{"fixed", Form::boolean, Unit::none, false, "use the given step, without error control", {}}}};
}

std::unique_ptr<Integrator> Radau5::make(const Params& params) {
  return std::make_unique<Radau5>(params.boolean("fixed"));
}

Radau5::Radau5(bool fixed) : AdaptiveStepper(3, fixed ? nullptr : std::make_unique<PredictiveControl>()) {
  set_tolerance({});
}

IntegratorInfo Radau5::info() const { return {"radau5", 5, true, !fixed(), kStages}; }

void Radau5::begin(Dynamics& dynamics, const State& state) {
  AdaptiveStepper::begin(dynamics, state);
  stage_ = state;
  for (StateRate* rate : {&rate0_, &rate_, &difference_}) size_like(state, *rate);
  const Eigen::Index n = n_increments(state), n_v = state.v.size();
  for (Columns* c : {&Z_, &W_, &F_, &before_}) c->setZero(n, kStages);
  for (VecX* v : {&f0_, &r_, &r2_, &y_, &y2_, &error_}) v->setZero(n);
  end_rate_v_.setZero(n_v), end_rate_s_.setZero(state.s.size());
  linear_.begin(state);
  output_.begin(state);
  h_before_ = 0;
}

// The estimate scales with h^4, the weights with h (increments) or with 1 (absolute part), the error of a run with h^5.
// For the error of a run to follow the tolerance with slope one, estimates up to c tol^-2/5 or c tol^-1/5 tolerances
// must pass. An exponent between them serves both.
void Radau5::set_tolerance(const Tolerance& tolerance) {
  norm_.set(fixed() ? Tolerance{1e-8, 1e-10} : tolerance);
  loose_ = fixed() ? 1 : std::max(1.0, 0.12 / std::cbrt(tolerance.relative + tolerance.atol_x));
}

double Radau5::start_step(Dynamics& dynamics, double h) {
  stage_.z = start_.z;
  output_.forget();
  dynamics.rate(start_, rate0_);
  y_.setZero();
  increment_rates(y_, start_, rate0_, f0_);
  again_ = false;
  return h;
}

Attempt Radau5::attempt(Dynamics& dynamics, double h) {
  Attempt made;
  careful_ = std::exchange(again_, true) || h_before_ == 0;
  norm_.scale(start_, rate0_, h, start_);
  guess(h);
  linearize(dynamics, h);
  if (solve_stages(dynamics, h, made)) {
    displace_state(start_, Z_.col(2), end_);
    end_.t = start_.t + h;
    if (!fixed()) made.error = estimate(dynamics, h) / loose_;
    made.accepted = made.error <= 1;
  } else if (fixed()) {
    newton_failed(h, "or let the method choose it (\"fixed\": false)");
  }
  return made;
}

// Tangents at the second stage as known so far: the middle one of the three.
void Radau5::linearize(Dynamics& dynamics, double h) {
  displace_state(start_, Z_.col(1), stage_);
  stage_.t = start_.t + kC[1] * h;
  linear_.gather(dynamics.rate(stage_, rate_));
  linear_.factor(kReal / h);
  linear_.factor(LinearizedMotion::Complex(kAlpha, kBeta) / h);
  dynamics.work().factors += 2;
}

// Initial stages: the polynomial of the last step, extrapolated; zeros if there is none, or if the state was moved
// since.
void Radau5::guess(double h) {
  const double moved = std::abs(start_.t - t_before_);
  if (h_before_ == 0 || h > 4 * h_before_ || moved > 1e-12 * std::max(std::abs(start_.t), h_before_)) {
    Z_.setZero();
    W_.setZero();
    return;
  }
  for (int i = 0; i < kStages; ++i) {
    double w[3];
    collocation_weights(1 + kC[i] * h / h_before_, w);
    y_ = row(w, before_);
    count_from(before_.col(2), start_.v.size(), y_);
    Z_.col(i) = y_;
  }
  for (int i = 0; i < kStages; ++i) W_.col(i) = row(kTi[i], Z_);
}

// Newton until theta/(1 - theta) |dZ| is small relative to the tolerance, IV.8 (8.10), (8.11).
bool Radau5::solve_stages(Dynamics& dynamics, double h, Attempt& made) {
  const double goal = newton_goal();
  double before = 0, theta = 0;
  for (made.iterations = 1; made.iterations <= PredictiveControl::kMostIterations; ++made.iterations) {
    for (int i = 0; i < kStages; ++i)
      if (largest_turn(Z_.col(i), start_.v.size()) > kTurn) return false;
    evaluate_stages(dynamics, h);
    const double now = correct(h);
    if (!std::isfinite(now)) return false;
    if (now == 0) return true;
    if (made.iterations > 1) {
      const double ratio = now / before;
      theta = made.iterations == 2 ? ratio : std::sqrt(theta * ratio);
      const double left = PredictiveControl::kMostIterations - made.iterations;
      if (theta >= 0.99) return now <= 10 * goal;  // round-off, or divergence
      const double remains = theta / (1 - theta) * now;
      if (remains <= goal) return true;
      const double expected = remains * std::pow(theta, left);
      if (expected > goal) {
        made.next = h * std::clamp(0.8 * std::pow(expected / goal, -1 / (4 + left)), 0.1, 0.8);
        return false;
      }
    } else if (now <= 1e-2 * goal) {
      return true;
    }
    before = now;
  }
  return false;
}

void Radau5::evaluate_stages(Dynamics& dynamics, double h) {
  for (int i = 0; i < kStages; ++i) {
    displace_state(start_, Z_.col(i), stage_);
    stage_.t = start_.t + kC[i] * h;
    dynamics.rate(stage_, rate_);
    increment_rates(Z_.col(i), stage_, rate_, F_.col(i));
  }
}

// (Lambda/h - f') dW = T^-1 F - Lambda/h W;  W += dW,  Z = T W; the largest change of a stage.
double Radau5::correct(double h) {
  const double g = kReal / h, a = kAlpha / h, b = kBeta / h;
  r_ = row(kTi[0], F_) - g * W_.col(0);
  linear_.solve(g, r_, y_);
  W_.col(0) += y_;
  r_ = row(kTi[1], F_) - (a * W_.col(1) - b * W_.col(2));
  r2_ = row(kTi[2], F_) - (b * W_.col(1) + a * W_.col(2));
  linear_.solve(LinearizedMotion::Complex(a, b), r_, r2_, y_, y2_);
  W_.col(1) += y_;
  W_.col(2) += y2_;
  double most = 0;
  for (int i = 0; i < kStages; ++i) {
    y_ = row(kT[i], W_);
    error_ = y_ - Z_.col(i);
    most = std::max(most, size_of(error_));
    Z_.col(i) = y_;
  }
  return most;
}

double Radau5::size_of(const VecX& y) {
  as_difference(y, start_, difference_);
  return norm_.of(difference_, start_);
}

// In units of the tolerance; kappa = sqrt(tolerance) between round-off and 0.03.
double Radau5::newton_goal() const {
  const double tolerance = norm_.tolerance().relative + norm_.tolerance().atol_x;
  if (fixed()) return 1e-3;
  return loose_ * std::max(1e-15 / tolerance, std::min(0.03, std::sqrt(loose_ * tolerance)));
}

// A first estimate that is too large is filtered once more if it may be the stiff part alone, IV.8 (8.20).
double Radau5::estimate(Dynamics& dynamics, double h) {
  norm_.scale(start_, rate0_, h, end_);
  r2_ = row(kError, Z_) / h;
  r_ = f0_ + r2_;
  linear_.solve(kReal / h, r_, error_);
  const double e = size_of(error_);
  if (e <= loose_ || !std::isfinite(e) || !careful_) return e;
  displace_state(start_, error_, stage_);
  stage_.t = start_.t;
  dynamics.rate(stage_, rate_);
  increment_rates(error_, stage_, rate_, r_);
  r_ += r2_;
  linear_.solve(kReal / h, r_, error_);
  return size_of(error_);
}

// The rates at the end are those of the collocation polynomial, h y'(1) = sum (A^-1)_3j Z_j: no stiff term magnifies
// the residual of Newton's method.
void Radau5::finish_step(Dynamics&, StepReport& report) {
  const double h = report.h;
  r_ = row(kEndRate, Z_) / h;
  const Eigen::Index n = start_.v.size();
  end_rate_v_ = r_.segment(n, n);
  end_rate_s_ = r_.tail(start_.s.size());
  output_.set(start_, rate0_.v, rate0_.s, end_, end_rate_v_, end_rate_s_);
  before_ = Z_;
  h_before_ = h;
  t_before_ = start_.t + h;
}

void Radau5::save(Snapshot& out) const {
  AdaptiveStepper::save(out);
  out.put(h_before_), out.put(t_before_);
  for (int i = 0; i < kStages; ++i) out.put_all(before_.col(i));
}

void Radau5::restore(SnapshotReader& in) {
  AdaptiveStepper::restore(in);
  h_before_ = in.get(), t_before_ = in.get();
  for (int i = 0; i < kStages; ++i) {
    in.get_all(y_);
    if (y_.size() != before_.rows()) throw ModelError("radau5: the saved history belongs to another mechanism");
    before_.col(i) = y_;
  }
  output_.forget();
}

}  // namespace lockstep
