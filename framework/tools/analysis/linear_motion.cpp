// SPDX-License-Identifier: BSD-3-Clause
// Small deviations from a state, in axes that rotate with it.
//
// The axes rotate with Om. A body may rotate in them with r = w - Om about a symmetry axis. With W = Om, all in slot
// axes, deviations dth relative to axes that rotate with Om have
//
//   dv = dx' + Om x dx                 da  = dx'' + 2 Om x dx' + Om x (Om x dx)                  (9.20)
//   dw = dth' + W x dth                dal = dth'' + (W - r) x dth' - r x (W x dth)              (9.28)
//
// and a steady motion has v = u0 + Om x x, a = Om x v, al = W x w.
#include <lockstep/linearization.h>
#include "framework/foundation/support/finding_kinds.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/foundation/math/limits.h"
#include "framework/mechanism/system/diagnose.h"
#include "framework/tools/analysis/mechanism_matrices.h"

namespace lockstep {
namespace {

// A rigid motion of the axes.
struct Turning {
  Vec3 spin = Vec3::Zero(), u0 = Vec3::Zero();
};

// The motion of a slot, in the world except for w and al.
struct SlotMotion : Motion {
  Vec3 a, al;
};

std::vector<SlotMotion> motions_of(const State& state, const VecX& a) {
  std::vector<SlotMotion> all;
  for (int k = 0; k < static_cast<int>(a.size() / 6); ++k)
    all.push_back({slot_motion(state, k), a.segment<3>(6 * k), a.segment<3>(6 * k + 3)});
  return all;
}

Vec3 left_over_spin(const SlotMotion& m, const Vec3& spin) { return m.w - m.A.transpose() * spin; }

Turning turning_with(const Vec3& spin, const std::vector<SlotMotion>& slots) {
  Turning t{spin, Vec3::Zero()};
  for (const SlotMotion& m : slots) t.u0 += (m.v - cross(spin, m.x)) / static_cast<double>(slots.size());
  return t;
}

double load_of(const MechanismMatrices& at, Eigen::Index slot) { return at.loads[slot] + at.levers[slot]; }
double most_load(const MechanismMatrices& at) { return at.loads.size() > 0 ? (at.loads + at.levers).maxCoeff() : 0.0; }

// The speed of a slot that its load makes large: such an acceleration on a circle of the radius `length`.
double speed_of_load(const MechanismMatrices& at, std::size_t slot) {
  return std::sqrt(std::max(load_of(at, static_cast<Eigen::Index>(slot)), kRoundOff * most_load(at)) * at.length);
}

// An acceleration of a slot, m/s^2, angular ones times `length`, and what of it counts as none.
struct Share {
  double size = 0, limit = 0;
  double of_limit() const { return size == 0 ? 0.0 : size / limit; }
};

// The worst of a slot: that of its centre of mass, or an angular one about a principal axis. Each axis has a limit of
// its own: a moment of no matter to a body is much to its slender axis, and the other way round.
Share worst_of(const System& system, const MechanismMatrices& at, int slot, const Vec3& a, const Vec3& al,
               double round_off) {
  const double limit = kSlight * load_of(at, slot);
  Share worst{a.norm(), std::max(limit, round_off)};
  const BodyMass mass(system.slot(slot), system.plane());
  if (system.slot(slot).freedoms == Freedoms::particle) return worst;
  const Mat3 axes =
      system.plane() ? Mat3(Mat3::Identity()) : Mat3(Eigen::SelfAdjointEigenSolver<Mat3>(mass.J()).eigenvectors());
  const Vec3 moments = at.moments.segment<3>(3 * slot);
  const double whole = moments.norm() + at.length * mass.m() * at.loads[slot];
  for (int i = 0; i < 3; ++i) {
    const Vec3 axis = axes.col(i);
    const double moment = std::max(kSlight * axis.cwiseAbs().dot(moments), kRoundOff * whole),
                 turning = at.length * moment * axis.dot(mass.inverse_J() * axis);
    const Share share{at.length * std::abs(axis.dot(al)), std::max(limit + turning, round_off)};
    if (share.of_limit() > worst.of_limit()) worst = share;
  }
  return worst;
}

Unrest unrest_of(const System& system, const MechanismMatrices& at, const std::vector<SlotMotion>& slots,
                 const Turning& axes) {
  Unrest out;
  double worst = -1, worst_speed = -1;
  const double most = most_load(at);
  // Forces f_i accelerate constrained bodies by m_k a_k^2 <= sum f_i^2/m_i (Gauss's principle): so does the round-off
  // of springs that the whole length draws, f_i = K_ii length.
  double springs = 0;  // f_i/sqrt(m_i)
  for (std::size_t i = 0; i < at.unknowns.size(); ++i) {
    const auto c = static_cast<Eigen::Index>(i);
    const UnknownVelocity& u = at.unknowns[i];
    if (u.velocity < 3)
      springs = std::max(springs, at.length * std::abs(at.K.coeff(c, c)) / std::sqrt(system.slot(u.slot).mass));
  }
  for (std::size_t k = 0; k < slots.size(); ++k) {
    const SlotMotion& m = slots[k];
    const Vec3 W = m.A.transpose() * axes.spin;
    const double mass = system.slot(static_cast<int>(k)).mass,
                 round_off = kRoundOff * std::max({most, springs / std::sqrt(mass), m.w.squaredNorm() * at.length});
    const Share share = worst_of(system, at, static_cast<int>(k), Vec3(m.a - cross(axes.spin, m.v)),
                                 Vec3(m.al - cross(W, m.w)), round_off);
    const double v = (m.v - axes.u0 - cross(axes.spin, m.x)).norm();
    const double speed_limit = std::max(kSlight * speed_of_load(at, k),
                                        kRoundOff * (axes.u0.norm() + axes.spin.norm() * (m.x.norm() + at.length)));
    const std::string& body = system.body_of_slot(static_cast<int>(k)).name;
    if (share.of_limit() > worst)
      worst = share.of_limit(), out.acceleration = share.size, out.acceleration_limit = share.limit,
      out.accelerates = share.size > 0 ? body : "";
    if (const Share speed{v, speed_limit}; speed.of_limit() > worst_speed)
      worst_speed = speed.of_limit(), out.speed = v, out.speed_limit = speed_limit, out.moves = v > 0 ? body : "";
  }
  return out;
}

// The body that rotates in the axes and is not symmetric about that axis; "" if there is none.
std::string turns_unevenly(const System& system, const std::vector<SlotMotion>& slots, const Vec3& spin) {
  for (std::size_t k = 0; k < slots.size(); ++k) {
    const Vec3 r = left_over_spin(slots[k], spin);
    if (r.norm() <= kNegligible * slots[k].w.norm()) continue;
    const Mat3 &J = system.slot(static_cast<int>(k)).J, R = skew(r);
    if ((J * R - R * J).norm() > kNegligible * J.norm() * r.norm())
      return system.body_of_slot(static_cast<int>(k)).name;
  }
  return "";
}

bool at_rest(const MechanismMatrices& at, const std::vector<SlotMotion>& slots) {
  for (std::size_t k = 0; k < slots.size(); ++k)
    if (std::max(slots[k].v.norm(), at.length * slots[k].w.norm()) > kSlight * speed_of_load(at, k)) return false;
  return true;
}

// The spins with which the state may be steady, the likeliest first.
std::vector<Vec3> spins_of(const MechanismMatrices& at, const std::vector<SlotMotion>& slots) {
  std::vector<Vec3> spins;
  if (slots.empty() || at_rest(at, slots)) return {Vec3::Zero()};
  const Vec3 first = slots.front().A * slots.front().w;
  if (std::ranges::all_of(
          slots, [&](const SlotMotion& m) { return (m.A * m.w - first).norm() <= kNegligible * first.norm(); }))
    spins.push_back(first);
  // Om x v = a, W x w = al, u0 + Om x x = v: the shortest Om and u0 of the least squares.
  MatX A = MatX::Zero(static_cast<Eigen::Index>(9 * slots.size()), 6);
  VecX b(A.rows());
  for (std::size_t k = 0; k < slots.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(9 * k);
    const SlotMotion& m = slots[k];
    A.block<3, 3>(row, 0) = -skew(m.v), b.segment<3>(row) = m.a;
    A.block<3, 3>(row + 3, 0) = -skew(m.w) * m.A.transpose(), b.segment<3>(row + 3) = m.al;
    A.block<3, 3>(row + 6, 0) = -skew(m.x), A.block<3, 3>(row + 6, 3).setIdentity(), b.segment<3>(row + 6) = m.v;
  }
  spins.emplace_back(A.completeOrthogonalDecomposition().solve(b).head<3>());
  Vec3& spin = spins.back();
  if (spin.norm() <= kNegligible * first.norm()) spin.setZero();
  for (int k = 0; k < 3; ++k)
    if (std::abs(spin[k]) <= kRoundOff * spin.norm()) spin[k] = 0;
  if (!spin.isZero(0)) spins.emplace_back(Vec3::Zero());
  return spins;
}

// The state that a steady motion reaches after a third of a turn: of the axes, else of a body in them, else after it
// went the length.
State later(const State& state, const std::vector<SlotMotion>& slots, const Turning& axes, double length,
            const VecX& s_rate) {
  double rate = axes.spin.norm();
  if (rate == 0)
    for (const SlotMotion& m : slots) rate = std::max(rate, left_over_spin(m, axes.spin).norm());
  const double speed = axes.u0.norm();
  const double dt = rate * length > kSlight * speed ? 2.1 / rate : length / speed;
  const double square = axes.spin.squaredNorm();
  const Vec3 center = square > 0 ? Vec3(cross(axes.spin, axes.u0) / square) : Vec3(Vec3::Zero()),
             drift = square > 0 ? Vec3(axes.spin * (axes.spin.dot(axes.u0) / square)) : axes.u0;
  const Quat turn = exponential(Vec3(axes.spin * dt));
  const Mat3 R = rotation(turn);
  State out = state;
  out.t += dt;
  out.s += dt * s_rate;
  for (std::size_t k = 0; k < slots.size(); ++k) {
    const Vec3 r = left_over_spin(slots[k], axes.spin);
    const Pose now = state.slot_pose(static_cast<int>(k));
    const Vec3 x = center + R * (now.x - center) + drift * dt;
    const Quat q = normalized(turn * now.q * exponential(Vec3(r * dt)));
    out.set_slot_pose(static_cast<int>(k), {x, q});
    out.set_slot_twist(static_cast<int>(k), {axes.u0 + cross(axes.spin, x), rotation(q).transpose() * axes.spin + r});
  }
  return out;
}

std::string seen(const Vec3& spin) {
  return spin.isZero(0) ? ""
                        : " relative to axes that rotate with [" + text::brief(spin[0]) + ", " + text::brief(spin[1]) +
                              ", " + text::brief(spin[2]) + "] rad/s";
}

// What moves or accelerates in these axes; "" if all are within their limits.
std::string restless(const Turning& axes, const Unrest& u, const std::string& when) {
  std::string words;
  if (u.acceleration > u.acceleration_limit)
    words = "body '" + u.accelerates + "' accelerates at " + text::brief(u.acceleration) + " m/s^2" + when +
            " (limit " + text::brief(u.acceleration_limit) + ")";
  if (u.speed > u.speed_limit)
    words += (words.empty() ? "" : ", ") + ("body '" + u.moves + "' moves at " + text::brief(u.speed) + " m/s" + when +
                                            " (limit " + text::brief(u.speed_limit) + ")");
  return words.empty() ? "" : words + seen(axes.spin);
}

// Why the state is not steady in these axes; "" if it is.
std::string why_unsteady(Dynamics& dynamics, const State& state, const MechanismMatrices& at,
                         const std::vector<SlotMotion>& slots, const Turning& axes, const Unrest& unrest) {
  if (std::string words = restless(axes, unrest, ""); !words.empty()) return words;
  if (axes.spin.isZero(0) && at_rest(at, slots)) return "";
  const System& system = dynamics.system();
  if (const std::string body = turns_unevenly(system, slots, axes.spin); !body.empty())
    return "body '" + body + "' rotates" + seen(axes.spin) +
           " about an axis that is no symmetry axis of its inertia, so the coefficients change with its angle; give "
           "the spin of axes that rotate with it";
  VecX rate = VecX::Zero(state.s.size());
  passes::state_rates(system, dynamics.evaluate(state), rate);
  const State then = later(state, slots, axes, at.length, rate);
  if (dynamics.violation(then) > kSlight * at.length)
    return "the joints do not allow this motion for a third of a revolution";
  const MechanismMatrices at_then = matrices_at(dynamics, then);
  return restless(axes, unrest_of(system, at_then, motions_of(then, Unknowns(system).to_slots(at_then.a)), axes),
                  " a third of a revolution later");
}

void refuse_own_states(const System& system) {
  for (const auto& own : system.auxiliaries())
    if (own->controls_error())
      throw ModelError("'" + own->name() + "' has " + std::to_string(own->size()) +
                       " states of user-defined equations, which linearisation does not support; leave it out");
  for (const auto& link : system.links())
    if (link->n_own_states() > 0 && link->jointed() == nullptr)
      throw ModelError("joint '" + link->name() +
                       "' has integrated states, which linearisation does not support; leave it out");
}

// Friction depends on the reactions, which the linear equations keep constant: right only if it is zero. It then damps,
// by the slope of its law, which is noted.
void judge_friction(Dynamics& dynamics, const State& state, LinearMotion& at) {
  const System& system = dynamics.system();
  const Solution& solution = dynamics.evaluate(state);
  const Reactions reactions(solution);
  std::vector<std::string> damping;
  for (const auto& force : system.forces()) {
    if (force->reacting() == nullptr || !force->acts(solution.in)) continue;
    const std::vector<Grip> grips =
        named(*force, state.t, [&] { return force->reacting()->grips(solution.in, reactions); });
    if (std::ranges::any_of(grips, [](const Grip& grip) { return grip.most > 0; }))
      damping.push_back("'" + force->name() + "'");
    const VecX one = wrench_of(system, solution.in, *force, &reactions) - wrench_of(system, solution.in, *force);
    for (int k = 0; k < system.n_slots(); ++k)
      if (const double a = one.segment<3>(6 * k).norm() / system.slot(k).mass; a > kSlight * load_of(at, k))
        throw ModelError("force '" + force->name() + "' is active friction (" + text::brief(a) + " m/s^2 on '" +
                         system.body_of_slot(k).name +
                         "'), which linearisation does not support; use a state without sliding, or leave it out");
  }
  if (!damping.empty())
    at.notes.push_back({&finding::friction_damps, "",
                        "friction of " + text::join(damping) + " at rest acts as a damper (mu N/smoothing_speed)",
                        "set its mu to 0 for modes without friction"});
}

std::vector<Finding> notes_on(const System& system, const State& state) {
  std::vector<Finding> notes;
  const auto note = [&](const std::string& thing, const std::string& words) {
    notes.push_back({&finding::analysis_note, thing, thing + words});
  };
  for (const auto& link : system.links()) {
    if (link->unilateral() != nullptr)
      note("one-sided joint '" + link->name() + "'",
           state.modes[link->number()] ? " is in contact and taken as two-sided" : " is open and left out");
    if (link->n_own_states() > 0 && !link->jointed()->imposed().hold)
      note("joint '" + link->name() + "'", ": the speed of its drive is held");
    if (link->n_own_memory() > 0) note("joint '" + link->name() + "'", ": its memory is held");
  }
  for (const auto& force : system.forces())
    if (force->n_own_memory() > 0) note("force '" + force->name() + "'", ": its memory is held");
  return notes;
}

// D and K in the rotating axes, (9.20) and above.
void turn_axes(const System& system, const State& state, const std::vector<SlotMotion>& slots, LinearMotion& out) {
  if (at_rest(out, slots) && out.spin.isZero(0)) return;
  const Unknowns at(system);
  Triplets rate, square;  // da = dx'' + rate dx' + square dx
  const Mat3 Om = skew(out.spin);
  for (int k = 0; k < system.n_slots(); ++k) {
    const SlotMotion& m = slots[k];
    const Mat3 W = skew(Vec3(m.A.transpose() * out.spin)), r = skew(left_over_spin(m, out.spin));
    at.add(k, 2 * Om, W - r, rate), at.add(k, Om * Om, -r * W, square);
  }
  out.K += SparseMat(out.D * carried_by(out.spin, system, state)) + SparseMat(out.M * at.square(square));
  out.D += out.M * at.square(rate);
}

// Sets the axes in which the state is steady, and its residual motion in them. If there are none, those that are given,
// else those at rest; returns why it is not steady.
std::string settle_axes(Dynamics& dynamics, const State& state, const std::vector<SlotMotion>& slots,
                        const LinearMotionOptions& options, LinearMotion& out) {
  const System& system = dynamics.system();
  std::string why;
  for (const Vec3& spin : options.spin ? std::vector<Vec3>{*options.spin} : spins_of(out, slots)) {
    const Turning axes = turning_with(spin, slots);
    const Unrest unrest = unrest_of(system, out, slots, axes);
    const std::string words = why_unsteady(dynamics, state, out, slots, axes, unrest);
    out.spin = spin, out.unrest = unrest;
    if (words.empty()) return words;
    if (why.empty() && unrest.is_still()) why = words;  // now, and not later: the most specific reason
  }
  const Turning given = options.spin ? turning_with(*options.spin, slots) : Turning{};
  out.spin = given.spin;
  out.unrest = unrest_of(system, out, slots, given);
  if (why.empty()) why = restless(given, out.unrest, "");
  return why.empty() ? "it moves in a straight line, which the joints do not allow" : why;
}

}  // namespace

LinearMotion linear_motion(Dynamics& dynamics, const State& given, const LinearMotionOptions& options) {
  const State state = dynamics.in_slots(given);
  const System::InSpace look = dynamics.look_in_space();
  const System& system = dynamics.system();
  refuse_own_states(system);
  LinearMotion out;
  static_cast<MechanismMatrices&>(out) = matrices_at(dynamics, state);
  out.notes = notes_on(system, state);
  judge_friction(dynamics, state, out);
  const std::vector<SlotMotion> slots = motions_of(state, Unknowns(system).to_slots(out.a));
  const std::string why = settle_axes(dynamics, state, slots, options, out);
  if (!why.empty() && !options.frozen)
    throw ModelError("the state at t = " + text::brief(state.t) + " s is neither an equilibrium nor a steady motion: " +
                     why + "; use an equilibrium (find_equilibrium), or frozen coefficients");
  if (!why.empty())
    out.notes.insert(out.notes.begin(), {&finding::analysis_note, "", "frozen coefficients of one state: " + why});
  turn_axes(system, state, slots, out);
  return out;
}

}  // namespace lockstep
