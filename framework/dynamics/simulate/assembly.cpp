// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/assembly.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include <lockstep/error.h>
#include <lockstep/log.h>
#include <lockstep/step_loop.h>
#include <lockstep/text.h>
#include "framework/dynamics/simulate/consistency.h"
#include "framework/dynamics/simulate/start_positions.h"
#include "framework/dynamics/simulate/start_rows.h"
#include "framework/dynamics/tree/slender_bodies.h"
#include "framework/foundation/math/decompositions.h"
#include "framework/foundation/math/limits.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {
namespace {

constexpr double kMuch = 0.1;     // of the start's energy: more is hardly meant
constexpr double kLittle = 1e-3;  // of the length, rotations times it, of speeds or energies: less is not reported

// The limit of a run for its start, m, m/s.
double start_limit() { return StepLoopOptions{}.start_limit; }

// Projects first, then corrects along the free motions only: W = M^-1-orthogonal responses to each target's row. Again
// while that leaves less than half. Targets may depend on each other: any impulse that gives their rates will do, since
// all give the same motion.
void meet(Dynamics& dynamics, State& state, const std::vector<VelocityTarget>& targets) {
  dynamics.project_velocity(state);
  const auto m = static_cast<Eigen::Index>(targets.size());
  MatX rows(m, state.v.size()), response(state.v.size(), m);
  VecX gap(m), a, lambda;
  for (double before = std::numeric_limits<double>::infinity();;) {
    double largest = 0;
    for (Eigen::Index i = 0; i < m; ++i) {
      const VelocityTarget& target = targets[i];
      const Lock& link = paired_link(dynamics.system(), target.link, target.axis);
      const CoordinateRow at = coordinate_row(dynamics, state, link, target.axis);
      rows.row(i) = at.of_rate.transpose();
      gap[i] = target.value - at.rate, largest = std::max(largest, std::abs(target.value));
    }
    const double left = gap.lpNorm<Eigen::Infinity>();
    if (left <= 4 * std::numeric_limits<double>::epsilon() * largest) return;
    if (!(left < before / 2)) {
      if (left <= start_limit() * std::max(1.0, largest)) return;
      std::vector<std::string> names;
      for (const VelocityTarget& t : targets) names.push_back(t.link + "." + std::string(to_string(t.axis)));
      throw AssemblyError(
          "start velocity: " + text::join(names) + (targets.size() > 1 ? " are incompatible" : " is impossible") +
          ": the joints do not allow this motion; give fewer coordinates, or one that is free (lockstep "
          "check lists free motions and nearly redundant joints)");
    }
    before = left;
    const Evaluation& e = dynamics.gather_rows(state);
    const VecX none = VecX::Zero(e.rows().n_rows);
    Factor& factor = dynamics.factor(e);
    for (Eigen::Index i = 0; i < m; ++i) {
      factor.solve(e, rows.row(i).transpose(), none, a, lambda);
      response.col(i) = a;
    }
    state.v += response * least_norm(rows.lazyProduct(response), gap);
    dynamics.project_velocity(state);
  }
}

/// M dv + Jh^T mu = 0 with Jh v = -Ct and T v = targets: the targets' rows are added to the mechanism's own.
void assemble_velocities(Dynamics& dynamics, State& state, const std::vector<VelocityTarget>& targets,
                         AssemblyReport& report) {
  report.before_v = dynamics.violation_v(state);
  if (targets.empty())
    dynamics.project_velocity(state);
  else
    meet(dynamics, state, targets);
  report.after_v = dynamics.violation_v(state);
  check_velocities(dynamics, state, report.after_v, start_limit(), "assembly",
                   "start away from the limit position, or ");
}

double kinetic_energy(Dynamics& dynamics, const State& state) {
  const Inputs& in = dynamics.inputs(state);
  double twice = 0;
  for (int k = 0; k < dynamics.system().n_slots(); ++k) {
    const Slot& b = dynamics.system().slot(k);
    twice += b.mass * in.slot(k).v.squaredNorm() + in.slot(k).w.dot(b.J * in.slot(k).w);
  }
  return 0.5 * twice;
}

// Bodies that have a velocity now, by what was not given of it: "no start velocity is given for 'coupler', 'rocker'; ...";
// "" if all are given.
std::string not_given(const System& system, const State& given, const State& assembled) {
  const double L = system.length(),
               rounding = kLittle * std::max(given.v.lpNorm<Eigen::Infinity>(), assembled.v.lpNorm<Eigen::Infinity>());
  std::vector<std::string> all, velocity, omega;
  for (int k = 0; k < system.n_slots(); ++k) {
    const Body& body = system.body_of_slot(k);
    const Twist asked = body_twist(body, given), has = body_twist(body, assembled);
    const double v = asked.v.norm(), w = L * asked.w.norm();
    const bool moves = has.v.norm() > rounding, turns = has.w.norm() > rounding;
    const std::string name = "'" + body.name + "'";
    if (v == 0 && w == 0) {
      if (moves || turns) all.push_back(name);
    } else if (v <= kLittle * w) {
      if (moves) velocity.push_back(name);
    } else if (w <= kLittle * v && turns) {
      omega.push_back(name);
    }
  }
  std::string words;
  const auto add = [&](const char* what, std::vector<std::string> names) {
    constexpr std::size_t kMost = 5;
    if (names.empty()) return;
    if (names.size() > kMost) names.resize(kMost), names.emplace_back("...");
    words += (words.empty() ? "" : "; ") + std::string(what) + text::join(names);
  };
  add("no start velocity is given for ", all);
  add("an angular velocity but no \"velocity\" of the frame's origin is given for ", velocity);
  add("a \"velocity\" but no angular velocity (\"omega_world\") is given for ", omega);
  return words;
}

// Of the bodies that count.
template <class Counts>
void measure_move(const System& system, const State& from, const State& to, AssemblyReport& report, Counts&& counts) {
  for (int k = 0; k < system.n_slots(); ++k) {
    if (!counts(system.body_of_slot(k).name)) continue;
    const Pose a = from.slot_pose(k), b = to.slot_pose(k);
    const double move = (b.x - a.x).norm(), turn = rotation_vector(conjugate(normalized(a.q)) * b.q).norm();
    if (move > report.largest_move) report.largest_move = move, report.moved_most = system.body_of_slot(k).name;
    if (turn > report.largest_turn) report.largest_turn = turn, report.turned_most = system.body_of_slot(k).name;
  }
}

// Changes by assembly that are too large to be meant.
void add_warnings(const System& system, const State& given, const State& assembled, const AssemblyOptions& options,
                  AssemblyReport& report) {
  // Poses do not count if coordinates are requested, nor that of a body that may go anywhere.
  const auto meant = [&](const std::string& body) {
    return options.coordinates.empty() &&
           std::ranges::none_of(options.poses, [&](const PoseWeight& w) { return w.body == body && w.weight == 0; });
  };
  AssemblyReport of;
  measure_move(system, given, assembled, of, meant);
  const bool moved = of.largest_move > kLittle * system.length(), turned = of.largest_turn > kLittle;
  if ((moved || turned) && !report.open.empty()) {
    const bool one = report.open.size() == 1;
    std::vector<std::string> changes;
    if (moved) changes.push_back(fmt::format("moved '{}' by {:.3g} m", of.moved_most, of.largest_move));
    if (turned) changes.push_back(fmt::format("rotated '{}' by {:.3g} rad", of.turned_most, of.largest_turn));
    report.findings.push_back(
        {&finding::start_moved, "body '" + (moved ? of.moved_most : of.turned_most) + "'",
         fmt::format("the given poses {}: assembly {}",
                     one ? fmt::format("violate joint '{}' by {:.3g} m", report.open[0].joint, report.open[0].gap)
                         : "do not fit the joints",
                     text::join(changes)),
         one ? "check where the joint is attached to its two bodies, in world axes, or their poses"
             : "check where the joints are attached, in world axes, and the poses; lockstep assemble prints those it "
               "finds",
         moved ? of.largest_move : of.largest_turn, kLittle * (moved ? system.length() : 1), moved ? "m" : "rad"});
  }
  const double lost = report.kinetic_before - report.kinetic_after;
  if (!(lost > kMuch * report.kinetic_before)) return;
  const std::string missing = not_given(system, given, assembled);
  report.findings.push_back(
      {&finding::start_speed_lost, "",
       fmt::format(
           "assembly removed {:.3g} J of the {:.3g} J of the start velocities, which the joints do not allow: {}", lost,
           report.kinetic_before, missing.empty() ? "no free motion has this direction" : missing),
       missing.empty() ? "lockstep check --verbose lists the free motions"
                       : "give compatible ones, or one start speed of a joint (\"start\")",
       lost, kMuch * report.kinetic_before, "J"});
}

// Start velocities that are stated and begin otherwise: of bodies, which joints, drives and other velocities change, and of
// joints.
void add_changed(Dynamics& dynamics, const State& given, const State& assembled,
                 const std::vector<VelocityTarget>& targets, const AssemblyOptions& options, AssemblyReport& report) {
  const System& system = dynamics.system();
  const auto tell = [&](const Thing& of, const std::string& what, const VecX& stated, const VecX& begins,
                        const char* unit) {
    const double off = (begins - stated).norm(), limit = kNegligible * std::max(1.0, stated.norm());
    if (!(off > limit)) return;
    const auto text = [](const VecX& v) { return fmt::format("{:.10g}", fmt::join(v.begin(), v.end(), ", ")); };
    report.findings.push_back({&finding::start_changed, of.words(),
                               fmt::format("{}, {}: it begins at {} {}, not at the stated {} {}", of.words(), what,
                                           text(begins), unit, text(stated), unit),
                               "state velocities that fit each other, or leave out those that follow from others", off,
                               limit, unit});
  };
  for (const StatedVelocity& stated : options.stated) {
    const Body& body = system.body(stated.body);
    const Thing thing{.kind = "body", .name = body.name};
    if (stated.velocity) tell(thing, "velocity", body_twist(body, given).v, body_twist(body, assembled).v, "m/s");
    const auto w = [&](const State& s) {
      return Vec3(stated.in_world ? rotation(body_pose(body, s).q) * body_twist(body, s).w : body_twist(body, s).w);
    };
    if (stated.omega) tell(thing, stated.in_world ? "omega_world" : "omega_body", w(given), w(assembled), "rad/s");
  }
  for (const VelocityTarget& target : targets) {
    const Lock& link = paired_link(system, target.link, target.axis);
    const double rate = coordinate_row(dynamics, assembled, link, target.axis).rate;
    tell(thing_of(link), "velocity of " + std::string(to_string(target.axis)), VecX::Constant(1, target.value),
         VecX::Constant(1, rate), is_rotation(target.axis) ? "rad/s" : "m/s");
  }
}

// Coordinates requested by a weight that begin elsewhere: start poses and other coordinates count against them.
void add_missed(Dynamics& dynamics, const State& assembled, const AssemblyOptions& options, AssemblyReport& report) {
  for (const StartTarget& target : targets_of(dynamics.system(), assembled, options)) {
    if (target.exact()) continue;
    const bool turns = target.turns();
    const double off = target.value(dynamics, assembled, target.asked) - target.asked;
    if ((turns ? 1 : 1 / dynamics.system().length()) * std::abs(off) <= kLittle) continue;
    const auto shown = [&](double x) { return turns ? degrees(x) : x; };
    const char* const unit = turns ? "deg" : "m";
    report.findings.push_back({&finding::start_missed, "joint '" + target.link->name() + "'",
                               fmt::format("joint '{}': {} begins at {:.4g} {} instead of near {:.4g} {}, because of "
                                           "start poses of bodies or other coordinates",
                                           target.link->name(), to_string(target.axis), shown(target.asked + off), unit,
                                           shown(target.asked), unit),
                               "request it exactly (\"position\"), or free its body (\"assembled\": \"free\")",
                               shown(target.asked + off), shown(target.asked), unit});
  }
}

}  // namespace

