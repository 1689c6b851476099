// SPDX-License-Identifier: BSD-3-Clause
// BDF of orders 1 to 5 with variable steps, by IDA of SUNDIALS, as a plugin: for stiff mechanisms.
//
//   F(t, u, u') = u' - f(t, u + d) = 0,   y = (q, v, s) = u + d
//
// f = Dynamics::rate, the equations of motion solved for the accelerations. After each step the state that is returned
// is projected and its quaternions are normalised, without IDA's knowledge: the move is added to the shift d, so that
// IDA continues with an unchanged u while its equation uses the projected state. For a multistep method this moves the
// whole history by one constant vector: differences are unchanged, and so are order and step.
#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <spdlog/fmt/fmt.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>
#include <type_traits>

#include <lockstep/author/plugin.h>
#include <lockstep/author/stepping.h>

namespace {

using namespace lockstep;

static_assert(std::is_same_v<realtype, double>, "SUNDIALS was built for another precision");

using Flat = Eigen::Map<VecX>;

/// What IDA works on: vectors, a dense matrix and its solver, made and freed together. For n numbers; throws std::bad_alloc.
class Memory {
 public:
  explicit Memory(Eigen::Index n) {
    SUNContext_Create(nullptr, &context_);
    u = N_VNew_Serial(n, context_);
    ud = N_VNew_Serial(n, context_);
    inside = N_VNew_Serial(n, context_);
    J_ = SUNDenseMatrix(n, n, context_);
    solver_ = SUNLinSol_Dense(u, J_, context_);
    ida = IDACreate(context_);
    if (!u || !ud || !inside || !J_ || !solver_ || !ida) {
      release();
      throw std::bad_alloc();
    }
  }
  ~Memory() { release(); }
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;

  /// From u and ud at t; `self` is what the callbacks get.
  void start(double t, IDAResFn residual, IDALsJacFn jacobian, IDAEwtFn weights, int max_order, void* self) {
    IDAInit(ida, residual, t, u, ud);
    IDASetUserData(ida, self);
    IDASetErrHandlerFn(
        ida, [](int, const char*, const char*, char*, void*) {}, nullptr);  // errors are reported by Ida
    IDAWFtolerances(ida, weights);
    IDASetLinearSolver(ida, solver_, J_);
    IDASetJacFn(ida, jacobian);
    IDASetMaxOrd(ida, max_order);
  }

  void* ida = nullptr;
  N_Vector u = nullptr, ud = nullptr, inside = nullptr;  // inside: u at an instant within the last step

 private:
  void release() {
    if (ida) IDAFree(&ida);
    if (solver_) SUNLinSolFree(solver_);
    if (J_) SUNMatDestroy(J_);
    for (N_Vector v : {inside, ud, u})
      if (v) N_VDestroy(v);
    SUNContext_Free(&context_);
  }

  SUNContext context_ = nullptr;
  SUNMatrix J_ = nullptr;
  SUNLinearSolver solver_ = nullptr;
};

Flat numbers(N_Vector v) { return {N_VGetArrayPointer(v), N_VGetLength(v)}; }

/// Works for a State and for a StateRate: both have q, v, s.
template <class Parts>
void flatten(const Parts& in, VecX& out) {
  out << in.q, in.v, in.s;
}
template <class Parts>
void unflatten(const VecX& in, Parts& out) {
  out.q = in.head(out.q.size());
  out.v = in.segment(out.q.size(), out.v.size());
  out.s = in.tail(out.s.size());
}

/// Error weights are increments, as everywhere (stepping.h), from the rates and the step at the beginning of each step;
/// quadratures do not count. The Jacobian is dense, by differences, with one evaluation per number of the state: for
/// mechanisms of some ten bodies. Dense output is IDA's own. A run that resumes from a checkpoint begins with order 1,
/// since IDA does not give access to its history.
class Ida final : public Integrator {
 public:
  explicit Ida(int max_order) : max_order_(max_order) {}

  static TypeInfo type_info() {
    return {"ida",
            "BDF of orders 1 to 5 with error control and dense output, from SUNDIALS: stiff mechanisms",
            {{"max_order", Form::integer, Unit::none, 5, "highest order, 1 to 5; 2 damps all stiff modes", {}}}};
  }

