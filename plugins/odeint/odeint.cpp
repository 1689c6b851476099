// SPDX-License-Identifier: BSD-3-Clause
// An integrator as a plugin, and how to wrap one of another library: Cash and Karp's explicit method of order 5 from
// Boost.odeint.
//
//   odeint sees    y' = f(t, y),  y = (q, v, s) one after the other in a std::vector<double>
//   odeint brings  the stages, the estimate of the error, the choice of the step
//   we bring       f = Dynamics::rate, the weights of the error (ErrorNorm), and the projection: Dynamics::project
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_cash_karp54.hpp>

#include <lockstep/author/plugin.h>
#include <lockstep/author/stepping.h>

namespace {

using namespace lockstep;
namespace odeint = boost::numeric::odeint;

using Flat = std::vector<double>;

/// Works for a State and for a StateRate: both have q, v, s.
template <class Parts>
void flatten(const Parts& in, Flat& out) {
  auto at = std::copy(in.q.begin(), in.q.end(), out.begin());
  at = std::copy(in.v.begin(), in.v.end(), at);
  std::copy(in.s.begin(), in.s.end(), at);
}

template <class Parts>
void unflatten(const Flat& in, Parts& out) {
  auto at = in.begin();
  for (VecX* part : {&out.q, &out.v, &out.s}) {
    std::copy_n(at, part->size(), part->begin());
    at += part->size();
  }
}

/// No dense output: steps end at the requested times. No memory either, so save() and restore() are the ones that do
/// nothing. With `fixed` it takes the given steps, without error control.
class CashKarp final : public Integrator {
 public:
  explicit CashKarp(bool fixed) : fixed_(fixed), stepper_(Checker{this}) {}

  static TypeInfo type_info() {
    return {"odeint_cash_karp54",
            "explicit Runge-Kutta of order 5 with error control, from Boost.odeint: the example of wrapping",
            {{"fixed", Form::boolean, Unit::none, false, "fixed steps, without error control", {}}}};
  }

  static std::unique_ptr<Integrator> make(const Params& p) { return std::make_unique<CashKarp>(p.boolean("fixed")); }

  IntegratorInfo info() const override { return {"odeint_cash_karp54", 5, false, !fixed_, 6}; }

  void begin(Dynamics& dynamics, const State& state) override {
    start_ = stage_ = end_ = state;
    rate_ = error_ = {state.q, state.v, state.s};  // for their sizes
    y_.resize(state.q.size() + state.v.size() + state.s.size());
    y_end_ = y_;
    norm_.set_states(dynamics.system().n_error_controlled_states());
  }

  StepReport step(Dynamics& dynamics, State& state, double h) override {
    start_.z = stage_.z = end_.z = state.z;  // what stages may read besides q, v, s
    flatten(state, y_);
    const auto f = [&](const Flat& y, Flat& dydt, double t) {
      unflatten(y, stage_);
      stage_.t = t;
      dynamics.rate(stage_, rate_);
      flatten(rate_, dydt);
    };
    StepReport report;
    for (report.h = h;; ++report.rejected) {
      if (state.t + report.h == state.t) refuse(state.t, report.h, "the step size became too small");
      double t = state.t, h_next = report.h;
      if (fixed_) {
        stepper_.stepper().do_step(f, y_, t, y_end_, report.h);
      } else if (stepper_.try_step(f, y_, t, y_end_, h_next) == odeint::fail) {
        report.h = h_next;
        continue;
      }
      unflatten(y_end_, end_);
      end_.t = state.t + report.h;
      if (land(dynamics, report)) {
        if (!fixed_) report.h_next = h_next;
        state.t = end_.t, state.q = end_.q, state.v = end_.v, state.s = end_.s;
        return report;
      }
      if (fixed_) refuse(state.t, report.h, "the projection after the step did not converge");
      report.h *= 0.5;
    }
  }

  void set_tolerance(const Tolerance& tolerance) override { norm_.set(tolerance); }

  double first_step(Dynamics& dynamics, const State& state, double largest) override {
    return fixed_ ? 0 : guess_first_step(dynamics, state, 5, largest, norm_, rate_, error_, stage_);
  }

 private:
  /// odeint's concept of an ErrorChecker: 1 = the tolerance is just met. `h` and the rates at the beginning make the
  /// weights; an error that is not finite becomes infinite, so that odeint rejects the step.
  struct Checker {
    CashKarp* self;
    template <class Algebra>
    double error(Algebra&, const Flat& y, const Flat& dydt, const Flat& error, double h) const {
      unflatten(y, self->start_);
      unflatten(dydt, self->rate_);
      unflatten(error, self->error_);
      self->norm_.scale(self->start_, self->rate_, h, self->start_);
      return self->norm_.of(self->error_, self->start_);
    }
  };
  using Method = odeint::runge_kutta_cash_karp54<Flat>;

  /// Normalises the quaternions, then projects onto the constraints if the dynamics does so. False if it was too far.
  bool land(Dynamics& dynamics, StepReport& report) {
    const ProjectReport landed = project_end(dynamics, end_);
    report.violation = landed.before, report.violation_after = landed.after;
    return end_is_near(dynamics, landed, fixed_);
  }

  [[noreturn]] static void refuse(double t, double h, const char* what) {
    throw StepError(fmt::format("odeint_cash_karp54: {} (t = {:.9g} s, step {:.3g} s); use a smaller step (--step), or "
                                "an implicit method for stiff dampers (--integrator radau5)",
                                what, t, h),
                    t);
  }

  bool fixed_;
  ErrorNorm norm_;
  odeint::controlled_runge_kutta<Method, Checker> stepper_;
  Flat y_, y_end_;
  State start_, stage_, end_;
  StateRate rate_, error_;
};

}  // namespace

LOCKSTEP_PLUGIN(registry) { registry.integrators.add(CashKarp::type_info(), &CashKarp::make); }