LOCKSTEP_API bool AssemblyReport::is_moved() const { return std::max(largest_move, largest_turn) > start_limit(); }
LOCKSTEP_API bool AssemblyReport::is_notable() const {
  return is_moved() || std::max(before, before_v) > start_limit();
}

LOCKSTEP_API std::string AssemblyReport::text() const {
  std::string text;
  if (before > start_limit()) text += fmt::format("; the given poses violated the constraints by {:.2g} m", before);
  if (largest_move > start_limit()) text += fmt::format("; moved '{}' by {:.3g} m", moved_most, largest_move);
  if (largest_turn > start_limit()) text += fmt::format("; rotated '{}' by {:.3g} rad", turned_most, largest_turn);
  if (before_v > start_limit())
    text += kinetic_before == 0
                ? "; velocities follow from joints and drives"
                : fmt::format("; the given velocities violated the constraints by {:.2g} m/s", before_v);
  if (!is_moved()) text += "; positions unchanged";
  if (std::abs(kinetic_after - kinetic_before) > kLittle * std::max(kinetic_before, kinetic_after))
    text += fmt::format("; kinetic energy {:.3g} J, now {:.3g} J", kinetic_before, kinetic_after);
  return text.substr(2);
}

// No joint is open of a mechanism drawn in its zero position, which its drives take to where they begin.
DrawnStart drawn_start(Dynamics& dynamics, const State& given) {
  dynamics.system().check_size(given);
  const Evaluation& e = dynamics.gather_rows(given);
  const VecX all = Residuals(e).C;
  DrawnStart drawn{given, start_distance(e, all), {}};
  for (const RowEntry& entry : e.rows().entries) {
    const Lock& link = *dynamics.system().links()[entry.link];
    VecX C = VecX::Zero(all.size());
    for (int k = 0; k < entry.m; ++k)
      if (link.row(entry.own[k]).drive < 0) C[entry.first_row + k] = all[entry.first_row + k];
    if (const double by = e.norm(C); !(by < start_limit())) drawn.open.push_back({link.name(), by});
  }
  return drawn;
}

