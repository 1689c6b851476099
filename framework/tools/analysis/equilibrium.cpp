// SPDX-License-Identifier: BSD-3-Clause
// Statics: Newton's method on constraints and forces, towards lower potential energy.
#include <lockstep/equilibrium.h>
#include "framework/foundation/support/finding_kinds.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <lockstep/detail/newton.h>
#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/dynamics/evaluate/row_space.h"
#include "framework/dynamics/evaluate/singular_rate.h"
#include "framework/dynamics/simulate/contacts.h"
#include "framework/dynamics/simulate/line_search.h"
#include "framework/foundation/math/limits.h"
#include "framework/tools/analysis/back_to_plane.h"
#include "framework/tools/analysis/forces_at_rest.h"
#include "framework/tools/analysis/wild_starts.h"
#include "framework/tools/rank/motion_words.h"
#include "framework/tools/record/energies.h"

namespace lockstep {
namespace {

constexpr double kLongest = 0.5;  // rad, and of the extent of the mechanism: a step of Newton's method
constexpr int kMostDense = 400;   // unknowns
constexpr double kStillDownhill = 0.9;
constexpr std::size_t kLeaves = 10;  // unstable positions that are left
constexpr double kFarAway = 1e3;     // extents: it falls
constexpr double kPushOff = 0.05;    // lengths

std::string words_of(const GripReport& grip) {
  return fmt::format("'{}' ({}) needs {:.6g} {} (limit {:.6g})", grip.force, grip.what, grip.carries, grip.unit,
                     grip.most);
}

/// A search from one state, which it moves: Newton's method, dynamic relaxation if that fails, one-sided joints. All must
/// outlive it.
class EquilibriumSearch {
 public:
  EquilibriumSearch(Dynamics& dynamics, State& state, const EquilibriumOptions& options, EquilibriumReport& report)
      : dynamics_(dynamics),
        system_(dynamics.system()),
        state_(state),
        options_(options),
        report_(report),
        now_(dynamics),
        length_(system_.length()) {
    contacts_.lay_out(system_, dynamics.options().stabilization);
    Eigen::AlignedBox3d box;
    for (int k = 0; k < system_.n_slots(); ++k) {
      heaviest_ = std::max(heaviest_, system_.slot(k).mass);
      box.extend(Vec3(state.q.segment<3>(7 * k)));
    }
    extent_ = std::max(length_, box.isEmpty() ? 0 : box.diagonal().norm());
  }
  /// Ends at rest, or throws SolveError.
  void run() {
    state_.v.setZero();
    touch(state_);
    settle(state_);
    start_ = state_;
    if (rests_by_friction()) return finish();
    for (;;) {
      if (!newton(report_.iterations, options_.iterations)) relax();
      if (release()) continue;
      if (releases_ > most_releases())
        throw SolveError(
            fmt::format("statics: the one-sided joints {} close and open again without end; start nearer to the "
                        "equilibrium, or make those in contact two-sided",
                        text::join(contact_names())));
      report_.stability = judge_rest(*now_.e, now_.lambda);
      if (options_.nearest || report_.stability.unstable.empty() || report_.left.size() == kLeaves) break;
      push_off(report_.stability.unstable.front());
    }
    finish();
  }

 private:
  // Onto the rows, without velocities. False if that fails: too far off, or outside of where a law or function of a link
  // is defined.
  bool settle(State& state) {
    const bool fits = solvable([&] { return dynamics_.project(state, kRoundOff * length_).converged; });
    state.v.setZero();
    const Inputs& in = dynamics_.inputs(state);  // angles continue from the previous pose
    for (const auto& angle : system_.counted_angles()) angle->set(in, angle->expected(in.s), state.s);
    return fits;
  }

  // -- Newton's method

  // More than rounding in a free motion.
  double least_shift() const { return kNegligible * now_.force / (heaviest_ * length_); }

  // Each finds a step of Newton's method that goes with the forces, unless `either_way`, and is not too long. False if
  // there is none.

