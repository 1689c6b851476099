// MarkerForce: what the forces between markers share: P, perhaps S, their folded frames, and the checks of parameters.
#pragma once

#include <string>
#include <vector>

#include "framework/foundation/support/error.h"
#include "framework/mechanism/forces/force.h"
#include "framework/mechanism/lock/marker_frame.h"
#include "framework/mechanism/params/params.h"
#include "framework/mechanism/params/site.h"

namespace lockstep {

class LOCKSTEP_API MarkerForce : public Force {
 public:
  /// Throws ModelError: a marker without a body, or P and S on one body.
  MarkerForce(std::string name, Marker& p, Marker* s);
  ~MarkerForce() override;

  std::vector<const Marker*> markers() const override;
  /// Of the markers' laws and of all laws that were handed to `add_law`.
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  /// The same laws.
  std::string diagnose(double t) const override;
  /// Folds the markers into their slots.
  void setup() override;

  const Marker& p() const { return *p_; }
  const Marker* s() const { return s_; }  ///< nullptr: nothing takes the reaction

 protected:
  // All throw ParameterError "force 'name': key is value; must be ...".
  void require(bool ok, const char* key, const std::string& problem) const;
  void require_finite(const char* key, double value) const;
  void require_finite(const char* key, const Vec3& value) const;
  void require_not_negative(const char* key, double value) const;

  /// Throws ModelError when the marker is on a particle, which takes no torque; `does` says what would turn it.
  void require_turning(const Marker& m, const char* does) const;

  void add_law(const LawPtr<MotionLaw>& law);  ///< null is no law
  static double value(const LawPtr<MotionLaw>& law, double t) { return law ? law->at(t).y : 0.0; }

  MarkerFrame P_, S_;  ///< made by setup(); S_ is the ground's origin when there is no S

 private:
  const Marker* p_;
  const Marker* s_;
  std::vector<LawPtr<MotionLaw>> laws_;
};

/// The markers of a site, for makers. Throw SceneError when there is none.
LOCKSTEP_API Marker& p_of(const Site&, const Params&);
LOCKSTEP_API Marker& s_of(const Site&, const Params&);
/// Whether the site has an S.
LOCKSTEP_API bool has_s(const Site&);

}  // namespace lockstep
