// SPDX-License-Identifier: BSD-3-Clause
// An integrator as a plugin: Adams and Bashforth's explicit multistep methods of order 2, 3 and 4.
//
//   y(t + x) = y + sum_j w_j(x) f_j,   sum_j w_j t_j^m = x^(m+1)/(m+1),  m = 0 ... order - 1,   t_j: times before t
//
// One evaluation per step; the weights follow from the times of the last steps, so that the step may change a little.
// The end of a step is projected onto the constraints: a move as small as the error of the step. The stored rates are
// those of the projected states, which are off the smooth curve by as much, so the order is preserved. Where the
// history does not fit - at the beginning, after an event, when the state was moved, when the step changes much - a
// step of Runge and Kutta's method of order 4 is made instead.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include <lockstep/author/plugin.h>
#include <lockstep/author/stepping.h>
#include <lockstep/dynamics.h>

namespace {

using namespace lockstep;

class AdamsBashforth final : public Integrator {
 public:
  explicit AdamsBashforth(int order) : order_(order) {}

  static TypeInfo type_info() {
    return {
        "adams_bashforth",
        "explicit multistep of order 2 to 4, fixed step: one evaluation per step, for smooth motions without events",
        {{"order", Form::integer, Unit::none, 4, "2, 3 or 4"}}};
  }
  static std::unique_ptr<Integrator> make(const Params& p) {
    const int order = p.integer("order");
    if (order < 2 || order > 4) p.refuse("order", "is " + std::to_string(order) + "; must be 2, 3 or 4");
    return std::make_unique<AdamsBashforth>(order);
  }

  IntegratorInfo info() const override { return {"adams_bashforth", order_, false, false, 1}; }

  void begin(Dynamics&, const State& state) override {
    end_ = stage_ = start_ = state;
    for (StateRate& k : k_) k = {state.q, state.v, state.s};  // for their sizes
    kept_.assign(order_, {state.t, k_[0]});
    n_kept_ = 0;
  }

  StepReport step(Dynamics& dynamics, State& state, double h) override {
    if (n_kept_ > 0 && !is_end_of_last_step(state, dynamics.system().n_error_controlled_states())) n_kept_ = 0;
    dynamics.rate(state, k_[0]);
    const bool multi = fits(state.t, h);
    start_ = state;
    if (multi)
      add_up(h, end_);
    else
      runge_kutta(dynamics, h);
    end_.t = state.t + h, end_.z = state.z, end_.modes = state.modes, end_.watched = state.watched;
    const ProjectReport landed = project_end_or_throw(dynamics, end_, "adams_bashforth", state.t, h);
    keep(state.t);
    state = end_;
    StepReport report;
    report.h = h, report.violation = landed.before, report.violation_after = landed.after;
    return report;
  }

  // t_j and f_j, and the end of the last step: with the State, all that the next step reads
  void save(Snapshot& s) const override {
    s.put(n_kept_);
    for (int j = 0; j < n_kept_; ++j) {
      const Kept& k = kept_[j];
      s.put(k.t), s.put_all(k.f.q), s.put_all(k.f.v), s.put_all(k.f.s);
    }
    s.put(end_.t), s.put_all(end_.q), s.put_all(end_.v), s.put_all(end_.s);
  }
  void restore(SnapshotReader& s) override {
    n_kept_ = static_cast<int>(s.get());
    for (int j = 0; j < n_kept_; ++j) {
      Kept& k = kept_[j];
      k.t = s.get(), s.get_all(k.f.q), s.get_all(k.f.v), s.get_all(k.f.s);
    }
    end_.t = s.get(), s.get_all(end_.q), s.get_all(end_.v), s.get_all(end_.s);
  }

 private:
  struct Kept {
    double t;
    StateRate f;
  };

  /// Of State::s the first `n` are compared: an accepted step corrects counted angles, which come after them.
  bool is_end_of_last_step(const State& state, int n) const {
    return std::abs(state.t - end_.t) <= 1e-12 * std::max(1.0, std::abs(state.t)) && state.q == end_.q &&
           state.v == end_.v && state.s.size() == end_.s.size() && state.s.head(n) == end_.s.head(n);
  }

  /// Enough rates before t, at distances like h: very unequal distances would make large weights.
  bool fits(double t, double h) const {
    if (n_kept_ < order_ - 1) return false;
    for (int j = 0; j < order_ - 1; ++j) {
      const double before = kept_[j].t, gap = t - before;
      if (gap < 0.5 * h || gap > 2 * h) return false;
      t = before;
    }
    return true;
  }

  /// out = y + sum_j w_j f_j from start_; k_[0] is the rate at its time, kept_ those before it.
  void add_up(double h, State& out) const {
    Eigen::Matrix4d A = Eigen::Matrix4d::Identity();
    Eigen::Vector4d b = Eigen::Vector4d::Zero();
    for (int m = 0; m < order_; ++m) {
      b[m] = 1.0 / (m + 1);
      for (int j = 0; j < order_; ++j) A(m, j) = std::pow(j == 0 ? 0.0 : (kept_[j - 1].t - start_.t) / h, m);
    }
    const Eigen::Vector4d w = A.partialPivLu().solve(b);
    out.q = start_.q, out.v = start_.v, out.s = start_.s;
    for (int j = 0; j < order_; ++j) move(out, h * w[j], j == 0 ? k_[0] : kept_[j - 1].f);
  }

  void runge_kutta(Dynamics& dynamics, double h) {
    for (std::size_t i = 1; i < 4; ++i) {
      const double c = i < 3 ? 0.5 : 1.0;
      stage_ = start_;
      move(stage_, c * h, k_[i - 1]);
      stage_.t = start_.t + c * h;
      dynamics.rate(stage_, k_[i]);
    }
    end_.q = start_.q, end_.v = start_.v, end_.s = start_.s;
    for (std::size_t i = 0; i < 4; ++i) move(end_, h * (i == 0 || i == 3 ? 1.0 / 6 : 1.0 / 3), k_[i]);
  }

  static void move(State& y, double h, const StateRate& f) { y.q += h * f.q, y.v += h * f.v, y.s += h * f.s; }

  /// The rate at the beginning of the last step becomes the newest of the history.
  void keep(double t) {
    std::rotate(kept_.begin(), kept_.end() - 1, kept_.end());
    kept_.front().t = t, kept_.front().f = k_[0];
    n_kept_ = std::min(n_kept_ + 1, order_);
  }

  int order_, n_kept_ = 0;
  std::vector<Kept> kept_;  // the newest first
  State start_, stage_, end_;
  StateRate k_[4];
};

}  // namespace

LOCKSTEP_PLUGIN(registry) { registry.integrators.add(AdamsBashforth::type_info(), &AdamsBashforth::make); }
