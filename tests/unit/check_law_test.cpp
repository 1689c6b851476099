// SPDX-License-Identifier: BSD-3-Clause
// check_law: right laws pass, wrong ones are named in words.
#include <lockstep/author/check.h>

#include <cmath>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/laws.h>
#include "framework/tools/check/slope.h"
#include "tests/support/catch.h"
#include "tests/support/check_words.h"
#include "tests/support/messages.h"
#include "tests/support/samples_of_types.h"

namespace check_law_test {

using namespace lockstep;
using lockstep::test::says;

namespace {

enum class Fault { none, rate_sign, half_acceleration, jump, nan, keeps, outside, throws, no_times };

/// y = sin(2 t), with a jump of the acceleration at 0.7 s when asked for.
class Wrong final : public MotionLaw {
 public:
  explicit Wrong(Fault fault) : fault_(fault) {}
  LawValue at(double t) const override {
    LawValue r{std::sin(2 * t), 2 * std::cos(2 * t), -4 * std::sin(2 * t)};
    if (fault_ == Fault::rate_sign) r.yd = -r.yd;
    if (fault_ == Fault::half_acceleration) r.ydd *= 0.5;
    if (fault_ == Fault::jump && t > 0.7) {
      const double x = t - 0.7;
      r.y += x * x, r.yd += 2 * x, r.ydd += 2;
    }
    if (fault_ == Fault::nan) r.yd += std::sqrt(1.5 - t);
    if (fault_ == Fault::throws && t > 1) throw std::runtime_error("the table is empty");
    if (fault_ == Fault::keeps) r.y += 1e-3 * ++n_calls_;
    return r;
  }
  void breakpoints(double, double, std::vector<double>& out) const override {
    if (fault_ == Fault::outside) out.push_back(99);
    if (fault_ == Fault::no_times) throw 42;
  }

 private:
  Fault fault_;
  mutable int n_calls_ = 0;
};

}  // namespace

TEST_CASE("check_law names what is wrong in a scalar law", "[unit][check]") {
  const auto report = [](Fault fault) { return check_law(Wrong(fault), {.seed = 3}, "wave"); };
  CHECK(report(Fault::none).ok());
  CHECK(report(Fault::none).notes().empty());
  CHECK(says(check_law(*laws::constant(1)),
             "law from t = 0 to 2 s: no findings in 128 comparisons (seed 1)\n  note: it is constant"));
  CHECK(says(report(Fault::none), "law 'wave' from t = 0 to 2 s: no findings in 128 comparisons (seed 3"));

  CheckReport r = report(Fault::rate_sign);
  CAPTURE(r.text());
  CHECK_FALSE(r.ok());
  CHECK(says(r, "law 'wave' from t = 0 to 2 s: 1 finding (seed 3)\n  yd at t = "));  // not ydd, which is right
  CHECK(says(r, "finite differences of y give"));
  CHECK(says(r, "so it has the wrong sign"));
  CHECK(says(r, "look at the formula of yd"));
  CHECK(says(report(Fault::half_acceleration), "so it is half the value: a factor of 2 is missing"));
  CHECK(says(report(Fault::nan), "yd is "));
  CHECK(says(report(Fault::nan), "nan from about t = 1.5 s"));
  CHECK(says(report(Fault::keeps), "returns another value at t = 0 s in a second call"));
  CHECK(says(report(Fault::outside), "breakpoints(0, 2) reports 99 s"));
  CHECK(says(report(Fault::throws), " 1 finding (seed 3)\n  t = 1.01 s: law 'wave' threw: the table is empty\n"));
  CHECK(says(report(Fault::no_times), "law 'wave' threw: an object of type int"));
}

TEST_CASE("check_law finds the time of an undeclared jump", "[unit][check]") {
  const CheckReport r = check_law(Wrong(Fault::jump), {.seed = 3});
  CAPTURE(r.text());
  REQUIRE(r.findings().size() == 1);
  CHECK(says(r, "ydd jumps by 2 at t = 0.7 s, which breakpoints() does not report"));
}

namespace {

/// A rise by 1 from 0.5 s on, over at 0.7 s: at that time by round-off the earlier part. `drop`: y jumps at 1 s.
class Rise final : public MotionLaw {
 public:
  Rise(bool lists, double drop) : lists_(lists), drop_(drop) {}
  LawValue at(double t) const override {
    if (t >= 1) return {1 - drop_, 0, 0};
    const double u = (t - 0.5) / 0.2, v = 1 - u;
    if (u <= 0) return {};
    if (u >= 1) return {1, 0, 0};
    return {u * u * u * (10 - 15 * u + 6 * u * u), 150 * u * u * v * v, 1500 * u * v * (1 - 2 * u)};
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    for (const double t : {0.5, 0.7, 1.0})
      if (lists_ && t0 < t && t < t1) out.push_back(t);
  }

