// SPDX-License-Identifier: BSD-3-Clause
// What kinematics and inverse dynamics of a scene have in common: its times, its columns, the motion between its poses.
#pragma once

#include <string>
#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/kinematics.h>
#include <lockstep/scene.h>
#include <lockstep/step_loop.h>

namespace lockstep {

/// Gives bodies without mass 1 kg and 1 kg m^2 about all axes: a motion by laws does not depend on them. Their names.
LOCKSTEP_API std::vector<std::string> fill_masses(Scene&);
/// Throws SceneError for columns that depend on masses. `without`: of fill_masses().
LOCKSTEP_API void refuse_columns_of_masses(const Mechanism&, const std::vector<std::string>& without);
/// Nothing is integrated here: a column of a work is a SceneError.
LOCKSTEP_API void refuse_integrated_columns(Mechanism&);
/// Columns of all drives and reactions, in addition to those that the scene records under these names.
LOCKSTEP_API void record_reactions(Mechanism&);
/// The times of the poses: those that the scene lists, or the multiples of an interval and the end.
LOCKSTEP_API std::vector<double> pose_times(const RunSettings&);

/// The motion between two poses, by one that goes its own way: the poses of the table do not depend on it.
class BetweenPoses final : public InsideStep {
 public:
  BetweenPoses(const DrivenMotion& from, Dynamics& dynamics, const Sample& end)
      : begin_(from.state().t), motion_(from), dynamics_(dynamics), end_(end) {}
  double begin() const override { return begin_; }
  const Sample& end() const override { return end_; }
  bool has_states() const override { return true; }
  Sample at(double t) const override {
    motion_.to(t), end_.forget();
    return {dynamics_, motion_.state(), end_.report};
  }
  bool along_laws() const override { return true; }

 private:
  const double begin_;
  mutable DrivenMotion motion_;
  Dynamics& dynamics_;
  const Sample& end_;
};

}  // namespace lockstep
