// Link 'screw'.
#pragma once

#include <memory>
#include <string>

#include "framework/mechanism/lock/phi_lock.h"
#include "framework/mechanism/params/site.h"

namespace lockstep {

/// (7.4) phi = z - lead theta / 2 pi - home - f(t), m. Its multiplier is the axial force of the thread.
struct LOCKSTEP_API ScrewThread {
  double lead;
  LawPtr<MotionLaw> slip{};
  double home = 0;
  static constexpr bool kCountsTurns = true;
  static constexpr RowKind kKind = RowKind::translation;
  static constexpr std::array<const char*, 1> kNames = {"thread"};
  template <class T>
  T advance(const LockCoords<T>& y) const {
    return y.z - lead / kTwoPi * y.angle_z();
  }
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    const T phi = advance(y) - home;
    return slip ? phi - of(*slip, y.t) : phi;
  }
  void at_home(const std::string&, const LockCoords<Time>& y) { home = advance(y).v; }
  void breakpoints(double t0, double t1, std::vector<double>& out) const;
  std::string blame(double t) const;
};

/// Free: turning about z of S, and with it sliding along z. Turns are counted without end.
class LOCKSTEP_API Screw final : public PhiLock<ScrewThread> {
 public:
  /// `lead`: m a turn, negative for a left-hand thread; `slip`: law of the distance from the thread, m. The home poses
  /// lie on the thread. Throws ModelError: a lead that is not finite.
  Screw(std::string name, Marker& p, Marker& s, double lead, LawPtr<MotionLaw> slip = {});
  std::string_view type() const override { return "screw"; }
  std::vector<Quantity> quantities() const override;  ///< angle (counted), rate
  double quantity(int k, const Inputs&) const override;
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};

}  // namespace lockstep
