// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/simulate/start_positions.h"
#include "framework/foundation/support/finding_kinds.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/dynamics/evaluate/projection_rule.h"
#include "framework/dynamics/evaluate/speed_of.h"
#include "framework/dynamics/integrate/culprit.h"
#include "framework/dynamics/simulate/consistency.h"
#include "framework/dynamics/simulate/line_search.h"
#include "framework/dynamics/simulate/start_rows.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {
namespace {

constexpr double kWayTurn = 0.25 * kPi;  // rad: of a body, from one pose of a way to the next

// ------------------------------------------------------------------------------------------------------ counted angles

double expected(const CountedAngle& angle, const State& state) {
  return angle.expected({state.s.data(), static_cast<std::size_t>(state.s.size())});
}

/// Whether all counted angles are as System::start() left them.
bool turns_begin(const System& system, const State& state) {
  if (system.counted_angles().empty()) return true;
  const State home = system.start();
  return std::ranges::all_of(system.counted_angles(),
                             [&](const auto& angle) { return expected(*angle, state) == expected(*angle, home); });
}

/// Takes the branches nearest to those of another state, or, of angles on which no rows depend, within half a
/// revolution of zero.
void count(Dynamics& dynamics, State& state, const State& from, bool from_zero) {
  const auto& angles = dynamics.system().counted_angles();
  if (angles.empty()) return;
  const Inputs& in = dynamics.inputs(state);
  for (const auto& angle : angles)
    named(*angle, in.t,
          [&] { angle->set(in, from_zero && !angle->coupled() ? 0.0 : expected(*angle, from), state.s); });
}

const CountedAngle* angle_of(const System& system, const StartTarget& target) {
  const auto [p, s] = target.link->pairs().front();
  return target.turns() ? system.counted(*p, *s, axis_index(target.axis) % 3) : nullptr;
}

// --------------------------------------------------------------------------------------- Gauss-Newton with line search

/// (8.2) x += d, q <- normalise(q + (1/2) q dth).
void cayley_move(State& state, double share, const VecX& d) {
  for (int k = 0; 6 * k < d.size(); ++k) {
    state.q.segment<3>(7 * k) += share * d.segment<3>(6 * k);
    const Quat q = Quat::from(state.q.segment<4>(7 * k + 3)) * cayley(share * d.segment<3>(6 * k + 3));
    state.q.segment<4>(7 * k + 3) = q.coefficients();
  }
}

/// Between two states, rad.
double largest_turn(const State& a, const State& b) {
  double most = 0;
  for (int k = 0; 7 * k < a.q.size(); ++k)
    most =
        std::max(most, rotation_vector(conjugate(normalized(a.slot_pose(k).q)) * normalized(b.slot_pose(k).q)).norm());
  return most;
}

struct Approach {
  bool met = false;
  int rounds = 0;
  double off = 0;  // m
};

/// Gauss-Newton steps onto rows, to `goal`, m, or within the tolerance of projections to their rounding. Counted
/// angles follow.
Approach approach(Dynamics& dynamics, StartRows& rows, State& state, double goal, int most) {
  constexpr double kFalls = 0.9;
  constexpr int kStalls = 5;  // in a row
  Approach at{.off = rows.look(state)};
  for (int stalls = 0; at.off > goal; ++at.rounds) {
    if (at.rounds >= most || !std::isfinite(at.off) || stalls > kStalls) return at;
    const State from = state;
    const double before = at.off;
    const VecX d = rows.step();
    search_line(state, [&](double share) {
      cayley_move(state, share, d);
      at.off = rows.look(state);
      return at.off < before || share == kLeastShare;  // a little uphill often leaves a local minimum
    });
    count(dynamics, state, from, false);
    stalls = at.off < kFalls * before ? 0 : stalls + 1;
    if (stalls == 0 || before > dynamics.options().stabilization.tolerance) continue;
    if (!(at.off < before)) state = from, at.off = rows.look(state);
    break;
  }
  at.met = std::isfinite(at.off);
  return at;
}

double goal_of(const System& system, const State& state, double tolerance) {
  double x_max = 0;
  for (int k = 0; 7 * k < state.q.size(); ++k)
    x_max = std::max(x_max, state.q.segment<3>(7 * k).lpNorm<Eigen::Infinity>());
  return std::max(tolerance, position_rounding(system.length(), x_max));
}

// ----------------------------------------------------------------------------------------------------------- positions

class StartSearch {
 public:
  StartSearch(Dynamics& dynamics, State& state, const AssemblyOptions& options, AssemblyReport& report)
      : dynamics_(dynamics),
        system_(dynamics.system()),
        state_(state),
        options_(options),
        report_(report),
        links_(dynamics),
        goal_(goal_of(system_, state, options.tolerance)),
        targets_(targets_of(system_, state, options)),
        begins_(turns_begin(system_, state)),
        whole_(std::ranges::any_of(system_.counted_angles(), [](const auto& angle) { return angle->coupled(); })) {
    given_ = state;
    count(dynamics, given_, given_, begins_);
    for (StartTarget& target : targets_) take_value(target);
    state_.s = given_.s;
  }