  // In the free motions, K u = mu M u: against each stiffness by its size, so that the step goes downhill where K is
  // not positive too; `either_way`: against each as it is. What nothing holds and nothing pushes stays.
  bool find_dense_step(bool either_way) {
    const RestMatrices A(*now_.e, now_.lambda);
    if (A.N.cols() == 0) return false;
    const VecX g = A.at.forces_in(now_.r);
    const ModalBasis motions = A.modal_basis();
    const MatX& K = motions.K;
    VecX share = motions.U.transpose() * g, y;
    if (!motions.has_potential) y = MatX(K + shift_ * MatX::Identity(K.rows(), K.cols())).partialPivLu().solve(share);
    if (motions.has_potential || !y.allFinite() || (!either_way && y.dot(share) < 0)) {
      const double rounding = kRoundOff * now_.force / std::sqrt(heaviest_);
      for (Eigen::Index i = 0; i < share.size(); ++i) {
        const double mu = K(i, i);
        if (std::abs(mu) <= 10 * kRoundOff * motions.terms(i, i))
          share[i] = std::abs(share[i]) <= rounding ? 0.0 : share[i] / std::max(shift_, now_.speed_up / length_);
        else
          share[i] /= either_way ? mu : std::abs(mu) + shift_;
      }
      y = share;
    }
    step_ = A.at.motion_of(motions.U * y);
    if (!step_.allFinite()) return false;
    if (const double size = size_of(step_); size > kLongest) step_ *= kLongest / size;
    slope_ = now_.r.dot(step_);
    return true;
  }

  // (K + s M) dx + J^T dl = r, J dx = -C. s grows until the step goes with the forces and is short enough.
  bool find_sparse_step(bool either_way) {
    matrix_.gather(*now_.e, now_.lambda);
    const VecX c = -now_.C;
    const double rate = now_.speed_up / length_;
    for (; shift_ * kRoundOff <= rate; shift_ = std::max(4 * shift_, 0.25 * rate)) {
      try {
        matrix_.factor(std::max(shift_, least_shift()), 0, 1);
        matrix_.solve(now_.r, c, step_, turned_);
        slope_ = now_.r.dot(step_);
        if (size_of(step_) <= kLongest && (slope_ >= 0 || either_way)) return step_.allFinite();
      } catch (const SolveError&) {  // a larger shift has a factor
      }
      if (rate == 0) break;
    }
    return false;
  }

  bool accepts(double slope_before, double unbalanced_before, double power_before) const {
    if (now_.unbalanced <= options_.tolerance && now_.unbalanced < unbalanced_before) return true;
    if (options_.nearest) return now_.power() < power_before;
    return now_.r.dot(step_) >= -kStillDownhill * slope_before;
  }

  // The largest rotation, rad, or move by the extent of the mechanism.
  double size_of(const VecX& step) const {
    double size = 0;
    for (int k = 0; k < system_.n_slots(); ++k)
      size = std::max({size, step.segment<3>(6 * k).norm() / extent_, step.segment<3>(6 * k + 3).norm()});
    return size;
  }

  // Looks at the present state. False if its forces are not finite.
  bool look() {
    try {
      now_.look(state_);
      return true;
    } catch (const NonFiniteError&) {
      return false;
    }
  }

  // One step along the line. False if no share of it is accepted; the state is then the old one.
  bool take_step() {
    const double slope = slope_, unbalanced = now_.unbalanced, power = now_.power();
    const bool taken = search_line(state_, [&](double share) {
      advance_state(state_, share, step_);
      if (!settle(state_)) return false;
      if (touch(state_)) return settle(state_) && look();  // the next step includes the joint
      if (!look() || !accepts(slope, unbalanced, power)) return false;
      if (share < 1)
        shift_ = std::max(2 * shift_, least_shift());
      else
        shift_ *= now_.r.dot(step_) < 0.7 * slope ? 0.1 : 0.3;
      return true;
    });
    if (!taken) now_.look(state_);
    return taken;
  }

  // At most so many steps, which are added to those made.
  bool newton(int& made, int most) {
    now_.look(state_);
    for (most += made;;) {
      const bool done = now_.unbalanced <= options_.tolerance;
      if (done && now_.unbalanced == 0) return true;
      if (made >= most && !done) return false;
      if (done) shift_ = 0;
      const double before = now_.unbalanced;
      const State from = state_;
      const bool dense = !report_.relaxed && system_.n_velocities() <= kMostDense;
      const bool either_way = done || options_.nearest;  // at rest rounding has no direction
      if (!(dense ? find_dense_step(either_way) : find_sparse_step(either_way))) return done;
      ++made;
      if (!take_step()) {
        if (done || size_of(step_) <= kRoundOff) return done;
        shift_ = std::max(16 * shift_, now_.speed_up / length_);
        continue;
      }
      if (done && !(now_.unbalanced < 0.5 * before)) {  // rounding: the better of the two
        if (now_.unbalanced > before) state_ = from, now_.look(state_);
        return true;
      }
      if (motion_size(system_, now_.a) > 0 && gone()) no_equilibrium();
    }
  }

  // -- friction

