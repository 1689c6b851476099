// Laws from a user's function of time, with exact derivatives: the function is evaluated on Jet<0>, a number that
// carries value, first and second derivative. Write it for any number: `[](auto t) { return 0.1 * sin(3.0 * t); }`.
#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "framework/foundation/math/jet.h"
#include "framework/mechanism/model/motion_law.h"
#include "motionlaws/rotation_value.h"

namespace lockstep {

/// What is common to the three: the function and the instants at which it was said to jump.
template <class Law, class F>
class FromFunction : public Law {
 public:
  FromFunction(F f, std::vector<double> breaks) : f_(std::move(f)), breaks_(std::move(breaks)) {}
  void breakpoints(double t0, double t1, std::vector<double>& out) const final {
    for (const double t : breaks_)
      if (t0 < t && t < t1) out.push_back(t);
  }

 protected:
  auto on_jet(double t) const { return f_(Time(t, 1.0, 0.0)); }

 private:
  F f_;
  std::vector<double> breaks_;
};

template <class F>
class LawFrom final : public FromFunction<MotionLaw, F> {
 public:
  using FromFunction<MotionLaw, F>::FromFunction;
  LawValue at(double t) const override {
    const Time y = this->on_jet(t);
    return {y.v, y.d, y.h};
  }
};

template <class F>
class TranslationFrom final : public FromFunction<TranslationLaw, F> {
 public:
  using FromFunction<TranslationLaw, F>::FromFunction;
  TranslationValue at(double t) const override {
    const auto r = this->on_jet(t);
    const Time x = r[0], y = r[1], z = r[2];
    return {Vec3(x.v, y.v, z.v), Vec3(x.d, y.d, z.d), Vec3(x.h, y.h, z.h)};
  }
};

template <class F>
class RotationFrom final : public FromFunction<RotationLaw, F> {
 public:
  using FromFunction<RotationLaw, F>::FromFunction;
  RotationValue at(double t) const override { return rotation_value(this->on_jet(t)); }
};

namespace laws {
/// y = f(t). `breaks`: the instants at which y, yd or ydd jumps, if any (f chooses its branch by comparing t).
template <class F>
LawPtr<MotionLaw> law(F f, std::vector<double> breaks = {}) {
  return std::make_shared<const LawFrom<F>>(std::move(f), std::move(breaks));
}

/// x = f(t), m: anything with three elements, `[](auto t) { return std::array{0.1 * t, sin(t), 0.2 * cos(t)}; }`.
template <class F>
LawPtr<TranslationLaw> translation(F f, std::vector<double> breaks = {}) {
  return std::make_shared<const TranslationFrom<F>>(std::move(f), std::move(breaks));
}
}  // namespace laws

/// q = f(t)/|f(t)|: f gives a QuatT of any length but zero, `[](auto t) { return QuatT{cos(t), 0.0 * t, 0.0 * t,
/// sin(t)}; }`.
template <class F>
LawPtr<RotationLaw> rotation_law(F f, std::vector<double> breaks = {}) {
  return std::make_shared<const RotationFrom<F>>(std::move(f), std::move(breaks));
}

}  // namespace lockstep
