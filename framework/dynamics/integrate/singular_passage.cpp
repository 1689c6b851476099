#include "framework/dynamics/integrate/singular_passage.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include "framework/dynamics/integrate/speed_of.h"
#include "framework/dynamics/solvers/graph.h"
#include "framework/dynamics/solvers/stop_rule.h"

namespace lockstep {

namespace {

constexpr double kTurn = 0.5;          // rad per step, with the stages on the constraints
constexpr double kFirstTurn = 0.1;     // rad: a first step that leads out of a singular position
constexpr double kSingular = 1e-2;     // indicator below which the stages go onto the constraints: this,
constexpr double kUnusual = 0.1;       // or this part of the one in regular positions, if that is less;
constexpr double kRegular = 3;         // and times which they leave them again
constexpr double kNowhere = 1e-7;      // indicator below which it only reflects the proximal term,
constexpr double kShareOfNear = 1e-3;  // or this part of the limit to what is near, if that is less
constexpr double kBothSides = 1e-9;    // relative accuracy of rates from both sides
constexpr double kShortTurn = 1e-3;  // rad: in a step that turns less, errors near a singular position are round-off's,
constexpr double kNoiseOfSteps = 3e-12;  // if they are within this, relative, over the indicator
constexpr double kUnmet = 1e-6;          // residual of rows that could not be met, where no position is near
constexpr double kRoundOff = 1e-17;      // relative round-off of the accelerations times the indicator
constexpr double kShrunk = 0.3;          // of the longest plain step
constexpr double kShift = 0.93;          // a step that avoids an ill-conditioned end,
constexpr int kShifts = 12;              // attempted this many times; then the best of them is taken,
constexpr double kCross = 100;           // with an error up to this
constexpr double kLeast = 0.1;           // of the step: one that only leads to where the next should begin

}  // namespace

// Angular velocity of the body that turns fastest at y, rad/s.
double SingularPassage::fastest_turn(const State& y) {
  if (!y.coordinates) return lockstep::fastest_turn(y.v);
  motions_.resize(static_cast<std::size_t>(y.coordinates->n_slots() + 1));  // the ground, at rest, is never written
  y.coordinates->motions(y, motions_);
  return lockstep::fastest_turn(motions_);
}

// Time in which the body that turns fastest at the start of the step turns by this angle, s.
double SingularPassage::time_to_turn(double angle) const {
  return rate_of_turn_ > 0 ? angle / rate_of_turn_ : HUGE_VAL;
}

// Rates from both sides are found with the bodies' own coordinates.
bool SingularPassage::find_both_sides(Dynamics& dynamics, const State& y) {
  if (!y.coordinates) return both_sides_.find(dynamics, y, rate_);
  State slots = y;
  dynamics.to_slots(slots);
  both_sides_.begin(slots);
  StateRate rate = sized_like(slots);
  const bool found = both_sides_.find(dynamics, slots, rate);
  if (found) dynamics.read_rates(y, rate, rate_);
  both_sides_ = SingularRate();  // nothing stays of a look at the slots
  return found;
}

double near_singular_below(double regular) { return std::min(kSingular, kUnusual * regular); }

void SingularPassage::begin(const Tableau& tableau, const State& state, Dynamics& dynamics) {
  const bool projects = dynamics.options().stabilization.kind == Stabilization::Kind::project;
  const bool has_rows = !state.coordinates || state.coordinates->has_rows();
  active_ = has_rows && (when_ == StagesWhen::manifold ||
                         (when_ == StagesWhen::automatic && projects && has_loops(dynamics.system(), state.modes)));
  near_ = begun_ = entered_ = on_constraints_ = false;
  below_ = 0;
  longest_plain_ = 0;
  ahead_ = HUGE_VAL;
  const double* c = tableau.c;
  nodes_.assign(c, c + tableau.n_stages);
  std::ranges::sort(nodes_);
  nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
  last_ = static_cast<int>(std::max_element(c, c + tableau.n_stages) - c);
  inner_ = 0;
  for (int i = 0; i < tableau.n_stages; ++i)
    if (c[i] < c[last_] && c[i] > c[inner_]) inner_ = i;
  if (!active_) return;
  if (!state.coordinates) both_sides_.begin(state);  // else states in the slots' own coordinates are looked at
  rate_ = sized_like(state);
  const Redundancy redundancy = dynamics.redundancy(state);
  below_ = near_singular_below(redundancy.regular), on_constraints_ = redundancy.on_constraints;
}

void SingularPassage::start_step() {
  const bool always = active_ && (when_ == StagesWhen::manifold || on_constraints_);
  on_ = always || near_ ? StagesOn::manifold : StagesOn::plain;
  shifts_ = 0, limit_ = 1, unplaced_ = 0, best_ = {0, kCross}, entered_ = false;
}

bool SingularPassage::first_stage(Dynamics& dynamics, const State& y, Stages& stages) {
  if (active()) rate_of_turn_ = fastest_turn(y);
  if (!stages.evaluate(dynamics, y, 0, 0, 1, on_)) return false;
  if (!active() || !ill_conditioned(stages, 0)) return true;
  const bool held_rows = dynamics.holds_rows();
  from_both_sides_ = find_both_sides(dynamics, y);
  if (!held_rows) dynamics.forget_rows(y);  // what was asked once does not keep the rows of all links
  if (from_both_sides_) {
    stages.put(0, rate_);
    limit_ = std::max(limit_, kBothSides / relative_);
  } else if (!begun_) {
    throw StepError(
        fmt::format("{}: at t = {:.9g} s the links do not determine how the motion continues (smallest relative pivot "
                    "{:.2g}): it is a singular position, from which several motions continue or none, or rows nearly "
                    "depend on others; start slightly off it, with the intended velocity, take away a link that "
                    "repeats another (lockstep check names them), or take --solver dense",
                    method_, y.t, stages.conditioning(0).pivot),
        y.t);
  }
  return true;
}

double SingularPassage::longest(double h) {
  if (on_ == StagesOn::plain) return h;
  unplaced_ = std::min(h, time_to_turn(kTurn));
  return straddle(unplaced_);
}

// At most h: the step whose nodes are farthest from the position ahead, or one to where such a step begins.
double SingularPassage::straddle(double h) const {
  if (!(ahead_ < 2 * h)) return h;
  double widest = 0, before = 0, farthest = 0, best = h;
  for (std::size_t i = 1; i < nodes_.size(); ++i) {
    const double half = 0.5 * (nodes_[i] - nodes_[i - 1]), middle = 0.5 * (nodes_[i] + nodes_[i - 1]);
    if (half > widest) widest = half, before = ahead_ - middle * h;
    const double with = ahead_ / middle;  // a step of this length has the position in the middle of the gap
    if (with > h || half * with <= farthest) continue;
    farthest = half * with;
    best = i == 1 ? h : with;  // the position is next to the start: any long step keeps away
  }
  if (before >= h) return h;
  return before > 0 ? std::max(before, kLeast * h) : best;
}

bool SingularPassage::enters(const Stages& stages) {
  if (!active_ || on_ == StagesOn::manifold || !near(stages)) return false;
  on_ = StagesOn::manifold;
  entered_ = true;
  return true;
}

// The next step would begin where stage last_ is.
bool SingularPassage::must_shift(const Stages& stages, double error) const {
  if (on_ == StagesOn::plain || shifts_ == kShifts || ill_conditioned(stages, 0)) return false;
  return ill_conditioned(stages, last_) || (error > limit_ && near(stages));
}

double SingularPassage::shift(const Stages& stages, double h, double error) {
  if (h * rate_of_turn_ < kShortTurn && !ill_conditioned(stages, last_)) {  // what is left of the error is round-off
    limit_ = std::max(limit_, kNoiseOfSteps / (stages.indicator() * relative_));
    if (error <= limit_) return h;
  }
  if (error < best_.error && !ill_conditioned(stages, last_)) best_ = {h, error};
  if (++shifts_ < kShifts) return kShift * h;
  if (best_.h == 0) return unplaced_;  // wherever it ends it is ill-conditioned: that is no place to avoid
  limit_ = kCross;
  return best_.h;
}

// The indicator falls as the square of the distance: its root is found along the last two nodes.
void SingularPassage::finish_step(const Stages& stages, StepReport& report) {
  if (!active_) return;
  begun_ = true;
  // Plain stages shorten the steps towards a singular position; on the constraints they may be as long as before.
  if (on_ == StagesOn::plain) longest_plain_ = std::max(longest_plain_, report.h);
  if (entered_ && report.h < kShrunk * longest_plain_) report.h_next = longest_plain_;
  if (report.rejected == 0) report.h_next = std::max(report.h_next, unplaced_);
  if (report.error > 1) report.h_next = std::max(report.h_next, report.h);  // shorter ones have as much round-off
  // It ends where accelerations are uncertain: the next step is to lead out of there, as a first one would.
  if (on_ == StagesOn::manifold && rate_of_turn_ > 0 && ill_conditioned(stages, last_))
    report.h_next = std::max(report.h_next, kFirstTurn / rate_of_turn_);
  const double* c = stages.tableau().c;
  const double s0 = std::sqrt(stages.conditioning(inner_).detector),
               s1 = std::sqrt(stages.conditioning(last_).detector);
  const bool falls = s1 < s0 && std::isfinite(s0);
  ahead_ = falls ? report.h * (c[last_] - c[inner_]) * s1 / (s0 - s1) : HUGE_VAL;
  const double now = stages.indicator();
  near_ = when_ == StagesWhen::automatic && now < (on_ == StagesOn::manifold ? kRegular : 1.0) * below_;
  below_ = std::max(below_, near_singular_below(now));
}

double SingularPassage::first_step(Dynamics& dynamics, const State& y, Stages& stages, double guess, double largest) {
  if (!active()) return guess;
  on_ = StagesOn::manifold;
  from_both_sides_ = false;
  first_stage(dynamics, y, stages);
  return from_both_sides_ ? std::min(largest, std::max(guess, time_to_turn(kFirstTurn))) : guess;
}

bool SingularPassage::near(const Stages& stages) const { return stages.indicator() < below_; }

// Accelerations are uncertain where the rows could not be met, and by round-off divided by the indicator. Where that has
// not fallen, no position is near: in large mechanisms round-off leaves more of the rows than their tolerance everywhere,
// and beside slender rods all indicators are small.
bool SingularPassage::ill_conditioned(const Stages& stages, int stage) const {
  const Conditioning& c = stages.conditioning(stage);
  const bool faded = c.detector < below_;
  const double most = faded ? std::max(kRowTolerance, kBothSides * std::sqrt(c.detector)) : kUnmet;
  const double share = std::min(1.0, kShareOfNear * below_ / kNowhere);  // if bodies differ much in inertia
  return c.residual > most || c.detector < kNowhere * share || (faded && c.detector * relative_ < kRoundOff * share);
}

}  // namespace lockstep