  // Whether friction holds the present state, and motions without friction are stable; if so, it is reported.
  bool rests_by_friction() {
    if (!options_.friction || system_.n_velocities() > kDenseUnknowns) return false;
    now_.look(state_);
    if (!has_friction(now_)) return false;
    RestMatrices A(*now_.e, now_.lambda);
    if (now_.unbalanced <= options_.tolerance && judge_motions(*now_.e, A).kind == Stability::Kind::stable)
      return false;  // without friction too
    FrictionLoad load = friction_load(dynamics_, now_, A);
    friction_balances_ = load.balances;
    if (load.balances) report_.grips = std::move(load.grips);
    if (!load.holds) return false;
    now_.lambda = load.lambda;
    for (std::size_t i = 0; i < contacts_.size(); ++i)
      if (pulls(i)) {
        const std::string joint = "joint '" + contacts_[i].link->name() + "'";
        note(joint, "friction could hold the start, but the one-sided " + joint + " would have to pull");
        return false;
      }
    RestMatrices held(*now_.e, load.lambda);
    held.N = load.ungripped;
    Stability found = judge_motions(*now_.e, held);
    if (found.kind == Stability::Kind::unstable) {
      note("",
           "friction could hold the start, but a motion without friction is unstable: " + found.unstable.front().words);
      return false;
    }
    if (found.kind == Stability::Kind::stable) found.kind = Stability::Kind::gripped;
    found.freedoms = static_cast<int>(A.N.cols());
    report_.stability = std::move(found);
    report_.by_friction = true;
    now_.unbalanced = 0;  // except for round-off
    return true;
  }

  // The loads beyond the friction of the given state, in a sentence; "" if there are none.
  std::string beyond_friction() const {
    std::string words = friction_balances_ ? "" : "no finite friction force balances the loads";
    for (const GripReport& grip : report_.grips)
      if (grip.carries > grip.most) words += (words.empty() ? "" : "; ") + words_of(grip);
    return words.empty() ? words : "friction does not hold the start: " + words;
  }

  // -- dynamic relaxation if Newton's method fails

  // The same steps with a shift s that begins at what the forces accelerate, and with the sparse matrix: the motion of
  // masses without inertia, M dx/dt = r, in implicit steps of 1/s that grow as it comes to rest.
  void relax() {
    report_.relaxed = true;
    shift_ = now_.speed_up / length_;
    if (!newton(report_.relaxation_steps, options_.relaxation_steps)) no_equilibrium();
  }

  bool gone() {
    measure_move(system_, start_, state_, report_);
    return !(report_.largest_move < kFarAway * extent_);
  }

  [[noreturn]] void no_equilibrium() {
    const Stability s = judge_rest(*now_.e, now_.lambda);
    std::string words;
    for (const FreeMotion& m : s.neutral) {
      const double pushes = now_.r.dot(m.motion);
      if (std::abs(pushes) > kSlight * now_.r.norm() * m.motion.norm())
        words += (words.empty() ? "" : "; ") +
                 motion_words(system_, now_.e->inputs(), (pushes < 0 ? -1 : 1) * m.motion) + ", and nothing holds it";
    }
    const std::string did =
        fmt::format("{} iterations of Newton's method and {} steps of relaxation leave {:.3g} of the largest force",
                    report_.iterations, report_.relaxation_steps, now_.unbalanced);
    const std::string moving = motion_words(system_, now_.e->inputs(), now_.a);
    const std::string friction = beyond_friction();
    const std::string next = options_.nearest ? "search further without --nearest" : "start nearer to the equilibrium";
    throw SolveError("statics: no equilibrium: under the forces " +
                     (words.empty() ? moving + "; " + next + ", or hold that motion by a spring"
                                    : words + "; hold it by a joint, a drive or a spring") +
                     ". " + (friction.empty() ? "" : "At first, " + friction + ". ") + did);
  }

  // -- unstable positions

  // Leaves one along the motion that grows.
  void push_off(const FreeMotion& motion) {
    report_.left.push_back(motion.words);
    search_line(state_, [&](double share) {
      advance_state(state_, share * kPushOff * length_, motion.motion);
      return settle(state_);
    });
    shift_ = 2 * std::abs(motion.stiffness);
  }

  // -- one-sided joints: they close on contact, and open if they would pull

  std::size_t most_releases() const { return 200 + 4 * contacts_.size(); }

  // Puts into force those that the state passes through, or touches. Returns whether there were any.
  bool touch(State& state) {
    bool any = false;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      if (contacts_.in_force(i, state) || !contacts_.watched(i, state)) continue;
      const double margin = contacts_[i].margin, most = released_at_ == static_cast<int>(i) ? -margin : margin;
      if (contacts_.gap(i, dynamics_.inputs(state)).c > most) continue;
      contacts_.put(i, true, state);
      any = true;
    }
    if (any) released_at_ = -1;
    return any;
  }

