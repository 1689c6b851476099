#include <lockstep/assembly.h>

#include <spdlog/fmt/fmt.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include <lockstep/log.h>
#include <lockstep/text.h>
#include "framework/dynamics/simulate/assembled_positions.h"
#include "framework/dynamics/simulate/consistency.h"
#include "framework/dynamics/simulate/coordinate_row.h"
#include "framework/dynamics/simulate/nearest_start.h"
#include "framework/dynamics/simulate/start_turns.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {
namespace {

/// (8.2) x += d, q <- normalise(q + (1/2) q dth).
void cayley_move(State& state, int n_slots, double share, const VecX& d) {
  for (int k = 0; k < n_slots; ++k) {
    state.q.segment<3>(7 * k) += share * d.segment<3>(6 * k);
    const Quat q = Quat::from(state.q.segment<4>(7 * k + 3)) * cayley(share * d.segment<3>(6 * k + 3));
    state.q.segment<4>(7 * k + 3) = q.coefficients();
  }
}

std::string worst_rows(const Evaluation& e, const VecX& C) {
  std::vector<int> order(static_cast<std::size_t>(C.size()));
  for (int i = 0; i < C.size(); ++i) order[static_cast<std::size_t>(i)] = i;
  std::sort(order.begin(), order.end(), [&](int a, int b) { return std::abs(C[a]) > std::abs(C[b]); });
  std::vector<std::string> words;
  for (std::size_t i = 0; i < order.size() && i < 3; ++i)
    words.push_back(e.system().row_name(e.rows(), order[i]) + " (" + text::brief(C[order[i]]) + ")");
  return text::join(words);
}

double round_off(const State& state, double length) {
  double x_max = 0;
  for (int k = 0; k + 7 <= state.q.size(); k += 7)
    x_max = std::max(x_max, state.q.segment<3>(k).lpNorm<Eigen::Infinity>());
  return 1e-14 * length + 8 * std::numeric_limits<double>::epsilon() * x_max;
}

constexpr int kMostShort = 400'000;      // iterations that short steps add
constexpr double kVelocityLimit = 1e-6;  // m/s, residual |Jh v + Ct|: more is a contradiction, not round-off

class Assembler {
 public:
  Assembler(Dynamics& dynamics, State& state, const AssemblyOptions& options)
      : dynamics_(dynamics), state_(state), options_(options), n_(dynamics.system().n_slots()) {}

  /// How far the state is off its links, m.
  double distance() {
    dynamics_.normalize(state_);
    residual();
    return start_distance(*now_, C_);
  }

  /// `follows`: what counts turns follows the iterations; `short_steps`: see short_share().
  void positions(AssemblyReport& report, bool follows, bool short_steps) {
    dynamics_.normalize(state_);
    const VecX zero = VecX::Zero(6 * n_);
    VecX d, lambda;
    double now = residual();
    check_gradients(*now_);
    const double goal = std::max(options_.tolerance, round_off(state_, dynamics_.system().length()));
    int stalls = 0;  // in a row
    int cut = 0;     // short steps, on the way there
    for (report.iterations = 0; now > goal; ++report.iterations) {
      if (report.iterations - cut >= options_.iterations || !std::isfinite(now)) stop(now, report.iterations);
      const VecX c = -C_;
      dynamics_.factor(*now_).solve(*now_, zero, c, d, lambda);
      const double whole = short_steps ? short_share(n_, d) : 1.0;
      const double next = move_along(d, whole, now);
      const bool on_the_way = whole < 1 && next < (1 - 0.1 * whole) * now && cut < kMostShort;
      if (on_the_way) ++cut;
      const bool stalled = !on_the_way && !(next < 0.9 * now);
      stalls = stalled ? stalls + 1 : 0;
      if (stalls > 5 && next > 1e3 * goal) stop(next, report.iterations + 1);
      if (stalled && next <= 1e3 * goal) break;  // at round-off
      now = next;
      if (follows) follow_turns(dynamics_, state_), now = residual();
    }
    residual();
    report.after = start_distance(*now_, C_);
  }