 private:
  bool lists_;
  double drop_;
};

/// Laws that rest before they change, without breakpoints.
class Unlisted final : public MotionLaw {
 public:
  enum Kind { pulse, slow, step, nan };  // sin^3 for 20 ms; exp(-1/x); a jump; not finite
  explicit Unlisted(Kind kind) : kind_(kind) {}
  LawValue at(double t) const override {
    if (kind_ == step) return {t > 0.7 ? 1.0 : 0.0, 0, 0};
    if (kind_ == nan) return {0, 0, t > 0.3 ? std::nan("") : 0};
    const double x = t - (kind_ == slow ? 0.5 : 0.53), w = kPi / 0.02;
    if (x <= 0 || (kind_ == pulse && x >= 0.02)) return {};
    const double e = std::exp(-1 / x), s = std::sin(w * x), c = std::cos(w * x);
    if (kind_ == slow) return {e, e / (x * x), e * (1 - 2 * x) / (x * x * x * x)};
    return {s * s * s, 3 * w * s * s * c, 3 * w * w * (2 * s * c * c - s * s * s)};
  }

 private:
  Kind kind_;
};

/// y jumps at 1 s, where it is listed, but at(1) is the value before.
class Late final : public MotionLaw {
 public:
  LawValue at(double t) const override { return t > 1 ? LawValue{1.2, 0, 0} : LawValue{t, 1, 0}; }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    if (t0 < 1 && 1 < t1) out.push_back(1);
  }
};

}  // namespace

TEST_CASE("check_law finds a motion that begins or ends without a breakpoint", "[unit][check]") {
  const CheckReport listed = check_law(Rise(true, 0)), unlisted = check_law(Rise(false, 0));
  CAPTURE(listed.text(), unlisted.text());
  CHECK(listed.ok());
  CHECK(listed.notes().empty());
  CHECK(unlisted.findings().size() == 2);
  CHECK(says(unlisted,
             "  y begins to change at t = 0.5 s, which breakpoints() does not list, so an adaptive method may "
             "step over it; look at breakpoints(): append this time"));
  CHECK(says(unlisted, "  y ceases to change at t = 0.7 s, which breakpoints() does not list"));

  const CheckReport pulse = check_law(Unlisted(Unlisted::pulse)), slow = check_law(Unlisted(Unlisted::slow)),
                    step = check_law(Unlisted(Unlisted::step)), nan = check_law(Unlisted(Unlisted::nan));
  CAPTURE(pulse.text(), slow.text(), step.text(), nan.text());
  CHECK(pulse.findings().size() == 2);
  CHECK(says(pulse, "  y begins to change at t = 0.53 s, which breakpoints() does not list"));
  CHECK(says(pulse, "  y ceases to change at t = 0.55 s, which breakpoints() does not list"));
  CHECK(slow.ok());
  CHECK(says(slow, "note: y begins to change at about t = 0.501 s, which breakpoints() does not list"));
  CHECK(step.findings().size() == 1);
  CHECK(says(step, "y jumps by 1 at t = 0.7 s"));
  CHECK(nan.findings().size() == 1);
  CHECK(says(nan, "ydd is nan from about t = 0.3 s"));
  CHECK(nan.notes().empty());
}

