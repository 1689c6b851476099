// The integrator template_integrator: the midpoint rule, order 2, fixed step.
//
// Change step(), info() and type_info(). Then build and run the test, which measures the order.
#include <spdlog/fmt/fmt.h>

#include <lockstep/author/plugin.h>
#include <lockstep/dynamics.h>

namespace {

using namespace lockstep;

///   y1 = y + h f(t + h/2, y + h/2 f(t, y)),   y = (q, v, s),   then onto the constraints
class TemplateIntegrator final : public Integrator {
 public:
  static TypeInfo type_info() { return {"template_integrator", "midpoint rule of order 2, fixed step", {}}; }
  static std::unique_ptr<Integrator> make(const Params&) { return std::make_unique<TemplateIntegrator>(); }

  /// Name, order, implicit?, chooses its step?, evaluations per step.
  IntegratorInfo info() const override { return {"template_integrator", 2, false, false, 2}; }

  /// Allocates what steps need and clears the history.
  void begin(Dynamics&, const State& state) override {
    middle_ = end_ = state;
    rate_ = {state.q, state.v, state.s};
  }

  /// One step of at most h. An exception leaves `state` unchanged: it is written at the end only.
  StepReport step(Dynamics& dynamics, State& state, double h) override {
    middle_ = end_ = state;
    dynamics.rate(state, rate_);
    move(middle_, 0.5 * h);
    dynamics.rate(middle_, rate_);
    move(end_, h);

    StepReport report;
    report.h = h;
    land(dynamics, state.t, report);
    state = end_;
    return report;
  }

  // A method that keeps a history, or chooses its step, also needs save() and restore(), set_tolerance() and
  // first_step(), and dense() for states inside a step.

 private:
  void move(State& y, double h) const {
    y.t += h;
    y.q += h * rate_.q, y.v += h * rate_.v, y.s += h * rate_.s;
  }

  /// Normalises quaternions, then projects onto the constraints if the run does.
  void land(Dynamics& dynamics, double t, StepReport& report) {
    if (dynamics.options().stabilization.kind != Stabilization::Kind::project) {
      dynamics.normalize(end_);
      report.violation = report.violation_after = dynamics.violation(end_);
      return;
    }
    const ProjectReport landed = dynamics.project(end_);
    report.violation = landed.before, report.violation_after = landed.after;
    if (!landed.converged)
      throw StepError(
          fmt::format("template_integrator: the step of {:.3g} s from t = {:.9g} s cannot be projected onto the "
                      "constraints; use a smaller step (--step)",
                      report.h, t),
          t);
  }

  State middle_, end_;
  StateRate rate_;
};

}  // namespace

LOCKSTEP_PLUGIN(registry) { registry.integrators.add(TemplateIntegrator::type_info(), &TemplateIntegrator::make); }