  /// M dv + Jh^T mu = 0 with Jh v = -Ct and T v = targets: the targets' rows are added to the mechanism's own.
  void velocities(const std::vector<VelocityTarget>& targets, AssemblyReport& report) {
    const VecX zero = VecX::Zero(6 * n_);
    report.before_v = dynamics_.violation_v(state_);
    if (targets.empty()) {
      dynamics_.project_velocity(state_);
    } else {
      meet(targets);
    }
    report.after_v = dynamics_.violation_v(state_);
    residual();
    if (!(report.after_v <= kVelocityLimit))
      throw AssemblyError("assembly left inconsistent velocities (constraint violation " + text::brief(report.after_v) +
                          " m/s); worst: " + worst_rows(*now_, Cd_) + ". Two laws may drive one coordinate" +
                          or_against_stops(dynamics_.system(), now_->rows()) +
                          ", or the position is a dead centre, where a driven "
                          "coordinate cannot move: look at the drives of these links, or start off the dead centre");
  }

 private:
  // Projects first, then corrects along the free motions only: W = M^-1-orthogonal responses to each target's row. Once
  // more where the solver's answers leave a digit.
  void meet(const std::vector<VelocityTarget>& targets) {
    constexpr int kRounds = 3;
    dynamics_.project_velocity(state_);
    const int m = static_cast<int>(targets.size());
    MatX rows(m, 6 * n_), response(6 * n_, m);
    VecX gap(m), wanted(m), a, lambda;
    for (int round = 0; round < kRounds; ++round) {
      for (int i = 0; i < m; ++i) {
        const VelocityTarget& target = targets[static_cast<std::size_t>(i)];
        double rate = 0;
        const CoordinateRow at = coordinate_row(dynamics_, state_, target.link, target.axis);
        rate = at.rate;
        rows.row(i) = at.row.transpose();
        wanted[i] = std::abs(target.value), gap[i] = target.value - rate;
      }
      const double left = gap.lpNorm<Eigen::Infinity>(), largest = wanted.lpNorm<Eigen::Infinity>();
      if (round > 0 && left <= 4 * std::numeric_limits<double>::epsilon() * largest) return;
      const Evaluation& e = dynamics_.gather_rows(state_);
      const VecX none = VecX::Zero(e.rows().n_rows);
      Factor& factor = dynamics_.factor(e);
      for (int i = 0; i < m; ++i) {
        factor.solve(e, rows.row(i).transpose(), none, a, lambda);
        response.col(i) = a;
      }
      // Targets may depend on each other: any impulse that gives their rates will do, since all give the same motion.
      const MatX compliance = rows.lazyProduct(response);
      const VecX impulse = compliance.fullPivLu().solve(gap);
      if ((compliance * impulse - gap).lpNorm<Eigen::Infinity>() > 1e-9 * std::max({1.0, left, largest}))
        throw AssemblyError("start velocity: " + target_names(targets) +
                            " cannot be met together; the mechanism does not move that way: "
                            "ask for fewer coordinates, or for one that is free");
      state_.v += response * impulse;
      dynamics_.project_velocity(state_);
    }
  }

  // By this share of d, or by half of it, ..., until |C| falls. Returns |C|.
  double move_along(const VecX& d, double whole, double now) {
    const State from = state_;
    for (double share = whole;; share *= 0.5) {
      state_ = from;
      cayley_move(state_, n_, share, d);
      const double next = residual();
      if (next < now || share < 1e-3 * whole) return next;
    }
  }

  double residual() {
    now_ = &dynamics_.gather_rows(state_);
    now_->residuals(C_, Cd_);
    return now_->norm(C_);
  }

  [[noreturn]] void stop(double now, int iterations) {
    throw AssemblyError("assembly stopped after " + std::to_string(iterations) +
                        " iterations at |C| = " + text::brief(now) + " m; worst: " + worst_rows(*now_, C_) +
                        ". Check the start poses of these links' bodies, their markers and masks");
  }

