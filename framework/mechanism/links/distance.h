// Link 'distance'.
#pragma once

#include <cmath>
#include <memory>
#include <string>

#include "framework/mechanism/lock/phi_lock.h"
#include "framework/mechanism/model/law_fault.h"
#include "framework/mechanism/params/site.h"

namespace lockstep {

/// (7.4) |rho| - f(t). The multiplier is the axial force: positive pulls the two points together.
struct DistanceFunction {
  LawPtr<MotionLaw> law;  ///< f(t), m; null: `length`
  double length = 0;      ///< m
  static constexpr Reads kReads = Reads::translation;
  static constexpr RowKind kKind = RowKind::translation;
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    using std::sqrt;
    return sqrt(y.x * y.x + y.y * y.y + y.z * y.z) - (law ? law_at(*law, y.t) : T(length));
  }
  double length_at(double t) const { return law ? law->at(t).y : length; }
  void breakpoints(double t0, double t1, std::vector<double>& out) const {
    if (law) law->breakpoints(t0, t1, out);
  }
  std::string diagnose(double t) const { return law ? law_fault("the law of its length", law, t) : ""; }
};

/// Distance between the origins of P and S, constant or by a law (m). Free: everything that keeps the distance; without
/// a direction, hence refused, at length zero.
class LOCKSTEP_API Distance final : public PhiLock<DistanceFunction> {
 public:
  Distance(std::string name, Marker& p, Marker& s, double length);
  Distance(std::string name, Marker& p, Marker& s, LawPtr<MotionLaw> length);
  /// At the distance of the start.
  Distance(std::string name, Marker& p, Marker& s);
  std::string_view type() const override { return "distance"; }
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);

 protected:
  RowPlan plan_rows() override;
};

}  // namespace lockstep
