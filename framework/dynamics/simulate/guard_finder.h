// SPDX-License-Identifier: BSD-3-Clause
// GuardFinder: where the guards of events and contacts pass zero inside the last step. Internal to the step loop.
//
// A guard g is a function of the states inside a step, which is looked at in
//
//   parts = 4, or one for each pi/8 that the body which rotates fastest rotates by: h max |w| / (pi/8), w at both ends;
//           256 where laws alone move all and there is dense output, since nothing then limits the step
//
// g passes zero between two instants where its sign differs, or about a turning point towards zero (comes_to_zero). If a
// body makes many parts, few instants first show whether any guard comes near zero at all. No output may lie beyond zero.
// Of a method without dense output the states inside are those of a cubic polynomial; its own states then decide.
#pragma once

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <lockstep/step_loop.h>
#include "framework/dynamics/simulate/clock.h"
#include "framework/dynamics/simulate/step_interval.h"

namespace lockstep {

/// A quantity at an instant.
struct Sampled {
  double t = 0, g = 0;
};

class GuardOwner;

struct Guard {
  GuardOwner* owner = nullptr;
  std::size_t of = 0;  ///< its number, for its owner
  Event::Crossing crossing = Event::Crossing::falling;
  double tolerance = 0;     ///< of the time, s, except rounding
  double after = -kNever;   ///< instants up to this one do not count
  double least = -kNever;   ///< one before this counts as this
  double from = 0, to = 0;  ///< values at the ends of the step
  bool inside = true;       ///< false if the ends of the step show that it is met nowhere but at outputs, perhaps
  double at = kNever;       ///< where it is met; infinity: nowhere in this step

  /// Strictly from one side: a guard that is zero at first does not cross.
  bool crosses(double was, double now) const {
    const bool up = was < 0 && now >= 0, down = was > 0 && now <= 0;
    return (up && crossing != Event::Crossing::falling) || (down && crossing != Event::Crossing::rising);
  }
};

/// Owners of guards.
class GuardOwner {
 public:
  virtual ~GuardOwner() = default;
  virtual double guard(std::size_t of, const Sample&) = 0;  ///< the value of that guard at this state
};

class GuardFinder {
 public:
  static constexpr int kAlong = 256;  ///< parts where laws alone move all

  GuardFinder(Dynamics& dynamics, StepInterval& interval, const Clock& clock)
      : dynamics_(dynamics), interval_(interval), clock_(clock) {
    inside_.reserve(kAlong), times_.reserve(kAlong + 1);
  }

  /// Forgets all guards, to look at the step that ended with `end`, which must outlive the look.
  void begin(const State& end) {
    end_ = &end, fits_ = false, turn_parts_ = 0;
    guards_.clear(), times_.clear();
  }
  void add(const Guard& g) { guards_.push_back(g); }
  /// Whether no more than the ends needs to be looked at if a guard is far from zero there by its rates. Throws StepError
  /// if a body rotates by more than numbers hold.
  bool is_short() { return measure(), turn_parts_ <= 1 && !along_; }
  /// Finds where each guard is met, and ends the step at the first instant; false if that is its end, or none. Throws
  /// as is_short(), and if a body rotates by more than can be looked at.
  bool find_and_cut(State& end);
  std::span<Guard> guards() { return guards_; }
  /// Its value at t, by the method.
  Sampled own(const Guard& g, double t) {
    return {t, g.owner->guard(g.of, Sample(dynamics_, interval_.at(t), interval_.report()))};
  }
  /// What was seen of the k-th guard, in order, the start of the step first.
  std::size_t n_seen() const { return times_.size(); }
  Sampled seen(std::size_t k, std::size_t j) const { return {times_[j], values_[j * guards_.size() + k]}; }

 private:
  void measure();
  bool must_look_closely();
  [[noreturn]] void refuse() const;
  void place_evenly();
  void place_sparsely();
  void sample();
  void fit();
  const State& look(double t);
  double value(const Guard&, const Sample&);
  double first_before_end() const { return std::min(first(), end_->t); }
  Sampled look_at(const Guard& g, double t) { return {t, value(g, Sample(dynamics_, look(t), interval_.report()))}; }
  void search(std::size_t k);
  void search_end(Guard&, Sampled end, const Sampled& next, const Sampled& after);
  void search_turn(Guard&, Sampled a, Sampled middle, Sampled b);
  void search_outputs();
  void meet(Guard&, Sampled a, Sampled b);
  bool of_method(const Guard&, Sampled& a, Sampled& b);
  double first() const;

  Dynamics& dynamics_;
  StepInterval& interval_;
  const Clock& clock_;
  const State* end_ = nullptr;
  std::vector<Guard> guards_;
  double turn_parts_ = 0;  // by the turn alone; 0: not measured
  bool along_ = false;     // laws alone move all
  bool fits_ = false;      // the cubic is that of this step
  std::vector<double> inside_, times_, values_, here_, before_;
  State guess_;
  VecX rate0_, rate1_;  // dq/dt at the ends
};

/// For g > 0 at a and g <= 0 at b: the far end of a bracket no longer than `tolerance`. There g <= 0, so the same root is not
/// found again at once. By TOMS 748 (Alefeld, Potra & Shi, ACM Trans. Math. Softw. 21 (1995) 327), which needs some 8
/// evaluations where a guarded false position needs 30; each may cost a step.
template <class G>
double falling_root(double a, double ga, double b, double gb, double tolerance, const G& g) {
  if (!(ga > 0)) return a;
  const auto close = [&](double left, double right) { return right - left <= tolerance; };
  std::uintmax_t most = 200;
  return gb == 0 || close(a, b) ? b : boost::math::tools::toms748_solve(g, a, b, ga, gb, close, most).second;
}

/// Whether g, which is on one side of zero at a, m and b and nearest to it at m, comes to zero between a and b: then m
/// is a point at zero or beyond, and a and b are on the near side, about it. By parabolas and the golden section in
/// turn, no further than to `shortest`, s. A dip below m is g'' w^2/2 at most, w the longer part: where m is farther
/// from zero than g'' w^2, there is no zero.
template <class G>
bool comes_to_zero(Sampled& a, Sampled& m, Sampled& b, double shortest, const G& g) {
  const double sign = m.g > 0 ? 1 : -1;
  for (int k = 0; k < 100; ++k) {
    const double left = m.t - a.t, right = b.t - m.t, longer = left > right ? left : right;
    if (!(longer > shortest)) return false;
    const double da = sign * (a.g - m.g) / left, db = sign * (b.g - m.g) / right;  // slopes away from m, >= 0
    const double bend = 2 * (da + db) / (left + right);
    if (!(bend > 0) || sign * m.g > bend * longer * longer) return false;
    double step = (da * right - db * left) / (da + db) / 2;  // to the lowest point of the parabola
    const double side = left > right ? -left : right;
    if (k % 2 == 1 || !(std::abs(step) > shortest)) step = (2 - std::numbers::phi) * side;
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
