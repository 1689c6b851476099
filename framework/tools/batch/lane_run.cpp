// Explicit Runge-Kutta in lanes: every copy has its own time, step and error control; the attempts are made together. A
// copy whose attempt is rejected repeats it with a smaller step while the others go on.
#include <algorithm>
#include <array>
#include <cmath>

#include <lockstep/stepping.h>
#include "framework/dynamics/simulate/step_rules.h"
#include <lockstep/solvers.h>
#include <lockstep/error.h>
#include "framework/tools/batch/copy_run.h"

namespace lockstep::lanes {
namespace {

// What SingularPassage asks of the stages of an attempt.
struct Pivots {
  double fewest = HUGE_VAL, most = 0;  // small ones
  double smallest = 1;                 // of the others, relative to its diagonal
  void add(double n_small, double least) {
    fewest = std::min(fewest, n_small), most = std::max(most, n_small);
    smallest = std::min(smallest, least);
  }
};

struct Lane {
  explicit Lane(int order) : control(order) {}
  bool going = false;  // steps in lanes
  bool rejected = false;  // an attempt at the present step was rejected
  bool lands = false;  // the present attempt ends on the schedule's next instant
  double advised = 0, asked = 0;
  OutputSchedule schedule;
  PiControl control;
  Pace pace;
  ErrorNorm norm;
  Pivots first, stages;     // of the first stage, and of all of them
  double usual = HUGE_VAL;  // number of small pivots: those of rows that are redundant everywhere
  NearSingular singular;
};

class LaneRun {
 public:
  LaneRun(Batch& batch, const RunTask& task, std::span<CopyReport> reports)
      : batch_(batch),
        task_(task),
        reports_(reports),
        fixed_(task.scheme.error == nullptr),
        scheme_(task.scheme),
        tableau_(task.scheme.tableau) {
    for (int i = 0; i < tableau_.n_stages; ++i) a_.emplace_back(tableau_.a + i * tableau_.stride, i);
    b_ = Weights(tableau_.b, tableau_.n_stages);
    if (scheme_.error) error_w_ = Weights(scheme_.error, tableau_.n_stages);
    if (scheme_.second) second_w_ = Weights(scheme_.second, tableau_.n_stages);
    for (Aligned<double>* v : {&y_, &stage_, &end_, &error_}) v->assign(batch.n_numbers(), 0.0);
    k_.resize(static_cast<std::size_t>(tableau_.n_stages));
    for (Aligned<double>& k : k_) k.assign(batch.n_numbers(), 0.0);
    lanes_.assign(kL, Lane(tableau_.order));
  }

  void run(std::span<const State> starts) {
    if (task_.watches) batch_.watch_pivots();
    begin(starts);
    while (std::any_of(lanes_.begin(), lanes_.end(), [](const Lane& lane) { return lane.going; }) && goes_on()) {
      choose_steps();
      attempt();
    }
  }

 private:
  void begin(std::span<const State> starts);
  void read(int lane, const double* y, double t, State& out) const;
  Dynamics dynamics_of(int lane) const;
  double first_step(int lane, const State&) const;
  void cross_jump(int lane, double t);
  void arrive(int lane);
  void tell_step(int lane, bool jumped);
  bool goes_on();
  void choose_steps();
  void attempt();
  Flags8 evaluate_stages();
  void combine_stages(const Weights&, const double* y, double* out);
  double error_of(int lane);
  void estimate(Numbers8& error, Flags8& failed);
  void estimate_together(Numbers8& error, Numbers8& e3, Flags8& failed);
  void estimate_each(Numbers8& error, Numbers8& e3, Flags8& failed);
  void accept(int lane, double error);
  void update_memory(int lane);
  void reject(int lane, double factor);
  void leave(int lane);
  void fail(int lane, const Error&);
  void park(int lane);
  void see_pivots(bool first);
  bool near_singular(int lane);
  bool miscounts(int lane);