  static std::unique_ptr<Integrator> make(const Params& p) {
    const int order = p.integer("max_order");
    if (order < 1 || order > 5) p.refuse("max_order", "is " + std::to_string(order) + "; IDA has the orders 1 to 5");
    return std::make_unique<Ida>(order);
  }

  IntegratorInfo info() const override { return {"ida", max_order_, true, true, 2}; }

  void begin(Dynamics& dynamics, const State& state) override {
    start_ = stage_ = end_ = state;
    rate_ = difference_ = {state.q, state.v, state.s};  // for their sizes
    const Eigen::Index n = state.q.size() + state.v.size() + state.s.size();
    for (VecX* x : {&y_, &f_, &shift_, &shift_before_, &scale_}) x->setZero(n);
    norm_.set_states(dynamics.system().n_error_controlled_states());
    memory_ = std::make_unique<Memory>(n);
    started_ = followed_ = false;
  }

  StepReport step(Dynamics& dynamics, State& state, double h) override {
    dynamics_ = &dynamics;
    start_.z = stage_.z = end_.z = state.z;
    start_.t = state.t, start_.q = state.q, start_.v = state.v, start_.s = state.s;
    StepReport report;
    const long rejected = rejections();
    bool again = !followed_ || !is_end_of_last_step(state, dynamics.system().n_error_controlled_states());
    followed_ = false;
    for (report.h = h;; report.h *= 0.5, ++report.rejected, again = true) {
      if (state.t + report.h == state.t) refuse(state.t, report.h, "the step size became too small");
      if (again) restart(report.h);
      advance(report);
      if (land(report)) break;
    }
    IDAGetCurrentStep(memory_->ida, &h_next_);
    report.h_next = h_next_;
    report.rejected += static_cast<int>(std::max(rejections() - rejected, 0L));
    followed_ = true;
    state.t = end_.t, state.q = end_.q, state.v = end_.v, state.s = end_.s;
    return report;
  }

  bool dense(double t, State& out) const override {
    out.z = start_.z, out.modes = start_.modes, out.watched = start_.watched;
    out.t = t;
    if (!followed_) {
      out.q = start_.q, out.v = start_.v, out.s = start_.s;
      return t == start_.t;
    }
    if (IDAGetDky(memory_->ida, t, 0, memory_->inside) != IDA_SUCCESS) return false;
    y_ = numbers(memory_->inside) + shift_before_;
    unflatten(y_, out);
    dynamics_->normalize(out);
    return true;
  }

  void set_tolerance(const Tolerance& tolerance) override { norm_.set(tolerance), tolerance_ = tolerance; }

  double first_step(Dynamics& dynamics, const State& state, double largest) override {
    return guess_first_step(dynamics, state, 1, largest, norm_, rate_, difference_, stage_);
  }

  void restore(SnapshotReader&) override { followed_ = false; }
  bool saves_all() const override { return false; }  // IDA keeps its history to itself

 private:
  // -- IDA's callbacks; an exception must not pass through IDA, so it waits in thrown_
  template <class Act>
  int guarded(Act&& act) {
    try {
      act();
      return 0;
    } catch (const NonFiniteError&) {
      thrown_ = std::current_exception();
      return 1;  // IDA takes a smaller step
    } catch (const SolveError&) {
      thrown_ = std::current_exception();
      return 1;
    } catch (...) {
      thrown_ = std::current_exception();
      return -1;
    }
  }

  // r = u' - f(t, u + d)
  static int residual(double t, N_Vector u, N_Vector ud, N_Vector r, void* self) {
    Ida& ida = *static_cast<Ida*>(self);
    return ida.guarded([&] {
      ida.y_ = numbers(u) + ida.shift_;
      ida.evaluate(t);
      numbers(r) = numbers(ud) - ida.f_;
    });
  }

