#include <lockstep/stepping.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include "framework/dynamics/integrate/speed_of.h"
#include "framework/dynamics/solvers/graph.h"
#include "framework/dynamics/solvers/stop_rule.h"

namespace lockstep {

namespace {

constexpr double kTurn = 0.5;        // rad per step, with the stages on the constraints
constexpr double kFirstTurn = 0.1;   // rad: a first step that leads out of a singular position
constexpr double kSingular = 1e-2;   // indicator below which the stages go onto the constraints: this,
constexpr double kUnusual = 0.1;     // or this part of the usual one, if that is less;
constexpr double kRegular = 3;       // and times which they leave them again
constexpr double kKnown = 0.5;       // rad: turn after which the largest indicator counts as the usual one
constexpr double kNowhere = 1e-7;    // indicator below which it only reflects the proximal term
constexpr double kRedundant = 1e-6;  // pivot of a row that others make redundant
constexpr double kFell = 1e-2;       // part of the indicator that is left when a row was no usual redundant one
constexpr double kBothSides = 1e-9;  // relative accuracy of rates from both sides
constexpr double kShortTurn = 1e-3;  // rad: in a step that turns less, errors near a singular position are round-off's,
constexpr double kNoiseOfSteps = 3e-12;  // if they are within this, relative, over the indicator
constexpr double kUnmet = 1e-6;      // residual of rows that could not be met, where no position is near
constexpr double kContradictRows = 1e-8;  // residual of rows that contradict one another
constexpr double kOff = 0.3;          // rad: turn that leads far enough off the constraints to see whether it stays so
constexpr double kRoundOff = 1e-17;  // relative round-off of the accelerations times the indicator
constexpr double kUsualSpread = 1e4;  // of masses; where bodies differ more, small pivots may be due to them
constexpr double kShrunk = 0.3;      // of the longest plain step
constexpr double kShift = 0.93;      // a step that avoids an ill-conditioned end,
constexpr int kShifts = 12;          // attempted this many times; then the best of them is taken,
constexpr double kCross = 100;       // with an error up to this
constexpr double kLeast = 0.1;       // of the step: one that only leads to where the next should begin

// The part of the pivots' smallness that differences of mass may explain.
double spread_of_masses(const System& system) {
  double lightest = HUGE_VAL, heaviest = 0;
  for (int k = 0; k < system.n_slots(); ++k) {
    lightest = std::min(lightest, system.slot(k).mass);
    heaviest = std::max(heaviest, system.slot(k).mass);
  }
  return std::min(1.0, kUsualSpread * lightest / heaviest);
}

// Whether the links leave nothing free: then there is one motion, however many rows are redundant. Loads in all directions
// of the slots, which would give accelerations of 1 m/s^2, move nothing.
bool held(Dynamics& dynamics, const State& y) {
  constexpr double kMoves = 1e-6;
  const System& system = dynamics.system();
  const Evaluation& e = dynamics.gather(y);
  Factor factor = dynamics.new_factor();
  factor.compute(e);
  VecX f = VecX::Zero(6 * system.n_slots()), a, lambda;
  for (int k = 0; k < system.n_slots(); ++k) {
    const Slot& slot = system.slot(k);
    const double turn = 0.7 * k;
    const Vec3 along(1, std::cos(1 + turn), std::sin(2 + turn));
    f.segment<3>(6 * k) = slot.mass * along;
    if (slot.freedoms != Freedoms::particle) f.segment<3>(6 * k + 3) = slot.J * along.reverse() / system.length();
  }
  factor.solve(e, f, VecX::Zero(e.rows().n_rows), a, lambda);
  for (int k = 0; k < system.n_slots(); ++k) {
    const double moved = a.segment<3>(6 * k).norm() + system.length() * a.segment<3>(6 * k + 3).norm();
    if (!(moved < kMoves)) return false;
  }
  return true;
}

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

namespace {

// Beside a position the rows of closures learn which of their small pivots are usual: as SingularRate does it for all
// rows. At rest it leads where the accelerations do. slots: y, in the bodies' own coordinates.
void learn_beside(Dynamics& dynamics, const State& y, const State& slots) try {
  constexpr double kBeside = 3e-2;  // rad
  const double L = dynamics.system().length(), speed = speed_of(slots.v, L);
  State off = y;
  StateRate rate = sized_like(slots), own = sized_like(y);
  if (speed > 0) {
    dynamics.advance(off, kBeside / speed, y.v), off.t += kBeside / speed;
  } else {
    dynamics.rates(slots, rate), dynamics.read_rates(y, rate, own);
    const double most = std::max(own.largest_a / L, own.largest_alpha);
    if (!(most > 0)) return;
    dynamics.advance(off, kBeside / most, own.v);
  }
  if (dynamics.project(off, 0).converged) dynamics.rates_with_report(off, own);
} catch (const Error&) {  // what cannot be evaluated there teaches nothing
}

}  // namespace

// Rates from both sides are found with the bodies' own coordinates.
bool SingularPassage::find_both_sides(Dynamics& dynamics, const State& y) {
  if (!y.coordinates) return both_sides_.find(dynamics, y, rate_);
  State slots = y;
  dynamics.to_slots(slots);
  both_sides_.begin(slots);
  StateRate rate = sized_like(slots);
  const bool found = both_sides_.find(dynamics, slots, rate);
  if (found) dynamics.read_rates(y, rate, rate_);
  learn_beside(dynamics, y, slots);
  both_sides_ = SingularRate();  // nothing stays of a look at the slots
  return found;
}

double NearSingular::limit() const { return std::min(kSingular, turned_ > kKnown ? kUnusual * largest_ : HUGE_VAL); }

double NearSingular::limit_from(double now) const { return std::min(kSingular, kUnusual * std::max(largest_, now)); }

void NearSingular::add(double indicator, double angle) {
  largest_ = std::max(largest_, std::min(indicator, 1.0));
  turned_ += angle;
}

void SingularPassage::begin(const Tableau& tableau, const State& state, const Dynamics& dynamics) {
  const bool projects = dynamics.options().stabilization.kind == Stabilization::Kind::project;
  const bool has_rows = !state.coordinates || state.coordinates->has_rows();
  active_ = has_rows && (when_ == StagesWhen::manifold || (when_ == StagesWhen::automatic && projects &&
                                                           has_loops(dynamics.system(), state.modes)));
  spread_ = spread_of_masses(dynamics.system());
  usual_ = {};
  near_ = probed_ = entered_ = false;
  redundant_ = Redundant::unknown;
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
}

void SingularPassage::start_step() {
  const bool always = active_ && (when_ == StagesWhen::manifold || redundant_ == Redundant::on_constraints);
  on_ = always || near_ ? StagesOn::manifold : StagesOn::plain;
  shifts_ = 0, limit_ = 1, unplaced_ = 0, best_ = {0, kCross}, entered_ = false;
}

// A start in a singular position looks like one with redundant rows until both sides have been probed.
bool SingularPassage::first_stage(Dynamics& dynamics, const State& y, Stages& stages) {
  if (active()) rate_of_turn_ = fastest_turn(y);
  if (!stages.evaluate(dynamics, y, 0, 0, 1, on_)) return false;
  if (!active()) return true;
  const bool held_rows = dynamics.holds_rows(), had_probed = probed_;
  const Redundant had_known = redundant_;
  const bool done = look_around(dynamics, y, stages);
  // What was asked once does not keep the rows of all links.
  if (!held_rows && (probed_ != had_probed || redundant_ != had_known)) dynamics.forget_rows(y);
  return done;
}

// After the first stage was evaluated: what else its position says of it.
bool SingularPassage::look_around(Dynamics& dynamics, const State& y, Stages& stages) {
  // In a regular position: where rows are redundant on the constraints only, the stages are evaluated there.
  const auto stays_redundant = [&] {
    if (when_ != StagesWhen::automatic || redundant_ != Redundant::unknown || !(rate_of_turn_ > 0)) return true;
    redundant_ =
        stages.conditioning(0).pivot < kRedundant ? where_redundant(dynamics, y, stages.k(0)) : Redundant::everywhere;
    if (on_ == StagesOn::manifold || redundant_ != Redundant::on_constraints) return true;
    on_ = StagesOn::manifold;
    return stages.evaluate(dynamics, y, 0, 0, 1, on_);
  };
  const bool starts = !probed_ && stages.conditioning(0).pivot < kRedundant;
  probed_ = true;
  if (!starts && !ill_conditioned(stages, 0)) return stays_redundant();
  const bool found = find_both_sides(dynamics, y);
  if (starts && !stages.evaluate(dynamics, y, 0, 0, 1, on_)) return false;
  if (!ill_conditioned(stages, 0)) return stays_redundant();
  from_both_sides_ = found;
  if (found) {
    stages.put(0, rate_);
    limit_ = std::max(limit_, kBothSides / relative_);
  }
  if (!found && starts && !held(dynamics, y))
    throw StepError(
        fmt::format("{}: at t = {:.9g} s the links do not determine how the motion continues (smallest relative pivot "
                    "{:.2g}): it is a singular position, from which several motions continue or none, or rows nearly "
                    "depend on others; start slightly off it, with the intended velocity, take away a link that "
                    "repeats another (lockstep check names them), or take --solver dense",
                    method_, y.t, stages.conditioning(0).pivot),
        y.t);
  return true;
}

// Looks at the position, at one off the constraints, as the present rates lead there, and at the first again. Rows are
// redundant on the constraints only if off them they are independent (the indicator takes for redundant what was so in
// all positions before), or contradict one another. A factor of its own, since positions off the constraints are no usual
// ones. The time stays, since laws may end.
SingularPassage::Redundant SingularPassage::where_redundant(Dynamics& dynamics, const State& y,
                                                            const StateRate& rate) const {
  Factor factor = dynamics.new_factor();
  VecX asked, a, lambda;
  const auto look_at = [&](const State& at) {
    const Evaluation& e = dynamics.gather(at);
    asked.resize(e.rows().n_rows);
    for (const RowEntry& entry : e.rows().entries)
      for (int k = 0; k < entry.m; ++k) asked[entry.first_row + k] = e.rows().block(entry).Qhat(k);
    factor.compute(e);
    SolveReport report = factor.solve_motion(e, e.force(), asked, a, lambda);
    factor.complete(report);
    return report;
  };
  State off = y;
  off.q += kOff / rate_of_turn_ * rate.q;
  dynamics.normalize(off);
  try {
    const SolveReport before = look_at(y), away = look_at(off), after = look_at(y);
    const bool independent = after.detector < kRedundant && after.detector < kFell * before.detector;
    const bool contradictory = (away.residual > kContradictRows && before.residual < kFell * kContradictRows) ||
                               (away.corrections > kMaxCorrections && before.corrections <= kMaxCorrections);
    return independent || contradictory ? Redundant::on_constraints : Redundant::everywhere;
  } catch (const Error&) {  // what cannot be evaluated off the constraints answers nothing
    return Redundant::everywhere;
  }
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
  near_ = when_ == StagesWhen::automatic && now < (on_ == StagesOn::manifold ? kRegular : 1.0) * usual_.limit();
  usual_.add(now, report.h * rate_of_turn_);
}

double SingularPassage::first_step(Dynamics& dynamics, const State& y, Stages& stages, double guess, double largest) {
  if (!active()) return guess;
  on_ = StagesOn::manifold;
  from_both_sides_ = false;
  first_stage(dynamics, y, stages);
  return from_both_sides_ ? std::min(largest, std::max(guess, time_to_turn(kFirstTurn))) : guess;
}

bool SingularPassage::near(const Stages& stages) const { return stages.indicator() < usual_.limit(); }

// Accelerations are uncertain where the rows could not be met, and by round-off divided by the indicator. Where that has
// not fallen, no position is near: in large mechanisms round-off leaves more of the rows than their tolerance everywhere,
// and beside slender rods all indicators are small.
bool SingularPassage::ill_conditioned(const Stages& stages, int stage) const {
  const Conditioning& c = stages.conditioning(stage);
  const bool faded = c.detector < usual_.limit_from(c.detector);
  const double most = faded ? std::max(kRowTolerance, kBothSides * std::sqrt(c.detector)) : kUnmet;
  return c.residual > most || c.detector < kNowhere * spread_ ||
         (faded && c.detector * relative_ < kRoundOff * spread_);
}

}  // namespace lockstep
