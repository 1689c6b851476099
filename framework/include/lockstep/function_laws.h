// SPDX-License-Identifier: BSD-3-Clause
// Laws from a function of time.
#pragma once

#include <utility>
#include <vector>

#include <lockstep/author/jet.h>
#include <lockstep/author/law.h>
#include <lockstep/math.h>

namespace lockstep {

// From a quaternion on jets of time to a RotationValue.

/// The rotation q = r/|r| of r(t), of any length but zero, with its derivatives: by (1.8) and (1.9) w and a are the
/// vector parts of 2 q' qd and 2 q' qdd.
LOCKSTEP_API RotationValue rotation_value(const QuatT<Time>& r);

// Laws from a user's function of time, with exact derivatives: the function is evaluated on Jet<0>, which has value,
// first and second derivative. Write it for any number type: `[](auto t) { return 0.1 * sin(3.0 * t); }`.

/// Common part of the three laws from a function: the function, and the times at which it jumps.
template <class Law, class F>
class FromFunction : public Law {
 public:
  /// The function f of Time, and the times, s, at which it jumps.
  FromFunction(F f, std::vector<double> breaks) : f_(std::move(f)), breaks_(std::move(breaks)) {}
  /// Appends the instants given to the constructor that lie in (t0, t1), s.
  void breakpoints(double t0, double t1, std::vector<double>& out) const final {
    for (const double t : breaks_)
      if (t0 < t && t < t1) out.push_back(t);
  }

 protected:
  auto on_jet(double t) const { return f_(Time(t, 1.0, 0.0)); }  ///< f at time t, s, with its derivatives

 private:
  F f_;
  std::vector<double> breaks_;
};

/// A scalar law from a function of time; made by law().
template <class F>
class LawFrom final : public FromFunction<MotionLaw, F> {
 public:
  using FromFunction<MotionLaw, F>::FromFunction;
  LawValue at(double t) const override {
    const Time y = this->on_jet(t);
    return {y.v, y.d, y.h};
  }
};

/// A law of a translation from a function of time; made by laws::translation().
template <class F>
class TranslationFrom final : public FromFunction<TranslationLaw, F> {
 public:
  using FromFunction<TranslationLaw, F>::FromFunction;
  TranslationValue at(double t) const override {
    const auto r = this->on_jet(t);
    const Time &x = r[0], &y = r[1], &z = r[2];
    return {Vec3(x.v, y.v, z.v), Vec3(x.d, y.d, z.d), Vec3(x.h, y.h, z.h)};
  }
};

/// A law of a rotation from a function of time; made by laws::rotation().
template <class F>
class RotationFrom final : public FromFunction<RotationLaw, F> {
 public:
  using FromFunction<RotationLaw, F>::FromFunction;
  RotationValue at(double t) const override { return rotation_value(this->on_jet(t)); }
};

namespace laws {
/// The scalar law y = f(t). `breaks`: the times, s, at which y, yd or ydd jumps, if any (f chooses its branch by
/// comparing t).
template <class F>
LawPtr<MotionLaw> law(F f, std::vector<double> breaks = {}) {
  return std::make_shared<const LawFrom<F>>(std::move(f), std::move(breaks));
}

/// The law of a translation x = f(t), m; f returns anything with three elements:
/// `[](auto t) { return std::array{0.1 * t, sin(t), 0.2 * cos(t)}; }`. `breaks` as for law().
template <class F>
LawPtr<TranslationLaw> translation(F f, std::vector<double> breaks = {}) {
  return std::make_shared<const TranslationFrom<F>>(std::move(f), std::move(breaks));
}

/// The law of a rotation q = f(t)/|f(t)|; f returns a QuatT of any length but zero:
/// `[](auto t) { return QuatT<decltype(t)>{cos(t), 0.0 * t, 0.0 * t, sin(t)}; }`. `breaks` as for law().
template <class F>
LawPtr<RotationLaw> rotation(F f, std::vector<double> breaks = {}) {
  return std::make_shared<const RotationFrom<F>>(std::move(f), std::move(breaks));
}
}  // namespace laws

}  // namespace lockstep
