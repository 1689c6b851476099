// StepSearch: at which instants a step is looked at for events and contacts, and the states there. Internal to the step
// loop.
//
//   parts = 4, or one for each pi/8 that the body which turns fastest turns by: h max |w| / (pi/8), w at both ends;
//           256 where laws alone move all and there is dense output, since nothing then limits the step
//
// A quantity of the mechanism is known at the instants between the parts. Beside a turning point towards zero it is
// looked at closer (comes_to_zero). Of a method without dense output the states inside are those of a cubic polynomial.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "framework/dynamics/simulate/clock.h"
#include "framework/dynamics/simulate/step_interval.h"

namespace lockstep {

inline constexpr double kNever = std::numeric_limits<double>::infinity();  ///< an instant that does not come

class StepSearch {
 public:
  static constexpr int kLeast = 4;      ///< parts at least, where a step is looked at inside
  static constexpr int kAlong = 256;    ///< parts where laws alone move all
  static constexpr int kMany = 16;      ///< more parts are looked at only where few instants show a need
  static constexpr double kMost = 1e6;  ///< parts at most
  static constexpr double kPart = 0.39269908169872414;  ///< pi/8 rad, the turn of a body in a part

  StepSearch(Dynamics& dynamics, StepInterval& interval, const Clock& clock)
      : dynamics_(dynamics), interval_(interval), clock_(clock) {
    times_.reserve(kMany);
  }

  /// Looks at the step that ended with `end`, which must outlive the look. Throws StepError where a body turns by more than
  /// numbers hold.
  void begin(const State& end);
  /// Parts by the turn alone, >= 1.
  double turn_parts() const { return turn_parts_; }
  bool along() const { return along_; }  ///< whether laws alone move all, by a method with dense output
  /// Whether so many parts are due that scales() are to be looked at first.
  bool many() const { return turn_parts_ > kMany && !along_; }
  /// The instants inside the step at which it is looked at, between its ends. Each list is valid until the next is
  /// asked for. Throws StepError for more than kMost parts.
  const std::vector<double>& even();
  /// A few of them: all of the first turn of the body that turns fastest, kMany, and 4 from octave to octave up to the
  /// whole step. Whatever turns steadily makes half a turn or more between some of them, 8 to the octave, whichever its
  /// speed.
  const std::vector<double>& scales();
  /// The outputs inside the step that come before t; none where they end steps.
  const std::vector<double>& outputs_before(double t);
  /// The state at t, valid until the next call: on the constraints, or of a method without dense output near them: a
  /// cubic in q and a line in v and s between the ends.
  const State& look(double t);

 private:
  void fit();
  [[noreturn]] void refuse() const;

  Dynamics& dynamics_;
  StepInterval& interval_;
  const Clock& clock_;
  const State* end_ = nullptr;
  double turn_parts_ = 1;
  bool along_ = false;  // laws alone move all
  bool fits_ = false;   // the cubic is that of this step
  std::vector<double> times_;
  State guess_;
  VecX rate0_, rate1_;  // dq/dt at the ends
};

/// A quantity at an instant.
struct Sampled {
  double t = 0, g = 0;
};

/// Whether values whose nearest to zero is `least` and which differ by `range` cannot come to zero between them.
inline bool is_far(double least, double range) { return least > 2 * range; }

/// Whether g, which is on one side of zero at a, m and b and nearest to it at m, comes to zero between a and b: then m
/// is a point at zero or beyond, and a and b are on the near side, about it. By parabolas and the golden section in
/// turn, no further than to `shortest`, s. A dip below m is g'' w^2/2 at most, w the longer part: where m is farther
/// from zero than g'' w^2, there is no zero.
template <class G>
bool comes_to_zero(Sampled& a, Sampled& m, Sampled& b, double shortest, const G& g) {
  constexpr double kGolden = 0.3819660112501051, kApart = 0.02;
  const double sign = m.g > 0 ? 1 : -1;
  for (int k = 0; k < 100; ++k) {
    const double left = m.t - a.t, right = b.t - m.t, longer = left > right ? left : right;
    if (!(longer > shortest)) return false;
    const double da = sign * (a.g - m.g) / left, db = sign * (b.g - m.g) / right;  // slopes away from m, >= 0
    const double bend = 2 * (da + db) / (left + right);
    if (!(bend > 0) || sign * m.g > bend * longer * longer) return false;
    double step = (da * right - db * left) / (da + db) / 2;  // to the lowest point of the parabola
    const double side = left > right ? -left : right;
    if (k % 2 == 1 || !(std::abs(step) > kApart * longer)) step = kGolden * side;
    const Sampled p{m.t + step, g(m.t + step)};
    if (!(sign * p.g > 0)) {
      (step > 0 ? a : b) = m;
      m = p;
      return true;
    }
    if (sign * p.g < sign * m.g) {
      (step > 0 ? a : b) = m;
      m = p;
    } else {
      (step > 0 ? b : a) = p;
    }
  }
  return false;
}

}  // namespace lockstep