  Batch& batch_;
  const RunTask& task_;
  std::span<CopyReport> reports_;
  bool fixed_;
  const EmbeddedScheme& scheme_;
  Tableau tableau_;
  std::vector<Weights> a_;
  Weights b_, error_w_, second_w_;
  std::vector<Lane> lanes_;
  Aligned<double> y_, stage_, end_, error_;
  std::vector<Aligned<double>> k_;
  alignas(64) Numbers8 t_{}, h_{};
  bool first_done_ = false;  // the first stage is evaluated: no lane has moved since
  Numbers8 first_a_{}, first_alpha_{};  // largest accelerations there
  bool jumped_ = false;                 // a copy was moved otherwise than by a step
  State state_, state_end_, told_;      // scratch of one lane
  StateRate rate_, rate_error_;
  StateInputs inputs_;
  std::vector<State> starts_;  // in the coordinates of the batch
};

void LaneRun::begin(std::span<const State> starts) {
  int first_good = -1;
  for (std::size_t l = 0; l < kL; ++l) {
    starts_.push_back(starts[l < starts.size() ? l : 0]);
    lanes_[l].going = l < starts.size();
    try {
      if (l < starts.size()) {
        Dynamics dynamics = dynamics_of(static_cast<int>(l));
        check_copy(dynamics, starts[l]);
      }
      batch_.to_batch(static_cast<int>(l), starts_[l]);
      if (first_good < 0) first_good = static_cast<int>(l);
    } catch (const Error& error) {  // a law
      lanes_[l].going = false;
      if (l < starts.size())
        reports_[l].finished = false, reports_[l].error = error.what(), reports_[l].t = starts[l].t;
    }
  }
  if (first_good < 0) return;
  const auto good = static_cast<std::size_t>(first_good);
  state_ = state_end_ = starts_[good];
  rate_ = rate_error_ = sized_like(state_);
  for (std::size_t l = 0; l < kL; ++l) {
    const int lane = static_cast<int>(l);
    if (!lanes_[l].going && starts_[l].q.size() != state_.q.size()) starts_[l] = state_;
    batch_.put(lane, starts_[l], y_.data());
    batch_.remember(lane, starts_[l].z);
    t_[l] = starts_[l].t;
  }
  for (std::size_t l = 0; l < starts.size(); ++l) {
    Lane& the = lanes_[l];
    if (!the.going) continue;
    const int lane = static_cast<int>(l);
    const State start = starts_[l];  // arrive() may park the lane
    the.schedule.begin(batch_.system(lane), start.t, task_.times);
    the.norm.set(task_.options.tolerance);
    the.norm.set_states(batch_.system(lane).n_error_controlled_states());
    the.norm.scale(start, 1.0);
    the.control.begin();
    the.pace.start(start.t);
    reports_[l].t = start.t;
    while (the.going && the.schedule.reach() <= start.t) arrive(lane);
    if (the.going) the.advised = task_.options.step > 0 ? task_.options.step : first_step(lane, start);
  }
  batch_.start_from(y_.data(), t_);
}

// The state of a copy in an array, at time t.
void LaneRun::read(int lane, const double* y, double t, State& out) const {
  const auto l = static_cast<std::size_t>(lane);
  batch_.get(lane, y, out);
  out.t = t, out.z = batch_.memory(lane);
  out.coordinates = starts_[l].coordinates;
}

Dynamics LaneRun::dynamics_of(int lane) const {
  DynamicsOptions options;
  options.stabilization = task_.options.stabilization;
  options.formulation = task_.formulation;
  return Dynamics(batch_.system(lane), std::make_unique<SchurSolver>(), options);
}

double LaneRun::first_step(int lane, const State& start) const {
  Dynamics dynamics = dynamics_of(lane);
  ErrorNorm norm = lanes_[static_cast<std::size_t>(lane)].norm;
  StateRate f0 = sized_like(start), f1 = f0;
  State y0 = start, y1;
  double largest = lanes_[static_cast<std::size_t>(lane)].schedule.reach() - start.t;
  if (task_.options.max_step > 0) largest = std::min(largest, task_.options.max_step);
  try {
    batch_.to_slots(lane, y0);
    dynamics.to_formulation(y0);  // coordinates of its own
    y1 = y0;
    return guess_first_step(dynamics, y0, tableau_.order, largest, norm, f0, f1, y1);
  } catch (const Error&) {
    return largest;  // the run will hit and report the error
  }
}

// Ends a step at the schedule's next instant.
void LaneRun::arrive(int lane) {
  const auto l = static_cast<std::size_t>(lane);
  Lane& the = lanes_[l];
  const double before = t_[l];
  bool output = false;
  t_[l] = reports_[l].t = the.schedule.arrive(output);
  told_ = state_;
  try {
    if (output) {
      read(lane, y_.data(), t_[l], told_);
      batch_.to_slots(lane, told_);
    } else {
      cross_jump(lane, before);
    }
  } catch (const Error& error) {  // a law
    return fail(lane, error);
  }
  if (output)
    task_.tell(batch_.first() + lane, the.schedule.next() - 1, told_);
  else
    tell_step(lane, true);
  the.going = the.going && !the.schedule.done();
}

// To those who follow every step.
void LaneRun::tell_step(int lane, bool jumped) {
  if (!task_.step) return;
  told_ = state_;
  try {
    read(lane, y_.data(), t_[static_cast<std::size_t>(lane)], told_);
    batch_.to_slots(lane, told_);
  } catch (const Error& error) {  // a law
    return fail(lane, error);
  }
  task_.tell_step(batch_.first() + lane, told_, jumped);
}

// Takes a copy from t, on the near side of the jump of a law, to its instant.
void LaneRun::cross_jump(int lane, double t) {
  State state = state_;
  read(lane, y_.data(), t, state);
  batch_.to_slots(lane, state);
  Dynamics dynamics = dynamics_of(lane);
  pass_jump(dynamics, state, t_[static_cast<std::size_t>(lane)]);
  batch_.remember(lane, state.z);
  batch_.to_batch(lane, state);
  batch_.put(lane, state, y_.data());
  jumped_ = true;
}

// False: the run is broken off, all copies have failed.
bool LaneRun::goes_on() {
  double reached = HUGE_VAL;
  for (std::size_t l = 0; l < kL; ++l)
    if (lanes_[l].going) reached = std::min(reached, t_[l]);
  try {
    task_.go_on_from(reached);
  } catch (const StepError& error) {
    for (std::size_t l = 0; l < kL; ++l)
      if (lanes_[l].going) fail(static_cast<int>(l), error);
    return false;
  }
  return true;
}

void LaneRun::choose_steps() {
  for (std::size_t l = 0; l < kL; ++l) {
    Lane& the = lanes_[l];
    h_[l] = 0;  // lanes that have ended do not move
    if (!the.going) continue;
    double h = the.advised;
    if (task_.options.max_step > 0) h = std::min(h, task_.options.max_step);
    the.asked = h;
    h_[l] = the.schedule.step(t_[l], h, fixed_);
    the.lands = the.schedule.lands(t_[l], h_[l]);
  }
}

void LaneRun::combine_stages(const Weights& w, const double* y, double* out) {
  std::array<const double*, Weights::kMost> k{};
  for (std::size_t i = 0; i < w.n; ++i) k[i] = k_[w.stage[i]].data();
  batch_.passes().combine(batch_.n(), y, h_.data(), w.n, k.data(), w.w.data(), out);
}

// True in lanes where an evaluation failed.
Flags8 LaneRun::evaluate_stages() {
  Flags8 failed{};
  for (Lane& lane : lanes_) lane.stages = {};
  for (int i = first_done_ ? 1 : 0; i < tableau_.n_stages; ++i) {
    if (i > 0) combine_stages(a_[static_cast<std::size_t>(i)], y_.data(), stage_.data());
    Numbers8 t = t_;
    for (std::size_t l = 0; l < kL; ++l) t[l] += tableau_.c[i] * h_[l];
    const Flags8 unmet = batch_.evaluate(i > 0 ? stage_.data() : y_.data(), t, k_[static_cast<std::size_t>(i)].data());
    for (std::size_t l = 0; l < kL; ++l) failed[l] = failed[l] || unmet[l];
    if (batch_.watches()) see_pivots(i == 0);
    for (std::size_t l = 0; i == 0 && l < kL; ++l)
      first_a_[l] = batch_.largest_a(l), first_alpha_[l] = batch_.largest_alpha(l);
  }
  first_done_ = true;
  return failed;
}

void LaneRun::see_pivots(bool first) {
  for (std::size_t l = 0; l < kL; ++l) {
    Lane& the = lanes_[l];
    if (first) the.first = {};
    (first ? the.first : the.stages).add(batch_.n_small(l), batch_.smallest_pivot(l));
  }
}

// Whether a stage of the attempt is near a singular position: there more pivots are small than elsewhere.
bool LaneRun::near_singular(int lane) {
  Lane& the = lanes_[static_cast<std::size_t>(lane)];
  the.usual = std::min({the.usual, the.first.fewest, the.stages.fewest});
  return std::max(the.first.most, the.stages.most) > the.usual ||
         std::min(the.first.smallest, the.stages.smallest) < the.singular.limit_from(the.first.smallest);
}

double LaneRun::error_of(int lane) {
  batch_.get(lane, error_.data(), rate_error_);
  return lanes_[static_cast<std::size_t>(lane)].norm.of(rate_error_, state_end_);
}

// EmbeddedRungeKutta::estimate for eight copies. Lanes in which a law fails at the end of the step have failed.
void LaneRun::estimate(Numbers8& error, Flags8& failed) {
  error.fill(0);
  if (fixed_) return;
  Numbers8 e3{};
  batch_.weighs_errors() ? estimate_together(error, e3, failed) : estimate_each(error, e3, failed);
  for (std::size_t l = 0; scheme_.second && l < kL; ++l) error[l] = combined_error(error[l], e3[l]);
}

// On the bodies of all copies at once.
void LaneRun::estimate_together(Numbers8& error, Numbers8& e3, Flags8& failed) {
  Numbers8 t1 = t_;
  for (std::size_t l = 0; l < kL; ++l) t1[l] += h_[l];
  std::array<Change, kLanes> change, by;
  const Flags8 lost = batch_.change_to(end_.data(), t1, h_, change);
  std::array<BodyWeights, kLanes> weights;
  for (std::size_t l = 0; l < kL; ++l) {
    failed[l] = failed[l] || lost[l];
    const double a = h_[l] * first_a_[l], alpha = h_[l] * first_alpha_[l];
    change[l].take(0, 0, a * a, alpha * alpha);
    weights[l] = weights_of(task_.options.tolerance, change[l]);
  }
  const auto each = [&](const Weights& w, Numbers8& out) {
    combine_stages(w, nullptr, error_.data());
    batch_.weigh(error_.data(), by);
    for (std::size_t l = 0; l < kL; ++l) {
      const double sum = by[l].x + by[l].r + by[l].v + by[l].w;
      out[l] = std::isfinite(sum) ? in_tolerances(by[l], weights[l]) : HUGE_VAL;
    }
  };
  each(error_w_, error);
  if (scheme_.second) each(second_w_, e3);
}

// Copy by copy, by ErrorNorm.
void LaneRun::estimate_each(Numbers8& error, Numbers8& e3, Flags8& failed) {
  const auto each = [&](const Weights& w, bool scale, Numbers8& out) {
    combine_stages(w, nullptr, error_.data());
    for (int l = 0; l < batch_.size(); ++l) {
      const auto i = static_cast<std::size_t>(l);
      Lane& the = lanes_[i];
      if (!the.going || failed[i]) continue;
      try {
        read(l, end_.data(), t_[i] + h_[i], state_end_);
        if (scale) {
          read(l, y_.data(), t_[i], state_);
          batch_.get(l, k_[0].data(), rate_);
          rate_.largest_a = first_a_[i], rate_.largest_alpha = first_alpha_[i];
          the.norm.scale(state_, rate_, h_[i], state_end_);
        }
        out[i] = error_of(l);
      } catch (const Error&) {
        failed[i] = true;
      }
    }
  };
  each(error_w_, true, error);
  if (scheme_.second) each(second_w_, false, e3);
}

void LaneRun::attempt() {
  Flags8 failed = evaluate_stages();
  combine_stages(b_, y_.data(), end_.data());
  Numbers8 error{};
  estimate(error, failed);
  Flags8 wanted{};
  for (std::size_t l = 0; l < kL; ++l) wanted[l] = lanes_[l].going && !failed[l] && error[l] <= 1;
  Numbers8 t1 = t_;
  for (std::size_t l = 0; l < kL; ++l) t1[l] += h_[l];
  std::array<Landing, kLanes> landed;
  batch_.project(end_.data(), t1, wanted, landed);
  for (int l = 0; l < batch_.size(); ++l) {
    const auto i = static_cast<std::size_t>(l);
    if (!lanes_[i].going) continue;
    if (failed[i] || !landed[i].velocities_met || (batch_.watches() && near_singular(l))) {
      leave(l);
      continue;
    }
    if (!wanted[i]) {
      reject(l, lanes_[i].control.reject(error[i]));
      continue;
    }
    const bool on =
        task_.options.stabilization.kind != Stabilization::Kind::project ||
        (fixed_ ? landed[i].converged : end_is_near(landed[i].converged, landed[i].before, batch_.system(l).length()));
    on && !miscounts(l) ? accept(l, error[i]) : reject(l, 0.5);
  }
  if (jumped_) batch_.start_from(y_.data(), t_);
  jumped_ = false;
}

// Whether links count turns that the step of a copy outruns.
bool LaneRun::miscounts(int lane) {
  if (!batch_.counts_turns()) return false;
  const double t = t_[static_cast<std::size_t>(lane)];
  read(lane, y_.data(), t, state_);
  read(lane, end_.data(), t + h_[static_cast<std::size_t>(lane)], state_end_);
  return batch_.miscounts(lane, state_, state_end_);
}

void LaneRun::accept(int lane, double error) {
  const auto l = static_cast<std::size_t>(lane);
  Lane& the = lanes_[l];
  if (batch_.watches())
    the.singular.add(std::min(the.first.smallest, the.stages.smallest), h_[l] * batch_.fastest_turn(lane, y_.data()));
  for (std::size_t i = l; i < y_.size(); i += kL) y_[i] = end_[i];
  batch_.take_off_turns(lane, y_.data());
  batch_.accept(lane);
  first_done_ = false;
  t_[l] = the.lands ? the.schedule.reach() : t_[l] + h_[l];
  reports_[l].t = t_[l];
  ++reports_[l].steps;
  if (!fixed_) {
    const double next = h_[l] * the.control.accept(h_[l], error, 0, the.rejected);
    the.advised = the.rejected ? next : advised_after(the.asked, h_[l], h_[l], next);
  }
  the.rejected = false;
  try {
    update_memory(lane);
    if (!the.schedule.done() && t_[l] < the.schedule.end())
      watch_pace(the.pace, task_, batch_.first() + lane, the.schedule.end(), the.advised, t_[l], reports_[l].steps);
  } catch (const Error& failure) {
    return fail(lane, failure);
  }
  tell_step(lane, false);
  if (the.going && the.lands) arrive(lane);
}

void LaneRun::update_memory(int lane) {
  const System& system = batch_.system(lane);
  if (system.n_memory() == 0) return;
  read(lane, y_.data(), t_[static_cast<std::size_t>(lane)], state_);
  system.accept(inputs_.at(system, state_), state_);
  batch_.remember(lane, state_.z);
}

// Repeats with a smaller step; a copy that cannot go on leaves for the scalar code, which reports the error.
void LaneRun::reject(int lane, double factor) {
  const auto l = static_cast<std::size_t>(lane);
  ++reports_[l].rejected;
  lanes_[l].rejected = true;
  lanes_[l].advised = factor * h_[l];
  if (fixed_ || step_vanished(t_[l], lanes_[l].advised, lanes_[l].asked)) leave(lane);
}

// The run of a copy goes on outside of the lanes.
void LaneRun::leave(int lane) {
  const auto l = static_cast<std::size_t>(lane);
  State state = state_;
  read(lane, y_.data(), t_[l], state);
  const double h = fixed_ ? task_.options.step : h_[l];
  reports_[l].alone = true;
  park(lane);
  try {
    batch_.to_slots(lane, state);
  } catch (const Error& error) {
    return fail(lane, error);
  }
  run_alone(batch_.system(lane), batch_.first() + lane, std::move(state), lanes_[l].schedule, h, task_, reports_[l],
            lanes_[l].pace);
}

void LaneRun::fail(int lane, const Error& error) {
  park(lane);
  reports_[static_cast<std::size_t>(lane)].finished = false;
  reports_[static_cast<std::size_t>(lane)].error = error.what();
}

// Ends stepping in a lane, which stays at a state at which it can be evaluated.
void LaneRun::park(int lane) {
  const auto l = static_cast<std::size_t>(lane);
  lanes_[l].going = false;
  batch_.put(lane, starts_[l], y_.data());
  batch_.remember(lane, starts_[l].z);
  t_[l] = starts_[l].t;
  first_done_ = false;
}

}  // namespace

void run_lanes(Batch& batch, std::span<const State> starts, const RunTask& task, std::span<CopyReport> reports) {
  LaneRun(batch, task, reports).run(starts);
}

}  // namespace lockstep::lanes