  void positions() {
    if (options_.coordinates.empty() && options_.poses.empty()) {
      alone();
    } else {
      nearest();
      if (const std::string why = onto_links(); !why.empty()) throw AssemblyError(why);
    }
    report_.after = distance();
    count_turns();
  }

  /// Counts the revolutions of the way from the given poses to this state, by all that is requested.
  void count_turns() {
    if (system_.counted_angles().empty()) return;
    if (counted_ || !begins_) return count(dynamics_, state_, state_, false);
    for (StartTarget& target : targets_) target.asked = target.value(dynamics_, state_, target.asked);
    const int made = report_.iterations;
    State way = given_;
    const bool open = asks() && lead(way, true);
    report_.iterations = made;
    count(dynamics_, state_, open ? way : state_, !open);
    for (const StartTarget& target : targets_) {
      const CountedAngle* angle = angle_of(system_, target);
      if (!open && is_beyond(target))
        warn(target, "the way from the given poses is blocked, or longer than 10000 revolutions; give other poses");
      else if (angle != nullptr)
        angle->set(dynamics_.inputs(state_), target.asked, state_.s);
    }
  }

 private:
  double distance() {
    links_.look(state_);
    return start_distance(links_.evaluation(), links_.residuals());
  }

  /// The value of a target in the given poses, and the value that is requested.
  void take_value(StartTarget& target) {
    const CountedAngle* angle = angle_of(system_, target);
    target.now = target.value(dynamics_, given_, angle != nullptr ? expected(*angle, given_) : 0);
    if (begins_ && !is_beyond(target) &&
        std::abs(target.value(dynamics_, given_, target.asked) - target.asked) <= goal_) {
      target.now = target.asked;  // half a revolution has two values
      if (angle != nullptr) angle->set(dynamics_.inputs(given_), target.asked, given_.s);
    }
    target.near = target.turns() ? nearest_branch(target.asked, target.now) : target.asked;
    const Jointed* joint = target.link->jointed();  // P rotates about one axis of S, if it has turns
    const bool has_turns = joint != nullptr && includes(joint->rows() | row_of(target.axis), Mask::e123);
    if (!has_turns && is_beyond(target))
      warn(
          target,
          "P also rotates about other axes of S, so revolutions about one are undefined; give an angle within 180 deg");
    if (!has_turns || (!begins_ && angle == nullptr)) target.asked = target.near;
  }

  bool is_beyond(const StartTarget& target) const { return target.turns() && std::abs(target.asked) > kPi + goal_; }

  void warn(const StartTarget& target, const char* why) {
    const double taken = degrees(nearest_branch(target.asked, 0));
    report_.findings.push_back({&finding::start_missed, target.who(),
                                fmt::format("{}: {:.9g} deg is requested, but counted angles start at {:.9g} deg: {}",
                                            target.who(), degrees(target.asked), taken, why),
                                "", taken, degrees(target.asked), "deg"});
  }

  /// Whether a target is elsewhere than in the given poses.
  bool asks() const {
    return std::ranges::any_of(targets_, [&](const StartTarget& t) { return std::abs(t.asked - t.now) > goal_; });
  }

  /// Gauss-Newton onto rows, with what it took added to the report.
  Approach bring(StartRows& rows, State& state) {
    const Approach at = approach(dynamics_, rows, state, goal_, options_.iterations);
    report_.iterations += at.rounds;
    return at;
  }

  /// Onto all rows. Returns why it failed, or "".
  std::string onto_links() {
    links_.look(state_);
    check_gradients(links_.evaluation());
    const Approach at = bring(links_, state_);
    if (at.met) return "";
    return "assembly stopped after " + std::to_string(at.rounds) + " iterations: constraint errors of up to " +
           text::brief(at.off) +
           " m remain, worst: " + worst_rows(links_.evaluation(), row_sizes(links_.evaluation(), links_.residuals())) +
           "; check the positions and axes of these joints, and the poses of their bodies";
  }

  /// Without weights and coordinates. The rows first, unless they count revolutions.
  void alone() {
    if (whole_ && asks() && lead_there() && onto_links().empty()) return;
    state_ = given_, counted_ = false;
    const std::string why = onto_links();
    if (why.empty()) return;
    state_ = given_;
    if (targets_.empty() || !lead_there() || !onto_links().empty()) throw AssemblyError(why + farthest_drive());
  }