  static std::string target_names(const std::vector<VelocityTarget>& targets) {
    std::vector<std::string> names;
    for (const VelocityTarget& t : targets) names.push_back(t.link + "." + std::string(to_string(t.axis)));
    return text::join(names);
  }

  Dynamics& dynamics_;
  State& state_;
  const AssemblyOptions& options_;
  int n_;
  const Evaluation* now_ = nullptr;  // set by residual()
  VecX C_, Cd_;
};

double kinetic_energy(Dynamics& dynamics, const State& state) {
  const Inputs& in = dynamics.inputs(state);
  double twice = 0;
  for (int k = 0; k < dynamics.system().n_slots(); ++k) {
    const Slot& b = dynamics.system().slot(k);
    twice += b.mass * in.slot(k).v.squaredNorm() + in.slot(k).w.dot(b.J * in.slot(k).w);
  }
  return 0.5 * twice;
}

// Bodies that have a velocity now, by what was not given of it.
struct NotGiven {
  std::vector<std::string> all, velocity, omega;

  bool is_half() const { return !velocity.empty() || !omega.empty(); }
  /// "no start velocity is given for 'coupler', 'rocker'; ..."; "" where all are given.
  std::string text() const {
    std::string words;
    const auto say = [&](const char* what, std::vector<std::string> names) {
      constexpr std::size_t kMost = 5;
      if (names.empty()) return;
      if (names.size() > kMost) names.resize(kMost), names.emplace_back("...");
      words += (words.empty() ? "" : "; ") + std::string(what) + text::join(names);
    };
    say("no start velocity is given for ", all);
    say("an angular velocity, but no \"velocity\" of the frame's origin is given for ", velocity);
    say("a \"velocity\", but no angular one (\"omega_world\") is given for ", omega);
    return words;
  }
};

NotGiven not_given(const System& system, const State& given, const State& assembled) {
  constexpr double kNone = 1e-12, kNow = 1e-9;  // of the other half: rounding; m/s and rad/s
  NotGiven out;
  for (int k = 0; k < system.n_slots(); ++k) {
    const Body& body = system.body_of_slot(k);
    const Twist asked = body_twist(body, given), has = body_twist(body, assembled);
    const double v = asked.v.norm(), w = system.length() * asked.w.norm();
    const bool moves = has.v.norm() > kNow, turns = has.w.norm() > kNow;
    const std::string name = "'" + body.name + "'";
    if (v == 0 && w == 0) {
      if (moves || turns) out.all.push_back(name);
    } else if (v <= kNone * w) {
      if (moves) out.velocity.push_back(name);
    } else if (w <= kNone * v && turns) {
      out.omega.push_back(name);
    }
  }
  return out;
}

// Whether the start poses fit the links but for their drives: a mechanism drawn in its zero position, which its drives
// take to where they begin.
bool only_laws_move(Dynamics& dynamics, const State& given) {
  constexpr double kFits = 1e-6;  // m
  const Evaluation& e = dynamics.gather_rows(given);
  VecX C, Cd;
  e.residuals(C, Cd);
  for (const RowEntry& entry : e.rows().entries) {
    const Lock& link = *dynamics.system().links()[static_cast<std::size_t>(entry.link)];
    for (int k = 0; k < entry.m; ++k)
      if (link.row(entry.own[static_cast<std::size_t>(k)]).drive >= 0) C[entry.first_row + k] = 0;
  }
  return e.norm(C) < kFits;
}

// What assembling changed so much that the start was hardly meant so.
void add_warnings(Dynamics& dynamics, const State& given, const State& assembled, const AssemblyOptions& options,
                  AssemblyReport& report) {
  const System& system = dynamics.system();
  constexpr double kFar = 0.1;                      // of the length of the mechanism, or
  constexpr double kMove = 0.5;                     // m
  constexpr double kTurned = 0.5;                   // rad
  constexpr double kMost = 0.5, kMostOfHalf = 0.1;  // of the kinetic energy: at all; where half a velocity is given
  // Poses count no more where coordinates are asked for, nor that of a body that may go anywhere.
  const auto meant = [&](const std::string& body) {
    return options.coordinates.empty() &&
           std::ranges::none_of(options.poses, [&](const PoseWeight& w) { return w.body == body && w.weight == 0; });
  };
  const bool moved = report.largest_move > std::min(kFar * system.length(), kMove) && meant(report.moved_most),
             turned = report.largest_turn > kTurned && meant(report.turned_most);
  const bool by_laws = (moved || turned) && only_laws_move(dynamics, given);
  if (moved && !by_laws)
    report.warnings.push_back(fmt::format(
        "assembly moved body '{}' by {:.3g} m from where its start pose puts it; give it a position that fits its "
        "links (`lockstep assemble` prints one)",
        report.moved_most, report.largest_move));
  else if (turned && !by_laws)
    report.warnings.push_back(fmt::format(
        "assembly turned body '{}' by {:.3g} rad from its start pose; give it an orientation that fits its links "
        "(`lockstep assemble` prints one)",
        report.turned_most, report.largest_turn));
  const double lost = report.kinetic_before - report.kinetic_after;
  if (!(lost > kMostOfHalf * report.kinetic_before)) return;
  const NotGiven not_all = not_given(system, given, assembled);
  if (!(lost > kMost * report.kinetic_before) && !not_all.is_half()) return;
  const std::string missing = not_all.text();
  report.warnings.push_back(fmt::format(
      "assembly took {:.3g} J of the {:.3g} J that the start velocities give, as the links do not allow them: {}", lost,
      report.kinetic_before,
      missing.empty() ? "no such motion is free (lockstep check counts the freedoms)"
                      : missing + "; give fitting ones, or one start speed of a link (\"start\")"));
}

// What was asked for by a weight and is not there: against it count the start poses of the bodies, and other coordinates.
void add_missed(Dynamics& dynamics, const State& assembled, const AssemblyOptions& options, AssemblyReport& report) {
  constexpr double kMissed = kPi / 180, kMissedBy = 1e-3;  // rad; of the length of the mechanism
  for (const CoordinateTarget& target : options.coordinates) {
    if (!std::isfinite(target.weight) || target.weight == 0) continue;
    const bool turns = is_rotation(target.axis);
    const double value = coordinate_value(dynamics, assembled, dynamics.system().link(target.link), target.axis);
    const double off = turns ? std::remainder(value - target.value, kTwoPi) : value - target.value;
    if (std::abs(off) <= (turns ? kMissed : kMissedBy * dynamics.system().length())) continue;
    const double unit = turns ? 180 / kPi : 1;
    report.warnings.push_back(fmt::format(
        "link '{}': {} begins at {:.4g} {}, near {:.4g} {} was asked for: what else is asked for, start poses of "
        "bodies "
        "among it, counts against it; ask for it exactly (\"position\"), or let its body go anywhere (\"assembled\": "
        "\"free\")",
        target.link, to_string(target.axis), unit * (target.value + off), turns ? "deg" : "m", unit * target.value,
        turns ? "deg" : "m"));
  }
}

void measure_move(const System& system, const State& from, const State& to, AssemblyReport& report) {
  for (int k = 0; k < system.n_slots(); ++k) {
    const Pose a = from.slot_pose(k), b = to.slot_pose(k);
    const double move = (b.x - a.x).norm(), turn = rotation_vector(conjugate(normalized(a.q)) * b.q).norm();
    if (move > report.largest_move) report.largest_move = move, report.moved_most = system.body_of_slot(k).name;
    if (turn > report.largest_turn) report.largest_turn = turn, report.turned_most = system.body_of_slot(k).name;
  }
}

}  // namespace

