// SPDX-License-Identifier: BSD-3-Clause
// What kinematics and inverse dynamics of a scene have in common: its times, its columns, the way through its poses.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/kinematics.h>
#include <lockstep/scene.h>
#include <lockstep/step_loop.h>

namespace lockstep {

/// Gives bodies without mass 1 kg and 1 kg m^2 about all axes: a motion by laws does not depend on them. Their names.
LOCKSTEP_API std::vector<std::string> fill_masses(Scene&);
/// The columns that the scene records, or places; for `inverse` dynamics those of all drives and reactions too, if the scene
/// does not record them under these names. Throws SceneError for columns that depend on masses, unless `without`, of
/// fill_masses(), is empty, and for those of works, as nothing is integrated here.
LOCKSTEP_API void record_driven(Mechanism&, const std::vector<std::string>& without, bool inverse);
/// The times of the poses: those that the scene lists, or the multiples of an interval and the end.
LOCKSTEP_API std::vector<double> pose_times(const RunSettings&);

/// Goes through the poses at these times. At each pose `seen` is called, after the observers, which see the motion between
/// the poses and no outputs. An error has its cause; `lines` gives it further lines.
LOCKSTEP_API void follow(
    DrivenMotion&, Dynamics&, const std::vector<double>& times, const std::vector<Observer*>& observers,
    const std::function<void(const Sample&)>& seen,
    const std::function<std::string()>& lines = [] { return std::string(); });

}  // namespace lockstep
