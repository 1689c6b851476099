// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/simulate/step_interval.h"

#include <spdlog/fmt/fmt.h>

#include <utility>

#include <lockstep/error.h>
#include "framework/dynamics/integrate/culprit.h"
#include "framework/dynamics/simulate/keep_state.h"

namespace lockstep {

namespace {

// Whether a message names the joint, force or body that it is about.
bool names_thing(std::string_view message) { return message.find(" '") != std::string_view::npos; }

}  // namespace

void StepInterval::start(const State& state) {
  keep_state(state, from_);
  report_ = {};
  remembers_ = false;
}

void StepInterval::begin(const State& state) {
  named(method_, state.t, [&] { method_.begin(dynamics_, state); });
  keep_state(state, from_), keep_state(state, inside_);
  has_dense_ = named(method_, state.t, [&] { return method_.dense(state.t, inside_); });
}

void StepInterval::make(State& state, double h, bool has_guards) {
  keep_state(state, from_);
  is_back_ = false;
  if (!has_dense_ && has_guards) before_.clear(), method_.save(before_);
  try {
    report_ = named(method_, from_.t, [&] { return method_.step(dynamics_, state, h); });
    check_step(dynamics_.system(), method_, from_, state, h, report_);
  } catch (const StepError& error) {
    state = from_;
    if (info_.adaptive || method_.origin() != "built in" || names_thing(error.what())) throw;
    const std::string who = who_varies(dynamics_, from_, h);  // adaptive methods have reported it
    if (who.empty()) throw;
    throw StepError(std::string(error.what()) + "; " + who, static_cast<const ErrorData&>(error));
  } catch (...) {
    state = from_;
    throw;
  }
}

const State& StepInterval::at(double t) {
  if (has_dense_) {
    named(method_, t, [&] { return method_.dense(t, inside_); });
    if (dynamics_.options().stabilization.kind != Stabilization::Kind::project) return inside_;
    const ProjectReport report = dynamics_.project(inside_);
    if (!report.converged)
      throw StepError(fmt::format("the interpolated state at t = {:.9g} s violates the constraints by {:.3g} m and "
                                  "cannot be projected; use a smaller tolerance",
                                  t, report.before),
                      from_.t);
    return inside_;
  }
  inside_ = from_;
  if (t <= from_.t) return inside_;
  if (!is_back_) after_.clear(), method_.save(after_);
  is_back_ = true;
  SnapshotReader before(before_);
  method_.restore(before);
  for (double left = t - from_.t; left > 0; left = t - inside_.t) {
    before_part_ = inside_;
    const StepReport part = named(method_, inside_.t, [&] { return method_.step(dynamics_, inside_, left); });
    check_step(dynamics_.system(), method_, before_part_, inside_, left, part);
    if (part.h >= left) break;
  }
  inside_.t = t;
  return inside_;
}

void StepInterval::put_back_method() {
  if (SnapshotReader after(after_); std::exchange(is_back_, false)) method_.restore(after);
}

void StepInterval::cut(double t, State& state) {
  state = at(t);
  report_.h = t - from_.t;
}

// False if it cannot be computed: the next step reports why.
bool StepInterval::read_acting(const State& state, VecX& out) try {
  const bool held_rows = dynamics_.holds_rows();
  slots_ = state;
  dynamics_.to_slots(slots_);
  const Evaluation& e = dynamics_.gather(slots_);
  e.residuals(C_, Cd_);
  const Eigen::Index n = e.force().size(), m = C_.size();
  out.resize(n + 3 * m);
  out.head(n) = e.force(), out.segment(n, m) = C_, out.segment(n + m, m) = Cd_;
  for (const RowEntry& entry : e.rows().entries)
    for (int k = 0; k < entry.m; ++k) out[n + 2 * m + entry.first_row + k] = e.rows().block(entry).Qhat(k);
  if (!held_rows) dynamics_.forget_rows(state);
  return true;
} catch (...) {
  return false;
}

void StepInterval::note_acting(const State& state) { remembers_ = keeps_accelerations() && read_acting(state, acted_); }

bool StepInterval::acts_otherwise(const State& state) {
  return remembers_ && !(read_acting(state, acts_) && acts_.size() == acted_.size() && acts_ == acted_);
}

void StepInterval::save(Snapshot& out) const {
  for (const double x :
       {report_.h, report_.h_next, report_.error, static_cast<double>(report_.rejected), report_.violation,
        report_.violation_after, report_.manifold ? 1.0 : 0.0, report_.stiff ? 1.0 : 0.0})
    out.put(x);
  Snapshot method;
  method_.save(method);
  out.put_part(method);
}

void StepInterval::load(const State& state, SnapshotReader& in) {
  report_.h = in.get(), report_.h_next = in.get(), report_.error = in.get();
  report_.rejected = static_cast<int>(in.get_count());
  report_.violation = in.get(), report_.violation_after = in.get();
  report_.manifold = in.get_flag(), report_.stiff = in.get_flag();
  SnapshotReader method = in.get_part();
  begin(state);
  named(method_, state.t, [&] { method_.restore(method); });
  if (!method.at_end())
    throw ModelError(fmt::format("{}: restore() reads less than save() wrote; let it read everything in the same order",
                                 method_.info().name));
}

}  // namespace lockstep
