// SPDX-License-Identifier: BSD-3-Clause
// History: a measured run at the times of comparison. Private to the work_precision*.cpp files.
#pragma once

#include <functional>
#include <vector>

#include <lockstep/recorder.h>
#include "framework/tools/precision/work_precision.h"

namespace lockstep {

struct Instant {
  double t, energy, kinetic;
  VecX poses;  ///< of all bodies, 7 each: centre of mass (m, world), quaternion of the body's own axes
  VecX v;      ///< of all rigid groups, 6 each, as State::v
  VecX load;  ///< of all joints, 6 per rigid group: force (N, world), moment about the centre of mass (N m, group axes)
};
using History = std::vector<Instant>;

/// Fills a history and measures its own cost: the loads take an extra evaluation.
class HistoryObserver final : public Observer {
 public:
  HistoryObserver(System& system, const std::function<double()>& cpu, History& to)
      : system_(system),
        energy_(make_channel(system, "energy.total")),
        kinetic_(make_channel(system, "energy.kinetic")),
        cpu_(cpu),
        to_(to) {}
  void output(const Sample&) override;
  double cpu() const { return spent_; }  ///< s
  long evaluations() const { return evaluations_; }

 private:
  const System& system_;
  Channel energy_, kinetic_;
  const std::function<double()>& cpu_;
  History& to_;
  double spent_ = 0;
  long evaluations_ = 0;
};

/// Largest difference; infinite if the two have different times or a number is not finite. Positions may be of two
/// systems of one scene, whose rigid groups have other axes in a plane than in space.
HistoryError difference(const History&, const History&, double length);
/// Largest displacement from the start, speed, load, and of the energy its change or its kinetic part.
HistoryError size_of(const History&, double length);

}  // namespace lockstep
