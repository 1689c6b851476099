// Link 'screw'.
#pragma once

#include <memory>
#include <string>

#include "framework/mechanism/lock/phi_lock.h"
#include "framework/mechanism/params/site.h"

namespace lockstep {

/// (7.4) phi = z - lead theta / 2 pi - reference - f(t), m. Its multiplier is the axial force of the thread.
struct LOCKSTEP_API ScrewThread {
  double lead;               ///< advance per turn, m; negative for a left-hand thread
  LawPtr<MotionLaw> slip{};  ///< f(t), distance from the thread, m; null: none
  double reference = 0;      ///< z - lead theta / 2 pi of the start, m
  static constexpr bool kCountsTurns = true;
  static constexpr RowKind kKind = RowKind::translation;
  static constexpr std::array<const char*, 1> kNames = {"thread"};
  template <class T>
  T advance(const LockCoords<T>& y) const {
    return y.z - lead / kTwoPi * y.angle_z();
  }
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    const T phi = advance(y) - reference;
    return slip ? phi - law_at(*slip, y.t) : phi;
  }
  void initialise(const std::string&, const LockCoords<Time>& y) { reference = advance(y).v; }
  void breakpoints(double t0, double t1, std::vector<double>& out) const;
  std::string diagnose(double t) const;
};

/// Free: turning about z of S, and with it sliding along z. Turns are counted without end.
class LOCKSTEP_API Screw final : public PhiLock<ScrewThread>, public Observable {
 public:
  /// `lead`: m per turn, negative for a left-hand thread; `slip`: law of the distance from the thread, m. The poses of
  /// the start lie on the thread. Throws ModelError: a lead that is not finite.
  Screw(std::string name, Marker& p, Marker& s, double lead, LawPtr<MotionLaw> slip = {});
  std::string_view type() const override { return "screw"; }
  const Observable* observable() const override { return this; }
  std::vector<Quantity> quantities() const override;  ///< angle (counted), rate
  double quantity(int k, const Inputs&) const override;
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};

}  // namespace lockstep
