// SPDX-License-Identifier: BSD-3-Clause
// FormulationSeen: in which formulation the steps of a run were taken.
#pragma once

#include <string>

#include <lockstep/author/memory.h>
#include <lockstep/dynamics_options.h>
#include <lockstep/step_loop.h>

namespace lockstep {

/// Counts the steps of a run by the coordinates of their ends. An event may change the choice of "auto".
class FormulationSeen final : public Observer {
 public:
  void step(const Sample& s) override { ++(s.state.coordinates ? joint_ : slots_); }
  void save(Snapshot& out) const override {
    out.put(static_cast<double>(joint_)), out.put(static_cast<double>(slots_));
  }
  void load(SnapshotReader& in) override { joint_ = in.get_count(), slots_ = in.get_count(); }

  /// That of most steps; of the state if there was none: "joint", "omega" or "quaternion".
  std::string name(const StepLoop& sim, Formulation asked) const {
    const bool joint = joint_ + slots_ > 0 ? joint_ >= slots_ : sim.state().coordinates != nullptr;
    return joint ? "joint" : to_string(asked == Formulation::quaternion ? asked : Formulation::omega);
  }

 private:
  long joint_ = 0, slots_ = 0;
};

}  // namespace lockstep