  double push(std::size_t i) const {
    const int row = contacts_.row(i, now_.e->rows());
    return row < 0 ? 0 : -contacts_[i].sign * now_.lambda[row];
  }

  // Whether its load would have to pull.
  bool pulls(std::size_t i) const {
    return contacts_.in_force(i, state_) && contacts_.watched(i, state_) && push(i) < -kNegligible * now_.force;
  }

  // Releases the joint that pulls most. Returns whether one did.
  bool release() {
    std::size_t worst = contacts_.size();
    for (std::size_t i = 0; i < contacts_.size(); ++i)
      if (pulls(i) && (worst == contacts_.size() || push(i) < push(worst))) worst = i;
    if (worst == contacts_.size() || ++releases_ > most_releases()) return false;
    contacts_.put(worst, false, state_);
    released_at_ = static_cast<int>(worst);
    return true;
  }

  std::vector<std::string> contact_names() const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < contacts_.size(); ++i) names.push_back("'" + contacts_[i].link->name() + "'");
    return names;
  }

  // -- the end

  void note(const std::string& thing, const std::string& words) {
    report_.notes.push_back({&finding::analysis_note, thing, words});
  }

  // Whether a law moves it at this time, and a force acts on it.
  bool moves_under_force(const Marker& marker) const {
    const bool slides = marker.translation_law && !marker.translation_law->at(state_.t).v.isZero(0),
               turns = marker.rotation_law && !marker.rotation_law->at(state_.t).w.isZero(0);
    return (slides || turns) && std::ranges::any_of(system_.forces(), [&](const std::unique_ptr<Force>& force) {
             const std::vector<const Marker*> at = force->markers();
             return force->acts(now_.e->inputs()) && std::ranges::find(at, &marker) != at.end();
           });
  }

  void finish() {
    report_.lambda = now_.lambda;
    report_.unbalanced = now_.unbalanced;
    report_.largest_force = now_.force;
    for (std::size_t i = 0; i < contacts_.size(); ++i)
      (contacts_.in_force(i, state_) ? report_.pressed : report_.free).push_back(contacts_[i].link->name());
    const StepReport none{};
    report_.energy = EnergyTerms::potential(Sample(dynamics_, state_, none));
    measure_move(system_, start_, state_, report_);
    if (const std::string words = beyond_friction(); !words.empty()) note("", words);
    if (options_.friction && !report_.by_friction && report_.stability.freedoms > 0 && has_friction(now_))
      note("", "this equilibrium is without friction; with friction, positions near it are at rest too");
    for (const Marker& marker : system_.markers())
      if (moves_under_force(marker))
        note("marker '" + marker.name + "'",
             fmt::format("marker '{}' moves by a law: dampers on it act by its velocity at that time", marker.name));
    if (system_.n_error_controlled_states() > 0)
      note("", "integrated states (controllers, drives by speed) keep their initial values");
    report_.singular = nearly_loses_rank(dynamics_, state_);
    if (report_.singular)
      note("", "the equilibrium is near a singular configuration, where reactions may grow without bound");
  }

  Dynamics& dynamics_;
  const System& system_;
  State& state_;
  const EquilibriumOptions& options_;
  EquilibriumReport& report_;
  ForcesAtRest now_;
  Contacts contacts_;
  NewtonMatrix matrix_;
  State start_;
  VecX step_, turned_;
  double length_, extent_ = 0, heaviest_ = 0, shift_ = 0, slope_ = 0;
  bool friction_balances_ = true;  // the loads of the start
  std::size_t releases_ = 0;
  int released_at_ = -1;
};

}  // namespace

std::string EquilibriumReport::method() const {
  if (by_friction) return "the start, held by friction";
  const std::string newton = fmt::format("Newton's method, {} iteration{}", iterations, iterations == 1 ? "" : "s");
  return relaxed ? fmt::format("dynamic relaxation, {} steps, after {}", relaxation_steps, newton) : newton;
}

EquilibriumReport find_equilibrium(Dynamics& dynamics, State& state, const EquilibriumOptions& options) {
  EquilibriumReport report;
  const State start = dynamics.in_slots(state);
  State work = start;
  System::InSpace look = dynamics.look_in_space();
  EquilibriumSearch(dynamics, work, options, report).run();
  go_back_to_plane(dynamics, look, start, {{work, report}});
  state = std::move(work);
  return report;
}

}  // namespace lockstep
