// SPDX-License-Identifier: BSD-3-Clause
// check_integrator: right methods pass, wrong ones are named in words.
#include <lockstep/author/check.h>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include "framework/tools/check/closed_motion.h"
#include "tests/support/catch.h"
#include "tests/support/check_words.h"

namespace check_integrator_test {

using namespace lockstep;
using lockstep::test::says;

namespace {

enum class Fault {
  none,
  order,
  weights,
  too_long,
  time,
  memory,
  no_projection,
  no_normalisation,
  early,
  swallowed,
  keeps,
  no_save,
  dense
};

/// Two-step Adams-Bashforth, begun by one step of Heun, both of order 2: y1 = y + h (1.5 f - 0.5 f_before).
class Two final : public Integrator {
 public:
  explicit Two(Fault fault) : fault_(fault) {}
  IntegratorInfo info() const override { return {"two", fault_ == Fault::order ? 3 : 2, false, false, 1}; }
  void begin(Dynamics&, const State& state) override {
    start_ = end_ = state;
    f_ = {state.q, state.v, state.s};
    if (fault_ != Fault::keeps) before_ = f_, has_before_ = false;
    has_step_ = false;
  }
  StepReport step(Dynamics& dynamics, State& state, double h) override {
    if (fault_ == Fault::too_long) h *= 2;
    State& on = fault_ == Fault::early ? state : end_;
    start_ = state, end_ = state;
    try {
      if (fault_ == Fault::early) on.t += h;  // before anything is evaluated
      dynamics.rate(start_, f_);
      if (has_before_) {
        const double w = fault_ == Fault::weights ? 0.4 : 0.5;
        move(on, h, 1 + w, f_, -w, before_);
      } else {
        State stage = start_;
        move(stage, h, 1, f_, 0, f_);
        stage.t = start_.t + h;
        StateRate second = f_;
        dynamics.rate(stage, second);
        move(on, h, 0.5, f_, 0.5, second);
      }
    } catch (const Error&) {
      if (fault_ != Fault::swallowed) throw;
    }
    on.t = start_.t + h;
    if (fault_ == Fault::no_projection || fault_ == Fault::swallowed)
      dynamics.normalize(on);
    else if (fault_ != Fault::no_normalisation)
      dynamics.project(on);
    if (fault_ == Fault::memory && on.z.size() > 0) on.z[0] += 1;
    before_ = f_, has_before_ = true, has_step_ = true;
    end_ = on, state = end_;
    if (fault_ == Fault::time) state.t += 1e-6;
    StepReport report;
    report.h = h;
    return report;
  }
  bool dense(double t, State& out) const override {
    if (fault_ != Fault::dense) return false;
    out = start_, out.t = t;  // a straight line
    if (has_step_) out.q += (t - start_.t) / (end_.t - start_.t) * (end_.q - start_.q);
    return true;
  }
  void save(Snapshot& s) const override {
    if (fault_ == Fault::no_save) return;
    s.put(has_before_ ? 1 : 0), s.put_all(before_.q), s.put_all(before_.v), s.put_all(before_.s);
  }
  void restore(SnapshotReader& s) override {
    if (fault_ == Fault::no_save) return;
    has_before_ = s.get() > 0, s.get_all(before_.q), s.get_all(before_.v), s.get_all(before_.s);
  }

 private:
  static void move(State& y, double h, double a, const StateRate& f, double b, const StateRate& g) {
    y.q += h * (a * f.q + b * g.q), y.v += h * (a * f.v + b * g.v), y.s += h * (a * f.s + b * g.s);
  }
  Fault fault_;
  State start_, end_;
  StateRate f_, before_;
  bool has_before_ = false, has_step_ = false;
};

CheckReport two(Fault fault) {
  return check_integrator([fault] { return std::make_unique<Two>(fault); });
}
}  // namespace

TEST_CASE("the motions with a closed form begin where their systems do", "[unit][check]") {
  for (const ClosedMotion& m : {free_top(), hinged_pendulum()}) CHECK(m.error(m.system->start()) < 1e-14);
}

TEST_CASE("check_integrator passes a right method and reports its measured order", "[unit][check]") {
  const CheckReport r = two(Fault::none);
  INFO(r.text());
  CHECK(r.ok());
  CHECK(says(r, "integrator 'two': no findings"));
  CHECK(says(r, "order 2.0"));
}

TEST_CASE("check_integrator names what is wrong in a method", "[unit][check]") {
  CheckReport r = two(Fault::order);
  CAPTURE(r.text());
  CHECK(says(r, "is of order 2.0"));
  CHECK(says(r, "but info() declares 3"));
  r = two(Fault::weights);
  CAPTURE(r.text());
  CHECK(says(r, "is of order 1.0"));
  CHECK(says(r, "look at the coefficients"));
  r = two(Fault::too_long);
  CAPTURE(r.text());
  CHECK(says(r, "makes a step of 0.02 s (requested: 0.01 s at t = 0 s"));
  r = two(Fault::time);
  CAPTURE(r.text());
  CHECK(says(r, "the time advances by"));
  r = two(Fault::memory);
  CAPTURE(r.text());
  CHECK(says(r, "changes the memory of the state"));
  r = two(Fault::no_projection);
  CAPTURE(r.text());
  CHECK(says(r, "the new state violates the constraints by"));
  r = two(Fault::no_normalisation);
  CAPTURE(r.text());
  CHECK(says(r, "a quaternion has length"));
  r = two(Fault::early);
  CAPTURE(r.text());
  CHECK(says(r, "a step that throws changes the state"));
  r = two(Fault::swallowed);
  CAPTURE(r.text());
  CHECK(says(r, "makes a step although the equations of motion give NaN"));
  r = two(Fault::keeps);
  CAPTURE(r.text());
  CHECK(says(r, "a run after a second begin() differs"));
  r = two(Fault::no_save);
  CAPTURE(r.text());
  CHECK(says(r, "after restore(), the same steps end"));
  CHECK(says(r, "another object, begun and restored, ends"));
  r = two(Fault::dense);
  CAPTURE(r.text());
  CHECK(says(r, "the error of dense() decreases only with the power 2.0"));
}

TEST_CASE("every integrator of the library passes its check", "[unit][check]") {
  const Registry registry = builtin_registry();
  for (const std::string& name : registry.integrators.names()) {
    const CheckReport report = check_integrator(registry, name);
    INFO(report.text());
    CHECK(report.ok());
    CHECK(says(report, "order "));
  }
  for (const char* name : {"dopri5", "dop853"}) {
    const CheckReport report = check_integrator(registry, name, {{"fixed", true}});
    INFO(report.text());
    CHECK(report.ok());
  }
}

}  // namespace check_integrator_test
