// Scalar laws of motion.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/error.h>
#include <lockstep/jet.h>
#include <lockstep/law.h>
#include <lockstep/params.h>
#include <lockstep/text.h>

namespace lockstep {

// Checks of a law's parameters. The same check serves the C++ constructor (ParameterError) and the maker, for which the
// registry adds the place of the key (SceneError).

/// Throws ParameterError for the key `key` of the law type `law`; `problem` follows the key: "is -1; must be above 0".
[[noreturn]] inline void reject(const char* law, const char* key, const std::string& problem) {
  throw ParameterError({.kind = "law", .name = law}, key, problem);
}
/// Calls reject() unless `ok`.
inline void require(bool ok, const char* law, const char* key, const std::string& problem) {
  if (!ok) reject(law, key, problem);
}
/// Calls reject() unless `value` is finite.
inline void require_finite(const char* law, const char* key, double value) {
  if (!std::isfinite(value)) reject(law, key, "is " + text::number(value) + "; must be a finite number");
}
/// Calls reject() unless `value` is finite and above 0.
inline void require_positive(const char* law, const char* key, double value) {
  if (!(std::isfinite(value) && value > 0)) reject(law, key, "is " + text::number(value) + "; must be above 0");
}
/// Calls reject() when there is no law.
template <class L>
inline void require_law(const char* law, const char* key, const std::shared_ptr<L>& inner) {
  if (!inner) reject(law, key, "is null; give a law");
}
/// `axis` scaled to length 1. Calls reject() when it is zero or not finite.
inline Vec3 require_direction(const char* law, const char* key, const Vec3& axis) {
  const double most = axis.cwiseAbs().maxCoeff();
  if (!axis.allFinite()) reject(law, key, "holds a number that is not finite; give a direction");
  if (most == 0) reject(law, key, "is [0, 0, 0], which is no direction; give one that is not zero");
  return (axis / most).normalized();
}
/// `q` scaled to length 1. Calls reject() when it is zero or not finite.
inline Quat require_orientation(const char* law, const char* key, const Quat& q) {
  const Vec4 c = q.coefficients();
  const double most = c.cwiseAbs().maxCoeff();
  if (!c.allFinite()) reject(law, key, "holds a number that is not finite; give a quaternion");
  if (most == 0) reject(law, key, "is [0, 0, 0, 0], which is no orientation; [1, 0, 0, 0] is the unturned one");
  return normalized(Quat::from(Vec4(c / most)));
}

// Laws 'sum', 'product', 'scale' and 'shift': laws made of laws. They pass on the breakpoints of the inner laws.

/// y = y_1 + y_2 + ... of several laws.
class LOCKSTEP_API SumLaw final : public MotionLaw {
 public:
  /// Throws ModelError for an empty list or a missing law.
  explicit SumLaw(std::vector<LawPtr<MotionLaw>> laws);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  std::vector<LawPtr<MotionLaw>> laws_;
};

/// y = y_1 y_2 ... of several laws.
class LOCKSTEP_API ProductLaw final : public MotionLaw {
 public:
  /// Throws ModelError for an empty list or a missing law.
  explicit ProductLaw(std::vector<LawPtr<MotionLaw>> laws);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  std::vector<LawPtr<MotionLaw>> laws_;
};

/// y = offset + factor law(t).
class LOCKSTEP_API ScaledLaw final : public MotionLaw {
 public:
  /// Throws ModelError for no law or a number that is not finite.
  ScaledLaw(LawPtr<MotionLaw> law, double factor, double offset);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  LawPtr<MotionLaw> law_;
  double factor_, offset_;
};

/// y(t) = law(t - delay): the law delayed by `delay` s (advanced when negative).
class LOCKSTEP_API ShiftedLaw final : public MotionLaw {
 public:
  /// Throws ModelError for no law or a delay that is not finite.
  ShiftedLaw(LawPtr<MotionLaw> law, double delay);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  LawPtr<MotionLaw> law_;
  double delay_;
};

/// Functions that make laws as shared pointers. They throw what the constructors throw.
namespace laws {
/// A SumLaw: y = y_1 + y_2 + ...
inline LawPtr<MotionLaw> sum(std::vector<LawPtr<MotionLaw>> laws) {
  return std::make_shared<const SumLaw>(std::move(laws));
}
/// A ProductLaw: y = y_1 y_2 ...
inline LawPtr<MotionLaw> product(std::vector<LawPtr<MotionLaw>> laws) {
  return std::make_shared<const ProductLaw>(std::move(laws));
}
/// A ScaledLaw: y = offset + factor law(t).
inline LawPtr<MotionLaw> scale(LawPtr<MotionLaw> law, double factor, double offset = 0) {
  return std::make_shared<const ScaledLaw>(std::move(law), factor, offset);
}
/// A ShiftedLaw: y = law(t - delay), delay in s.
inline LawPtr<MotionLaw> shift(LawPtr<MotionLaw> law, double delay) {
  return std::make_shared<const ShiftedLaw>(std::move(law), delay);
}
}  // namespace laws


// Law 'constant'.

/// y = value for all t, in the unit of the coordinate that it drives.
class LOCKSTEP_API Constant final : public MotionLaw {
 public:
  /// Throws ModelError unless finite.
  explicit Constant(double value);
  LawValue at(double t) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  double value_;
};

namespace laws {
/// A Constant: y = value.
inline LawPtr<MotionLaw> constant(double value) { return std::make_shared<const Constant>(value); }
}  // namespace laws


// Law 'fourier'.

/// Parameters of a Fourier law.
struct FourierSettings {
  double omega = 1;               ///< base circular frequency, rad/s
  double offset = 0;              ///< mean value, unit of the coordinate
  std::vector<double> cosines{};  ///< a_1, a_2, ..., unit of the coordinate
  std::vector<double> sines{};    ///< b_1, b_2, ...; the lists may differ in length
};

/// y = offset + sum over k = 1, 2, ... of a_k cos(k omega t) + b_k sin(k omega t), for all t.
class LOCKSTEP_API Fourier final : public MotionLaw {
 public:
  /// Throws ModelError unless all numbers are finite.
  explicit Fourier(FourierSettings);
  LawValue at(double t) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  double omega_, offset_;
  std::vector<double> a_, b_;  // of equal length
};

namespace laws {
/// A Fourier law.
inline LawPtr<MotionLaw> fourier(FourierSettings k) { return std::make_shared<const Fourier>(std::move(k)); }
}  // namespace laws


// From a quaternion on jets of time to a RotationValue.

/// The rotation q = r/|r| of r(t), of any length but zero, with its derivatives: by (1.6) w = G(q) qd and, because
/// G(qd) qd = 0, a = G(q) qdd.
inline RotationValue rotation_value(const QuatT<Time>& r) {
  const QuatT<Time> q = normalized(r);
  const Mat34 G = G_matrix(Quat{q.w.v, q.x.v, q.y.v, q.z.v});
  return {{q.w.v, q.x.v, q.y.v, q.z.v}, G * Vec4(q.w.d, q.x.d, q.y.d, q.z.d), G * Vec4(q.w.h, q.x.h, q.y.h, q.z.h)};
}

// Laws from a user's function of time, with exact derivatives: the function is evaluated on Jet<0>, which has value,
// first and second derivative. Write it for any number type: `[](auto t) { return 0.1 * sin(3.0 * t); }`.

/// Common part of the three laws from a function: the function, and the instants at which it jumps.
template <class Law, class F>
class FromFunction : public Law {
 public:
  /// The function f of Time, and the instants, s, at which it jumps.
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

/// A scalar law from a function of time; made by laws::law().
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
    const Time x = r[0], y = r[1], z = r[2];
    return {Vec3(x.v, y.v, z.v), Vec3(x.d, y.d, z.d), Vec3(x.h, y.h, z.h)};
  }
};