  // dF/du + cj dF/du' = cj - f', column by column; f at u itself is u' - r.
  static int jacobian(double t, double cj, N_Vector u, N_Vector ud, N_Vector r, SUNMatrix J, void* self, N_Vector,
                      N_Vector, N_Vector) {
    Ida& ida = *static_cast<Ida*>(self);
    return ida.guarded([&] {
      ida.y_ = numbers(u) + ida.shift_;
      const double L = ida.dynamics_->system().length();
      const Sizes v = largest(ida.y_.segment(ida.start_.q.size(), ida.start_.v.size()));
      ida.set_scale({L, 1}, {std::max(v.linear, L), std::max(v.angular, 1.0)});
      ida.scale_.tail(ida.start_.s.size()).setOnes();
      const Plane plane = ida.dynamics_->system().plane();
      for (Eigen::Index j = 0; j < ida.y_.size(); ++j) {
        const double y = ida.y_[j];
        const bool is_out = plane && j < ida.start_.q.size() && j % 7 == plane.n;  // nothing depends on it
        if (!is_out) ida.y_[j] += kMove * std::max(std::abs(y), ida.scale_[j]);
        const double d = is_out ? 1 : ida.y_[j] - y;
        ida.evaluate(t);
        ida.y_[j] = y;
        Flat(SUNDenseMatrix_Column(J, j), ida.y_.size()) = (numbers(ud) - numbers(r) - ida.f_) / d;
        SUNDenseMatrix_Column(J, j)[j] += cj;
      }
    });
  }

  // Weights 1/(atol + rtol increment), increment = h |rate|. IDA takes the root of the mean square; the factor sqrt(n)
  // makes that the root of the sum.
  static int weights(N_Vector u, N_Vector w, void* self) {
    Ida& ida = *static_cast<Ida*>(self);
    return ida.guarded([&] {
      ida.y_ = numbers(u) + ida.shift_;
      ida.f_ = numbers(ida.memory_->ud);
      const auto n_q = ida.start_.q.size(), n_v = ida.start_.v.size(), n_s = ida.start_.s.size();
      const Sizes v = largest(ida.y_.segment(n_q, n_v)), a = largest(ida.f_.segment(n_q, n_v));
      ida.set_scale({v.linear, 0.5 * v.angular}, a);  // e' = e (0, w)/2
      ida.scale_.tail(n_s) = ida.f_.tail(n_s).cwiseAbs();
      ida.scale_ = (ida.tolerance_.atol_x + kTiny + ida.tolerance_.relative * ida.h_ * ida.scale_.array()).matrix();
      ida.scale_.tail(n_s - ida.dynamics_->system().n_error_controlled_states()).setConstant(kNoWeight);
      numbers(w) = std::sqrt(static_cast<double>(ida.y_.size())) * ida.scale_.cwiseInverse();
    });
  }

  /// f_ = f(t, y_).
  void evaluate(double t) {
    unflatten(y_, stage_);
    stage_.t = t;
    dynamics_->rate(stage_, rate_);
    flatten(rate_, f_);
  }

  struct Sizes {
    double linear = 0, angular = 0;
  };
  /// The largest velocities or accelerations over all slots.
  static Sizes largest(Eigen::Ref<const VecX> v) {
    Sizes most;
    for (Eigen::Index i = 0; i < v.size(); i += 6) {
      most.linear = std::max(most.linear, v.segment<3>(i).norm());
      most.angular = std::max(most.angular, v.segment<3>(i + 3).norm());
    }
    return most;
  }
  /// One scale for each kind of quantity; states s have their own.
  void set_scale(const Sizes& q, const Sizes& v) {
    const Eigen::Index n_q = start_.q.size(), n_v = start_.v.size();
    for (Eigen::Index i = 0; i < n_q; i += 7)
      scale_.segment<3>(i).setConstant(q.linear), scale_.segment<4>(i + 3).setConstant(q.angular);
    for (Eigen::Index i = n_q; i < n_q + n_v; i += 6)
      scale_.segment<3>(i).setConstant(v.linear), scale_.segment<3>(i + 3).setConstant(v.angular);
  }