LOCKSTEP_API bool AssemblyReport::is_notable() const {
  constexpr double kNotable = 1e-6;  // m, rad, m/s
  return before > kNotable || before_v > kNotable || largest_move > kNotable || largest_turn > kNotable;
}

LOCKSTEP_API std::string AssemblyReport::text() const {
  std::string text =
      fmt::format("the start violated the constraints by {:.2g} m and {:.2g} m/s, now by {:.2g} m and {:.2g} m/s",
                  before, before_v, after, after_v);
  if (largest_move == 0 && largest_turn == 0) text += "; only velocities changed";
  if (largest_move > 0) text += fmt::format("; moved '{}' by {:.3g} m", moved_most, largest_move);
  if (largest_turn > 0) text += fmt::format("; turned '{}' by {:.3g} rad", turned_most, largest_turn);
  if (std::abs(kinetic_after - kinetic_before) > 1e-9 * std::max(kinetic_before, kinetic_after))
    text += fmt::format("; kinetic energy {:.3g} J, now {:.3g} J", kinetic_before, kinetic_after);
  return text;
}

namespace {

// Whether the start is the one nearest to what is asked.
bool weighs(const AssemblyOptions& options) { return !options.coordinates.empty() || !options.poses.empty(); }

void find_positions_from(Dynamics& dynamics, State& work, const AssemblyOptions& options, Assembler& assembler,
                         AssemblyReport& report, bool follows, bool short_steps) {
  const int rounds = weighs(options) ? nearest_start(dynamics, work, options, follows) : 0;
  assembler.positions(report, follows, short_steps);
  report.iterations += rounds;
}

/// Once more where drives begin more than a quarter turn away and Newton's method was lost: with the bodies of open chains
/// turned there, by shorter steps. Returns whether what counts turns followed the iterations.
bool find_positions(Dynamics& dynamics, State& work, const AssemblyOptions& options, Assembler& assembler,
                    AssemblyReport& report) {
  const System& system = dynamics.system();
  const bool begins = turns_begin(system, work);
  const bool led = begin_turns(dynamics, work, options, report.warnings),
             follows =
                 led || (has_coupled_angles(system) && (!options.coordinates.empty() || has_drives(system, work)));
  const State begun = work;
  if (!led) follow_turns(dynamics, work);  // led ones are those of the poses to come
  report.before = weighs(options) ? dynamics.violation(work) : assembler.distance();
  const State given = work;
  try {
    find_positions_from(dynamics, work, options, assembler, report, follows, follows);
  } catch (const AssemblyError& error) {
    work = given;
    const std::string drive = farthest_drive(dynamics, work);
    if (!turn_to_drives(dynamics, work)) throw;
    try {
      find_positions_from(dynamics, work, options, assembler, report, follows, true);
    } catch (const AssemblyError&) {
      throw AssemblyError(error.what() + drive);
    }
  }
  follow_turns(dynamics, work);
  if (begins) settle_turns(dynamics, begun, work);
  return follows;
}

}  // namespace

void assemble_positions(Dynamics& dynamics, State& state, const AssemblyOptions& options) {
  AssemblyReport report;
  dynamics.system().check_size(state);
  State work = state;
  Assembler assembler(dynamics, work, options);
  find_positions(dynamics, work, options, assembler, report);
  state = std::move(work);
}

AssemblyReport assemble(Dynamics& dynamics, State& state, const std::vector<VelocityTarget>& targets,
                        const AssemblyOptions& options) {
  AssemblyReport report;
  dynamics.system().check_size(state);
  State work = state;
  Assembler assembler(dynamics, work, options);
  const bool follows = find_positions(dynamics, work, options, assembler, report);
  report.kinetic_before = kinetic_energy(dynamics, work);
  assembler.velocities(targets, report);
  if (follows) follow_turns(dynamics, work);  // with the rates of the start
  report.kinetic_after = kinetic_energy(dynamics, work);
  measure_move(dynamics.system(), state, work, report);
  add_warnings(dynamics, state, work, options, report);
  add_missed(dynamics, work, options, report);
  state = work;
  if (report.is_notable()) log_info(report.text());
  for (const std::string& warning : report.warnings) log_warning(warning);
  return report;
}

}  // namespace lockstep