/// A law of a rotation from a function of time; made by rotation_law().
template <class F>
class RotationFrom final : public FromFunction<RotationLaw, F> {
 public:
  using FromFunction<RotationLaw, F>::FromFunction;
  RotationValue at(double t) const override { return rotation_value(this->on_jet(t)); }
};

namespace laws {
/// The scalar law y = f(t). `breaks`: the instants, s, at which y, yd or ydd jumps, if any (f chooses its branch by
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
}  // namespace laws

/// The law of a rotation q = f(t)/|f(t)|; f returns a QuatT of any length but zero:
/// `[](auto t) { return QuatT{cos(t), 0.0 * t, 0.0 * t, sin(t)}; }`. `breaks` as for laws::law().
template <class F>
LawPtr<RotationLaw> rotation_law(F f, std::vector<double> breaks = {}) {
  return std::make_shared<const RotationFrom<F>>(std::move(f), std::move(breaks));
}


// Law 'polynomial'.


/// y = c0 + c1 (t - t0) + c2 (t - t0)^2 + ..., for all t. c_k in the unit of the coordinate per s^k, t0 in s.
class LOCKSTEP_API Polynomial final : public MotionLaw {
 public:
  /// Coefficients c0, c1, ... and t0, s. Throws ModelError for an empty list or a number that is not finite.
  Polynomial(std::vector<double> coefficients, double t0);
  LawValue at(double t) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  std::vector<double> c_;
  double t0_;
};