TEST_CASE("check_law reports a listed jump of the value, and one that at(t) makes too late", "[unit][check]") {
  const CheckReport jump = check_law(Rise(true, 0.2)), late = check_law(Late());
  CAPTURE(jump.text(), late.text());
  CHECK(jump.ok());  // a force may jump
  CHECK(says(jump, "note: y jumps by -0.2 at its breakpoint t = 1 s: it cannot drive a joint"));
  CHECK_FALSE(late.ok());
  CHECK(says(late, "  y jumps by 0.2 at its breakpoint t = 1 s, but at(t) returns the new value only after t"));
}

namespace {

/// Turns about z by t^2, faults by choice.
class WrongTurn final : public RotationLaw {
 public:
  explicit WrongTurn(int fault) : fault_(fault) {}
  RotationValue at(double t) const override {
    RotationValue r{axis_angle(Vec3(1, 2, 2), t * t), 2 * t * Vec3(1, 2, 2) / 3, 2 * Vec3(1, 2, 2) / 3};
    if (fault_ == 1) r.q.w *= 1.001;
    if (fault_ == 2) r.w *= 0.5;
    if (fault_ == 3) r.a[1] = 0;
    return r;
  }

 private:
  int fault_;
};

class WrongSlide final : public TranslationLaw {
 public:
  TranslationValue at(double t) const override {
    return {Vec3(t, t * t, 0), Vec3(1, 2 * t, 0), Vec3(0, 2, t > 0.4 ? 1.0 : 0.0)};
  }
};

}  // namespace

TEST_CASE("check_law names what is wrong in laws of rotation and translation", "[unit][check]") {
  CHECK(check_law(WrongTurn(0)).ok());
  CHECK(says(check_law(WrongTurn(1)), "has length"));
  CHECK(says(check_law(WrongTurn(2)), "finite differences of q give"));
  CHECK(says(check_law(WrongTurn(2)), "a factor of 2 is missing"));
  CHECK(says(check_law(WrongTurn(3)), "a[1] at t = "));
  CHECK(says(check_law(WrongTurn(3)), "so it is missing"));
  const CheckReport slide = check_law(WrongSlide(), {}, "slide");
  CHECK(says(slide, "translation law 'slide' from t = 0 to 2 s: "));
  CHECK(says(slide, "a[2] jumps by 1 at t = 0.4 s"));
}

TEST_CASE("differences know how good they are", "[unit][check]") {
  const auto e = [](double x) { return VecX::Constant(1, std::exp(3 * x) * 1e3); };
  const Slope first = first_derivative(e, 0.1), second = second_derivative(e, 0.1);
  CHECK(std::abs(first.value[0] - 3e3) <= first.error[0]);
  CHECK(first.error[0] < 1e-6);
  CHECK(std::abs(second.value[0] - 9e3) <= second.error[0]);
  CHECK(second.error[0] < 1e-2);
  // noise of 1e-6 in the function is seen in the estimate
  const auto rough = [](double x) { return VecX::Constant(1, std::sin(x) + 1e-6 * std::sin(1e7 * x + 3)); };
  const Slope noisy = first_derivative(rough, 0.1);
  CHECK(noisy.error[0] > 1e-6);
  CHECK(std::abs(noisy.value[0] - 1) <= noisy.error[0]);
}

TEST_CASE("every law of the library passes its check", "[unit][check]") {
  const Registry registry = builtin_registry();
  const auto all = [&](const auto& shelf, const std::string& kind) {
    for (const std::string& name : shelf.names()) {
      const auto law = shelf.make(name, sample_params(kind, name), &registry, "law");
      const CheckReport report = check_law(*law, {.seed = 5, .from = -0.5, .to = 3}, name);
      INFO(report.text());
      CHECK(report.ok());
      CHECK(report.comparisons() > 50);
    }
  };
  all(registry.laws, "law"), all(registry.translation_laws, "translation law");
  all(registry.rotation_laws, "rotation law");
}

}  // namespace check_law_test