  // -- a step
  /// Whether this is the state that step() left, not one moved since (an event, a jump of a law, another run).
  /// Of State::s the first `n` are compared: an accepted step corrects counted angles, which come after them.
  bool is_end_of_last_step(const State& state, int n) const {
    return std::abs(state.t - end_.t) <= kSameInstant * std::max(1.0, std::abs(state.t)) && state.q == end_.q &&
           state.v == end_.v && state.s.size() == end_.s.size() && state.s.head(n) == end_.s.head(n);
  }

  /// From start_ with order 1 and a first step of at most h.
  void restart(double h) {
    flatten(start_, y_);
    numbers(memory_->u) = y_;
    shift_.setZero();
    evaluate(start_.t);
    numbers(memory_->ud) = f_;
    if (!started_)
      memory_->start(start_.t, residual, jacobian, weights, max_order_, this);
    else
      IDAReInit(memory_->ida, start_.t, memory_->u, memory_->ud);
    started_ = true;
    IDASetInitStep(memory_->ida, h);
    h_next_ = h;
  }

  /// One step of IDA, of at most report.h, which becomes its length; its end goes to end_.
  void advance(StepReport& report) {
    const double to = start_.t + report.h;
    double t = start_.t;
    int flag = IDASetStopTime(memory_->ida, to);
    h_ = std::min(report.h, h_next_);
    thrown_ = nullptr;
    shift_before_ = shift_;
    // more than once if the last step ended a rounding before the requested instant
    while (flag >= 0 && t - start_.t <= 1e-3 * kSameInstant * std::abs(t))
      flag = IDASolve(memory_->ida, to, &t, memory_->u, memory_->ud, IDA_ONE_STEP);
    if (flag < 0) {
      if (thrown_) std::rethrow_exception(thrown_);
      refuse(start_.t, report.h, "IDA failed (code " + std::to_string(flag) + ")");
    }
    if (t < to) report.h = t - start_.t;
    y_ = numbers(memory_->u) + shift_;
    unflatten(y_, end_);
    end_.t = t < to ? t : to;
  }

  /// Normalises the quaternions, then projects onto the constraints if the dynamics does so; the move goes into the
  /// shift. False if it was too far.
  bool land(StepReport& report) {
    const ProjectReport landed = project_end(*dynamics_, end_);
    report.violation = landed.before, report.violation_after = landed.after;
    if (!end_is_near(*dynamics_, landed)) return false;
    flatten(end_, y_);
    shift_ = y_ - numbers(memory_->u);
    return true;
  }

  long rejections() const {
    if (!started_) return 0;
    long of_error = 0, of_newton = 0;
    IDAGetNumErrTestFails(memory_->ida, &of_error);
    IDAGetNumNonlinSolvConvFails(memory_->ida, &of_newton);
    return of_error + of_newton;
  }

  [[noreturn]] static void refuse(double t, double h, const std::string& what) {
    throw StepError(fmt::format("ida: {} (t = {:.9g} s, step {:.3g} s); use another method (--integrator), a larger "
                                "tolerance, or check for a singular configuration (lockstep check)",
                                what, t, h),
                    t);
  }

  static constexpr double kMove = 1.5e-8;        // relative step of differences: the root of the rounding unit
  static constexpr double kTiny = 1e-300;        // where nothing moves and there is no absolute tolerance
  static constexpr double kNoWeight = 1e30;      // accepts any error
  static constexpr double kSameInstant = 1e-12;  // relative to the time

  int max_order_;
  Tolerance tolerance_;
  ErrorNorm norm_;  // of the first step
  Dynamics* dynamics_ = nullptr;
  std::unique_ptr<Memory> memory_;
  double h_ = 0, h_next_ = 0;  // that the weights use, that IDA proposes
  bool started_ = false;       // IDA has been started
  bool followed_ = false;      // a step was made, and the next one may continue from it
  State start_, stage_, end_;
  StateRate rate_, difference_;
  mutable VecX y_;  // scratch
  VecX f_, scale_;
  VecX shift_, shift_before_;  // d, now and during the last step
  std::exception_ptr thrown_;
};

}  // namespace

LOCKSTEP_PLUGIN(registry) { registry.integrators.add(Ida::type_info(), &Ida::make); }
