// The motion law template_law: y goes to a new value and settles there, as a critically damped spring does.
//
// Change the formulas in at(), breakpoints(), the keys in info() and the checks in make(). Then change the parameters in
// test_template_law.cpp and scene.json, and build and run the test.
#include <cmath>

#include <lockstep/author/plugin.h>

namespace {

using namespace lockstep;

///   y = rise (1 - (1 + u) exp(-u)),   u = (t - start)/time,   for u > 0;   y = 0 before
class TemplateLaw final : public MotionLaw {
 public:
  TemplateLaw(double rise, double time, double start) : rise_(rise), time_(time), start_(start) {}

  /// y and its first and second derivative at t.
  LawValue at(double t) const override {
    if (t < start_) return {};  // t itself: a quotient such as u has round-off
    const double u = (t - start_) / time_, e = std::exp(-u);
    return {rise_ * (1 - (1 + u) * e), rise_ * u * e / time_, rise_ * (1 - u) * e / (time_ * time_)};
  }

  /// The times at which a motion or a pulse begins and ends, and at which y, yd or ydd jumps (here ydd at the start).
  /// Integrators step onto them; without them an adaptive method may step over a whole pulse. There at() must return
  /// the values that hold afterwards: t < start_ above, not t <= start_.
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    if (t0 < start_ && start_ < t1) out.push_back(start_);
  }

  /// Name, one line of help, and the keys of a scene with unit and default.
  static TypeInfo info() {
    return {"template_law",
            "goes to a new value and settles there: rise (1 - (1 + u) exp(-u)), u = (t - start)/time > 0",
            {{"rise", Form::number, Unit::any, kRequired, "final value", {}, LawQuantity::value},
             {"time", Form::number, Unit::time, kRequired, "from start to the largest speed, above zero"},
             {"start", Form::number, Unit::time, 0, "time at which it begins"}}};
  }

  static LawPtr<MotionLaw> make(const Params& p) {
    if (!(p.number("time") > 0)) p.refuse("time", "is " + text::brief(p.number("time")) + " s; must be above zero");
    return std::make_shared<TemplateLaw>(p.number("rise"), p.number("time"), p.number("start"));
  }

 private:
  double rise_, time_, start_;
};

}  // namespace

LOCKSTEP_PLUGIN(registry) { registry.laws.add<TemplateLaw>(); }