namespace laws {
/// A Polynomial in t - t0.
inline LawPtr<MotionLaw> polynomial(std::vector<double> coefficients, double t0 = 0) {
  return std::make_shared<const Polynomial>(std::move(coefficients), t0);
}
}  // namespace laws


// Law 'ramp'.


/// y = y0 + slope (t - t0), for all t. t0 in s, y0 in the unit of the coordinate, slope in that unit per s.
class LOCKSTEP_API Ramp final : public MotionLaw {
 public:
  /// Throws ModelError unless all numbers are finite.
  Ramp(double slope, double t0, double y0);
  LawValue at(double t) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  double slope_, t0_, y0_;
};

namespace laws {
/// A Ramp: y = y0 + slope (t - t0).
inline LawPtr<MotionLaw> ramp(double slope, double t0 = 0, double y0 = 0) {
  return std::make_shared<const Ramp>(slope, t0, y0);
}
}  // namespace laws


// Law 'repeat'.

/// Parameters of a Repeat law.
struct RepeatSettings {
  double t0 = 0;       ///< a start of the period, s
  bool drift = false;  ///< each period adds what the law gained over one: y(period) - y(0)
};

/// y = law(s) + n d for all t, s = t - t0 - n period in [0, period), n whole, d = law(period) - law(0) with drift, else
/// 0. Breakpoints: those of the law in (0, period), and the start of each period when y, yd or ydd jumps there.
class LOCKSTEP_API Repeat final : public MotionLaw {
 public:
  /// Repeats what `law` does from its time 0 to `period`, s. Throws ModelError for no law, a period that is not above
  /// 0, or a t0 that is not finite.
  Repeat(LawPtr<MotionLaw> law, double period, const RepeatSettings&);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  LawPtr<MotionLaw> law_;
  double period_, t0_, gain_ = 0;
  bool jump_ = false;
};

namespace laws {
/// A Repeat of the law's time from 0 to `period`, s.
inline LawPtr<MotionLaw> repeat(LawPtr<MotionLaw> law, double period, const RepeatSettings& k = {}) {
  return std::make_shared<const Repeat>(std::move(law), period, k);
}
}  // namespace laws


// Laws 'poly345', 'cycloid' and 'harmonic_rise': a rise in a given time, constant before and after.

/// Parameters of a rise.
struct RiseSettings {
  double rise = 1;      ///< h, unit of the coordinate; may be negative
  double duration = 1;  ///< T > 0, s
  double t0 = 0;        ///< start, s
  double y0 = 0;        ///< value before the rise, unit of the coordinate
};

