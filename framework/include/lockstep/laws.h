// SPDX-License-Identifier: BSD-3-Clause
// Scalar laws of motion: closed forms here, combined laws, laws from functions.
#pragma once

#include <vector>

#include <lockstep/author/law.h>
#include <lockstep/combined_laws.h>
#include <lockstep/function_laws.h>

namespace lockstep {

/// Parameters of fourier().
struct FourierSettings {
  double omega = 1;               ///< base circular frequency, rad/s
  double offset = 0;              ///< mean value, unit of the coordinate
  std::vector<double> cosines{};  ///< a_1, a_2, ..., unit of the coordinate
  std::vector<double> sines{};    ///< b_1, b_2, ...; the lists may differ in length
};

/// Parameters of a rise.
struct RiseSettings {
  double rise = 1;      ///< h, unit of the coordinate; may be negative
  double duration = 1;  ///< T > 0, s
  double t0 = 0;        ///< start, s
  double y0 = 0;        ///< value before the rise, unit of the coordinate
};

/// Parameters of sine().
struct SineSettings {
  double amplitude = 1;  ///< unit of the coordinate
  double omega = 1;      ///< circular frequency, rad/s
  double phase = 0;      ///< angle at t = 0, rad
  double offset = 0;     ///< mean value, unit of the coordinate
};

/// Parameters of trapezoid(): of speed, acceleration and duration two are given, the third is 0 and is computed.
struct TrapezoidSettings {
  double distance = 1;  ///< unit of the coordinate; may be negative
  double speed = 0;  ///< largest |yd|; together with `acceleration` it is a limit that a short distance may not reach
  double acceleration = 0;  ///< |ydd| while speeding up and slowing down
  double duration = 0;      ///< total time, s
  double t0 = 0;            ///< start, s
  double y0 = 0;            ///< value before, unit of the coordinate
};

/// Functions that make laws, as shared pointers.
namespace laws {
// Law 'constant'.

/// y = value for all t, in the unit of the coordinate that it drives. Throws ModelError unless finite.
LOCKSTEP_API LawPtr<MotionLaw> constant(double value);

// Law 'fourier'.

/// y = offset + sum over k = 1, 2, ... of a_k cos(k omega t) + b_k sin(k omega t), for all t. Throws ModelError unless all
/// numbers are finite.
LOCKSTEP_API LawPtr<MotionLaw> fourier(FourierSettings k);

// Law 'polynomial'.

/// y = c0 + c1 (t - t0) + c2 (t - t0)^2 + ..., for all t. c_k in the unit of the coordinate per s^k, t0 in s. Throws
/// ModelError for an empty list or a number that is not finite.
LOCKSTEP_API LawPtr<MotionLaw> polynomial(std::vector<double> coefficients, double t0 = 0);

// Law 'ramp'.

/// y = y0 + slope (t - t0), for all t. t0 in s, y0 in the unit of the coordinate, slope in that unit per s. Throws
/// ModelError unless all numbers are finite.
LOCKSTEP_API LawPtr<MotionLaw> ramp(double slope, double t0 = 0, double y0 = 0);

// Laws 'poly345', 'cycloid' and 'harmonic_rise': y = y0 + h s(u), u = (t - t0)/T in [0, 1]; y0 before, y0 + h after. Both
// ends are breakpoints.

/// s = 10 u^3 - 15 u^4 + 6 u^5: speed and acceleration are zero at both ends; largest speed 1.875 h/T. Throws ModelError
/// unless all numbers are finite and T > 0.
LOCKSTEP_API LawPtr<MotionLaw> poly345(const RiseSettings& k);
/// s = u - sin(2 pi u)/(2 pi): the acceleration is one period of a sine; largest speed 2 h/T. Throws as poly345().
LOCKSTEP_API LawPtr<MotionLaw> cycloid(const RiseSettings& k);
/// s = (1 - cos(pi u))/2: the acceleration jumps by pi^2 h/(2 T^2) at both ends. Throws as poly345().
LOCKSTEP_API LawPtr<MotionLaw> harmonic_rise(const RiseSettings& k);

// Law 'sine'.

/// y = offset + amplitude sin(omega t + phase), for all t. Throws ModelError unless all numbers are finite.
LOCKSTEP_API LawPtr<MotionLaw> sine(const SineSettings& k);

// Law 'trapezoid'.

/// A move with trapezoidal speed: acceleration a for v/a, speed v, acceleration -a for v/a; d = v (T - v/a). y0 before,
/// y0 + d after. Breakpoints: the times at which the acceleration jumps, four, or three without constant speed. Throws
/// ModelError for a number that is not finite, a negative speed, acceleration or duration, unless exactly two of these
/// are given, or when they cannot give the distance.
LOCKSTEP_API LawPtr<MotionLaw> trapezoid(const TrapezoidSettings& k);
}  // namespace laws

}  // namespace lockstep