AssemblyReport assemble(Dynamics& dynamics, State& state, const std::vector<VelocityTarget>& targets,
                        const AssemblyOptions& options) {
  return assemble_drawn(dynamics, state, targets, options, drawn_start(dynamics, state));
}

AssemblyReport assemble_drawn(Dynamics& dynamics, State& state, const std::vector<VelocityTarget>& targets,
                              const AssemblyOptions& options, DrawnStart drawn) {
  AssemblyReport report;
  State work = state;
  report.before = drawn.before, report.open = std::move(drawn.open);
  find_positions(dynamics, work, options, report);
  report.kinetic_before = kinetic_energy(dynamics, work);
  assemble_velocities(dynamics, work, targets, report);
  report.kinetic_after = kinetic_energy(dynamics, work);
  measure_move(dynamics.system(), drawn.state, work, report, [](const std::string&) { return true; });
  add_warnings(dynamics.system(), drawn.state, work, options, report);
  add_changed(dynamics, drawn.state, work, targets, options, report);
  std::ranges::move(lost_inertias(dynamics.system()), std::back_inserter(report.findings));
  add_missed(dynamics, work, options, report);
  state = work;
  if (report.is_notable()) log_info(report.text());
  for (const Finding& f : report.findings) report_finding(f);
  return report;
}

}  // namespace lockstep