/// A rise: y = y0 + h s(u), u = (t - t0)/T in [0, 1]; y0 before, y0 + h after. Derived classes give the shape s, with
/// s(0) = 0 and s(1) = 1.
class LOCKSTEP_API Rise : public MotionLaw {
 public:
  LawValue at(double t) const final;

 protected:
  /// `law` names the type in messages. Throws ModelError unless all numbers are finite and T > 0.
  Rise(const char* law, const RiseSettings&);
  virtual LawValue shape(double u) const = 0;  ///< s, s', s'' for u in [0, 1]
  RiseSettings k_;                             ///< the parameters
};

/// Rise s = 10 u^3 - 15 u^4 + 6 u^5: speed and acceleration are zero at both ends; largest speed 1.875 h/T.
class LOCKSTEP_API Poly345 final : public Rise {
 public:
  /// Throws ModelError as Rise does.
  explicit Poly345(const RiseSettings& k) : Rise("poly345", k) {}
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 protected:
  LawValue shape(double u) const override;
};

/// Rise s = u - sin(2 pi u)/(2 pi): the acceleration is one period of a sine; largest speed 2 h/T.
class LOCKSTEP_API Cycloid final : public Rise {
 public:
  /// Throws ModelError as Rise does.
  explicit Cycloid(const RiseSettings& k) : Rise("cycloid", k) {}
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 protected:
  LawValue shape(double u) const override;
};

/// Rise s = (1 - cos(pi u))/2: the acceleration jumps by pi^2 h/(2 T^2) at both ends, which are its breakpoints.
class LOCKSTEP_API HarmonicRise final : public Rise {
 public:
  /// Throws ModelError as Rise does.
  explicit HarmonicRise(const RiseSettings& k) : Rise("harmonic_rise", k) {}
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 protected:
  LawValue shape(double u) const override;
};

namespace laws {
/// A Poly345 rise.
inline LawPtr<MotionLaw> poly345(const RiseSettings& k) { return std::make_shared<const Poly345>(k); }
/// A Cycloid rise.
inline LawPtr<MotionLaw> cycloid(const RiseSettings& k) { return std::make_shared<const Cycloid>(k); }
}  // namespace laws
/// A HarmonicRise.
inline LawPtr<MotionLaw> harmonic_rise(const RiseSettings& k) { return std::make_shared<const HarmonicRise>(k); }


// Law 'sequence'.

/// A piece of a sequence: a law, and how long it runs.
struct Piece {
  double duration;        ///< how long it runs, s
  LawPtr<MotionLaw> law;  ///< evaluated at the time since the piece began, s
};

/// Parameters of a Sequence.
struct SequenceSettings {
  double t0 = 0;         ///< start of the first piece, s
  bool chained = false;  ///< each piece continues from the value at which the one before ended
  bool run_on = false;   ///< outside: the first and last law run on; false: the value is held, at rest
};

/// Laws one after another: y = y_k(t - T_k) + o_k on [T_k, T_k + duration_k), T_k = t0 + the durations before. Chained:
/// o_k = y_(k-1) at its end - y_k(0), o_0 = 0; else o_k = 0. Breakpoints: those of the pieces, and where pieces meet
/// with a jump of y, yd or ydd.
class LOCKSTEP_API Sequence final : public MotionLaw {
 public:
  /// Throws ModelError for no piece, a duration that is not above 0, no law, or a t0 that is not finite. Evaluates the
  /// pieces: what a law throws is passed on.
  Sequence(std::vector<Piece> pieces, const SequenceSettings&);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  bool jumps_at(std::size_t k) const;
  std::vector<Piece> pieces_;
  SequenceSettings k_;
  std::vector<double> start_;   // T_0 .. T_n, the last one the end
  std::vector<double> offset_;  // o_0 .. o_(n-1)
  std::vector<bool> jump_;      // at T_0 .. T_n
};

