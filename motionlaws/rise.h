// Laws 'poly345', 'cycloid' and 'harmonic_rise': a rise in a given time, constant before and after.
#pragma once

#include "framework/mechanism/params/params.h"

namespace lockstep {

struct RiseSettings {
  double rise = 1;      ///< h, unit of the coordinate; may be negative
  double duration = 1;  ///< T > 0, s
  double t0 = 0;        ///< start, s
  double y0 = 0;        ///< value before
};

/// y = y0 + h s(u), u = (t - t0)/T in [0, 1]; y0 before, y0 + h after. Derived classes give the shape s with s(0) = 0,
/// s(1) = 1.
class LOCKSTEP_API Rise : public MotionLaw {
 public:
  LawValue at(double t) const final;

 protected:
  /// Throws ModelError unless all are finite and T > 0.
  Rise(const char* law, const RiseSettings&);
  virtual LawValue shape(double u) const = 0;  ///< s, s', s'' for u in [0, 1]
  RiseSettings k_;
};

/// s = 10 u^3 - 15 u^4 + 6 u^5: speed and acceleration start and end at zero; largest speed 1.875 h/T.
class LOCKSTEP_API Poly345 final : public Rise {
 public:
  explicit Poly345(const RiseSettings& k) : Rise("poly345", k) {}
  static const TypeInfo& info();
  static LawPtr<MotionLaw> make(const Params&);

 protected:
  LawValue shape(double u) const override;
};

/// s = u - sin(2 pi u)/(2 pi): acceleration is one period of a sine; largest speed 2 h/T.
class LOCKSTEP_API Cycloid final : public Rise {
 public:
  explicit Cycloid(const RiseSettings& k) : Rise("cycloid", k) {}
  static const TypeInfo& info();
  static LawPtr<MotionLaw> make(const Params&);

 protected:
  LawValue shape(double u) const override;
};

/// s = (1 - cos(pi u))/2: acceleration jumps by pi^2 h/(2 T^2) at both ends, which are its breakpoints.
class LOCKSTEP_API HarmonicRise final : public Rise {
 public:
  explicit HarmonicRise(const RiseSettings& k) : Rise("harmonic_rise", k) {}
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();
  static LawPtr<MotionLaw> make(const Params&);

 protected:
  LawValue shape(double u) const override;
};

namespace laws {
inline LawPtr<MotionLaw> poly345(const RiseSettings& k) { return std::make_shared<const Poly345>(k); }
inline LawPtr<MotionLaw> cycloid(const RiseSettings& k) { return std::make_shared<const Cycloid>(k); }
}  // namespace laws
inline LawPtr<MotionLaw> harmonic_rise(const RiseSettings& k) { return std::make_shared<const HarmonicRise>(k); }

}  // namespace lockstep
