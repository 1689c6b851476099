// SPDX-License-Identifier: BSD-3-Clause
// Scalar laws of motion: closed forms here, laws made of laws, laws from functions.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/author/law.h>
#include <lockstep/author/law_checks.h>
#include <lockstep/author/params.h>
#include <lockstep/combined_laws.h>
#include <lockstep/function_laws.h>

namespace lockstep {

// Law 'constant'.

/// y = value for all t, in the unit of the coordinate that it drives.
class LOCKSTEP_API Constant final : public MotionLaw {
 public:
  /// Throws ModelError unless finite.
  explicit Constant(double value);
  LawValue at(double t) const override;
  bool is_constant() const override { return true; }
  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  double value_;
};

namespace laws {
/// A Constant: y = value.
LOCKSTEP_API LawPtr<MotionLaw> constant(double value);
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
LOCKSTEP_API LawPtr<MotionLaw> fourier(FourierSettings k);
}  // namespace laws

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
LOCKSTEP_API LawPtr<MotionLaw> polynomial(std::vector<double> coefficients, double t0 = 0);
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
LOCKSTEP_API LawPtr<MotionLaw> ramp(double slope, double t0 = 0, double y0 = 0);
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
LOCKSTEP_API LawPtr<MotionLaw> poly345(const RiseSettings& k);
/// A Cycloid rise.
LOCKSTEP_API LawPtr<MotionLaw> cycloid(const RiseSettings& k);
/// A HarmonicRise.
LOCKSTEP_API LawPtr<MotionLaw> harmonic_rise(const RiseSettings& k);
}  // namespace laws

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
LOCKSTEP_API LawPtr<MotionLaw> sine(const SineSettings& k);
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
LOCKSTEP_API LawPtr<MotionLaw> trapezoid(const TrapezoidSettings& k);
}  // namespace laws

}  // namespace lockstep