namespace laws {
/// A Sequence of pieces.
inline LawPtr<MotionLaw> sequence(std::vector<Piece> pieces, const SequenceSettings& k = {}) {
  return std::make_shared<const Sequence>(std::move(pieces), k);
}
}  // namespace laws

// On which side of a jump an instant is, and whether two pieces of law meet with one.

/// Every law is continuous from the right: at a breakpoint it has the value that holds afterwards. Times are sums of
/// durations and delays, so an instant that is meant to be the breakpoint may miss it by a rounding error; an instant
/// that is before it by less than this share of the law's duration counts as the breakpoint.
inline constexpr double kEarly = 1e-12;

/// The limit of `law` for t from below, extrapolated from two instants that are 1e-9 `span` apart; t and span in s.
LawValue left_limit(const MotionLaw& law, double t, double span);

/// Largest |y|, |yd|, |ydd| of `law` at seven instants of [t0, t0 + span), s: the scale for differs().
LawValue size_of(const MotionLaw& law, double t0, double span);

/// Whether a and b differ by more than 1e-10 of `size` in y, yd or ydd.
bool differs(const LawValue& a, const LawValue& b, const LawValue& size);

/// a with the value raised by `offset`; the rates are the same.
inline LawValue raised(LawValue a, double offset) {
  a.y += offset;
  return a;
}
/// The value y at rest.
inline LawValue held(double y) { return {y, 0.0, 0.0}; }


// Law 'sine'.

/// Parameters of a Sine law.
struct SineSettings {
  double amplitude = 1;  ///< unit of the coordinate
  double omega = 1;      ///< circular frequency, rad/s
  double phase = 0;      ///< angle at t = 0, rad
  double offset = 0;     ///< mean value, unit of the coordinate
};

/// y = offset + amplitude sin(omega t + phase), for all t.
class LOCKSTEP_API Sine final : public MotionLaw {
 public:
  /// Throws ModelError unless all numbers are finite.
  explicit Sine(const SineSettings&);
  LawValue at(double t) const override;
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  SineSettings k_;
};

namespace laws {
/// A Sine law.
inline LawPtr<MotionLaw> sine(const SineSettings& k) { return std::make_shared<const Sine>(k); }
}  // namespace laws


// Law 'trapezoid'.

/// Parameters of a Trapezoid: of speed, acceleration and duration two are given, the third is 0 and is computed.
struct TrapezoidSettings {
  double distance = 1;  ///< unit of the coordinate; may be negative
  double speed = 0;  ///< largest |yd|; together with `acceleration` it is a limit that a short distance may not reach
  double acceleration = 0;  ///< |ydd| while speeding up and slowing down
  double duration = 0;      ///< total time, s
  double t0 = 0;            ///< start, s
  double y0 = 0;            ///< value before, unit of the coordinate
};

/// A move with trapezoidal speed: acceleration a for v/a, speed v, acceleration -a for v/a; d = v (T - v/a). y0 before,
/// y0 + d after. Breakpoints: the instants where the acceleration jumps, four, or three without constant speed.
class LOCKSTEP_API Trapezoid final : public MotionLaw {
 public:
  /// Throws ModelError for a number that is not finite, a negative speed, acceleration or duration, unless exactly two
  /// of these are given, or when they cannot give the distance.
  explicit Trapezoid(const TrapezoidSettings&);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  double duration() const { return T_; }         ///< total time T, s; 0 for distance 0
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  void solve(TrapezoidSettings);
  double d_ = 0, v_ = 0, a_ = 0, ta_ = 0,
         T_ = 0;  // signed distance, speed and acceleration; times of speeding up and of all
  double t0_, y0_;
};

namespace laws {
/// A Trapezoid.
inline LawPtr<MotionLaw> trapezoid(const TrapezoidSettings& k) { return std::make_shared<const Trapezoid>(k); }
}  // namespace laws

}  // namespace lockstep