  /// Leads a state along the ways of the targets, in shares that rotate no body by more than an eighth of a revolution;
  /// `whole`: by all revolutions that are requested. Returns whether it arrived.
  bool lead(State& state, bool whole) try {
    constexpr double kLeastPart = 1 / 8e4;  // of a way: an eighth of a revolution of 10000
    if (state.v.size() > TargetRows::kMostUnknowns) return false;
    std::vector<StartTarget> targets = targets_;
    TargetRows rows(dynamics_, given_, options_, targets);
    const TargetRows::Held held = whole ? TargetRows::Held::all : TargetRows::Held::exact;
    State trial = state;
    const auto ask = [&](double share) {
      for (StartTarget& to : targets) to.led = to.now + share * ((whole ? to.asked : to.near) - to.now);
    };
    const auto arrives = [&](TargetRows::Held holds) {
      trial = state;
      rows.hold(holds);
      return bring(rows, trial).met;
    };
    const auto arrive = [&] {
      count(dynamics_, trial, state, false);
      state = trial;
      for (StartTarget& to : targets) to.now = to.value(dynamics_, state, to.now);
    };
    ask(0);
    if (!arrives(held) && !arrives(TargetRows::Held::none)) return false;
    arrive();
    if (begins_) count(dynamics_, state, state, true);
    rows.hold(held);
    for (double share = 0; share < 1; arrive()) {
      ask(1);
      if (rows.look(state) <= goal_) return true;
      share = std::min(1.0, kWayTurn / fastest_turn(rows.step()));
      for (;; share *= 0.25) {
        if (share < kLeastPart) return false;
        ask(share);
        if (arrives(held) && largest_turn(state, trial) <= 2 * kWayTurn) break;
      }
    }
    return true;
  } catch (const NonFiniteError&) {
    return false;
  }

  /// Leads the state. Its revolutions are counted then, unless more are requested. Returns whether it arrived.
  bool lead_there() {
    const bool arrived = lead(state_, whole_);
    counted_ =
        arrived && (whole_ || std::ranges::all_of(targets_, [](const StartTarget& t) { return t.asked == t.near; }));
    return arrived;
  }

  /// Along what links and exact targets leave free, to where the cost is least.
  void nearest() {
    std::vector<StartTarget> targets = targets_;
    TargetRows rows(dynamics_, given_, options_, targets);
    if (!lead_there()) state_ = given_;
    for (StartTarget& target : targets) {
      target.led = whole_ ? target.asked : target.near;
      target.now = target.value(dynamics_, state_, target.led);
    }
    if (const Approach at = bring(rows, state_); !at.met) throw AssemblyError(rows.missed(at.rounds));
    for (int round = 0; round < options_.iterations; ++round) {
      const double cost = rows.cost();
      VecX d = rows.downhill();
      if (cost == 0 || d.size() == 0 || d.lpNorm<Eigen::Infinity>() <= goal_) return;
      d *= std::min(1.0, kWayTurn / std::max(kWayTurn, fastest_turn(d)));
      const auto falls = [&](double share) {
        cayley_move(state_, share, d);
        count(dynamics_, state_, state_, false);
        return bring(rows, state_).met && rows.cost() < cost;
      };
      if (!search_line(state_, falls)) return;
    }
  }

  /// The drive about an axis that begins farthest from the given poses, more than 90 deg, in words.
  std::string farthest_drive() const {
    const StartTarget* farthest = nullptr;
    double most = 2 * kWayTurn;  // rad, or lengths of the system
    for (const StartTarget& target : targets_)
      if (const double way = std::abs(target.near - target.now) / (target.turns() ? 1 : system_.length());
          target.drive >= 0 && way > most)
        most = way, farthest = &target;
    if (farthest == nullptr) return "";
    const double unit = farthest->turns() ? degrees(1) : 1;
    return fmt::format(
        " ({} begins at {:.6g} {}, {:.6g} {} from the given poses: place its bodies there, or let it "
        "begin nearer)",
        farthest->who(), unit * farthest->asked, farthest->turns() ? "deg" : "m",
        unit * std::abs(farthest->near - farthest->now), farthest->turns() ? "deg" : "m");
  }

  Dynamics& dynamics_;
  const System& system_;
  State& state_;
  State given_;
  const AssemblyOptions& options_;
  AssemblyReport& report_;
  LinkRows links_;
  double goal_;
  std::vector<StartTarget> targets_;
  bool begins_;           // counts are those of System::start()
  bool whole_;            // rows count revolutions: positions depend on all that are requested
  bool counted_ = false;  // the way to the state was counted
};

}  // namespace

void find_positions(Dynamics& dynamics, State& state, const AssemblyOptions& options, AssemblyReport& report) {
  dynamics.normalize(state);
  StartSearch(dynamics, state, options, report).positions();
}

bool approach_links(Dynamics& dynamics, State& state, double goal) {
  LinkRows rows(dynamics);
  return approach(dynamics, rows, state, goal, AssemblyOptions{}.iterations).met;
}

void begin_turns(Dynamics& dynamics, State& state) {
  if (dynamics.system().counted_angles().empty() || !turns_begin(dynamics.system(), state)) return;
  AssemblyReport report;
  StartSearch(dynamics, state, {}, report).count_turns();
  for (const Finding& f : report.findings) report_finding(f);
}

void count_from(Dynamics& dynamics, State& state) {
  count(dynamics, state, state, turns_begin(dynamics.system(), state));
}

}  // namespace lockstep
