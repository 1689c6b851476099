// Statics: Newton's method on rows and forces, downhill; dynamic relaxation where that fails; one-sided links.
#include <lockstep/equilibrium.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include <lockstep/error.h>
#include <lockstep/newton.h>
#include <lockstep/text.h>
#include "framework/dynamics/simulate/contacts.h"
#include "framework/tools/analysis/free_motions.h"
#include "framework/tools/analysis/motion_words.h"
#include "framework/tools/analysis/rest_motions.h"

namespace lockstep {
namespace {

constexpr double kLongest = 0.5;  // rad, and of the extent of the mechanism: a step of Newton's method
constexpr double kLeast = 1e-10;  // s, relative to force/(mass length): more than rounding in a free motion
constexpr int kMostDense = 400;   // unknowns
constexpr double kOnTheRows = 1e-14;  // |C| after a step, m
constexpr double kStillDownhill = 0.9;
constexpr double kFarAway = 1e3;   // extents: it falls
constexpr int kLeaves = 10;        // unstable positions that are left
constexpr double kPushOff = 0.05;  // lengths

/// Forces at a state at rest: f - J^T lambda = M a with J a = 0.
class ForcesAtRest {
 public:
  explicit ForcesAtRest(Dynamics& dynamics) : dynamics_(dynamics), length_(dynamics.system().length()) {}

  void look(const State& state) {
    e = &dynamics_.gather(state);
    const System& system = dynamics_.system();
    none_.setZero(e->rows().n_rows);
    Factor& factor = dynamics_.factor(*e);
    SolveReport solved = factor.solve(*e, e->force(), none_, a, lambda);
    if (!e->reacting().empty()) reacting_.solve(*e, factor, none_, a, lambda, solved);
    factor.check(*e, a, lambda, solved);
    r.setZero(a.size());
    for (int k = 0; k < system.n_slots(); ++k) {
      r.segment<3>(6 * k) = system.slot(k).mass * a.segment<3>(6 * k);
      r.segment<3>(6 * k + 3) = system.slot(k).J * a.segment<3>(6 * k + 3);
    }
    force = largest_force();
    const double left = largest(r);
    unbalanced = force > 0 ? left / force : 0;
    speed_up = 0;
    for (int k = 0; k < system.n_slots(); ++k)
      speed_up = std::max({speed_up, a.segment<3>(6 * k).norm(), length_ * a.segment<3>(6 * k + 3).norm()});
    e->residuals(C, Cd_);
  }
  double power() const { return r.dot(a); }  ///< a^T M a

  const Evaluation* e = nullptr;
  VecX a, lambda, r, C;
  double unbalanced = 0,  ///< largest of r, relative
      force = 0,          ///< largest force on a body, N; moments by the length
      speed_up = 0;       ///< largest acceleration, m/s^2; turns by the length

 private:
  double largest(const VecX& f) const {
    double most = 0;
    for (Eigen::Index k = 0; k < f.size(); k += 6) most = std::max(most, size_of(f.segment<6>(k)));
    return most;
  }
  /// Of each force by itself, since all of them together vanish where nothing else holds a body.
  double largest_force() {
    const System& system = dynamics_.system();
    const Inputs& in = e->inputs();
    double most = largest(e->force());
    for (int k = 0; k < system.n_slots(); ++k) most = std::max(most, system.slot(k).mass * system.gravity().norm());
    one_.setZero(a.size());
    WrenchSum sum(in.motions, one_);
    for (const auto& each : system.forces()) {
      if (!each->acts(in)) continue;
      each->apply(in, sum);
      for (const int slot : each->slots()) {
        most = std::max(most, size_of(one_.segment<6>(6 * slot)));
        one_.segment<6>(6 * slot).setZero();
      }
    }
    for (const RowEntry& entry : e->rows().entries)
      for (int i = 0; i < entry.slots.n; ++i) {
        Vec6 on = Vec6::Zero();
        for (int k = 0; k < entry.m; ++k) {
          const std::array<double, 6> J = e->rows().block(entry).J(i, k);
          on += lambda[entry.first_row + k] * Eigen::Map<const Vec6>(J.data());
        }
        most = std::max(most, size_of(on));
      }
    return most;
  }
  double size_of(const Vec6& f) const { return std::max(f.head<3>().norm(), f.tail<3>().norm() / length_); }

  Dynamics& dynamics_;
  double length_;
  ReactionIteration reacting_;
  VecX none_, Cd_, one_;
};

class Search {
 public:
  Search(Dynamics& dynamics, State& state, const EquilibriumOptions& options, EquilibriumReport& report)
      : dynamics_(dynamics),
        system_(dynamics.system()),
        state_(state),
        options_(options),
        report_(report),
        now_(dynamics),
        length_(system_.length()) {
    contacts_.lay_out(system_, dynamics.options().stabilization);
    for (int k = 0; k < system_.n_slots(); ++k) heaviest_ = std::max(heaviest_, system_.slot(k).mass);
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
    for (int k = 0; k < system_.n_slots(); ++k) {
      const Vec3 x = state.q.segment<3>(7 * k);
      low = k == 0 ? x : Vec3(low.cwiseMin(x)), high = k == 0 ? x : Vec3(high.cwiseMax(x));
    }
    extent_ = std::max(length_, (high - low).norm());
  }

  void run() {
    state_.v.setZero();
    touch(state_);
    settle(state_);
    start_ = state_;
    for (int round = 0;; ++round) {
      if (!newton(options_.iterations)) relax();
      if (release()) continue;
      if (contacts_switched_ > kMostSwitches)
        throw SolveError(
            fmt::format("statics: the one-sided links {} come into force and are released without end; "
                        "start nearer to the equilibrium, or take the ones that touch as two-sided",
                        text::join(contact_names())));
      report_.stability = judge_rest(*now_.e, now_.lambda);
      if (options_.nearest || report_.stability.unstable.empty() || round == kLeaves) break;
      push_off(report_.stability.unstable.front());
    }
    finish();
  }

 private:
  static constexpr int kMostSwitches = 200;

  /// Onto the rows, without velocities. False where that fails: too far off, or outside of where a law or function of a
  /// link is defined.
  bool settle(State& state) {
    bool fits = false;
    try {
      fits = dynamics_.project(state, kOnTheRows).converged;
    } catch (const SolveError&) {
    } catch (const NonFiniteError&) {
    }
    state.v.setZero();
    return fits;
  }

  // -- Newton's method

  double least_shift() const { return kLeast * now_.force / (heaviest_ * length_); }

  /// A step of Newton's method that goes with the forces, unless `either_way`, and is not too long. False where there is
  /// none.
  bool find_step(bool either_way) {
    return system_.n_velocities() <= kMostDense ? find_dense_step(either_way) : find_sparse_step(either_way);
  }

  /// In the free motions, K u = mu M u: against each stiffness by its size, so that the step goes downhill where K is not
  /// positive too; `either_way`: against each as it is. What nothing holds and nothing pushes stays.
  bool find_dense_step(bool either_way) {
    constexpr double kNone = 1e-11, kNearlyZero = 10;
    const RestMatrices A(*now_.e, now_.lambda);
    if (A.N.cols() == 0) return false;
    VecX g(static_cast<Eigen::Index>(A.at.size()));
    for (std::size_t i = 0; i < A.at.size(); ++i)
      g[static_cast<Eigen::Index>(i)] = now_.r[A.at[i]] / (A.at[i] % 6 < 3 ? 1.0 : length_);
    const RestMotions motions = rest_motions(A);
    const bool potential = has_potential(A, motions);
    VecX share = motions.U.transpose() * g, y;
    if (!potential) {
      const MatX K = motions.U.transpose() * A.K * motions.U;
      y = MatX(K + shift_ * MatX::Identity(K.rows(), K.cols())).partialPivLu().solve(share);
    }
    if (potential || !y.allFinite() || (!either_way && y.dot(share) < 0)) {
      const double rounding = kNone * now_.force / std::sqrt(heaviest_);
      for (Eigen::Index i = 0; i < share.size(); ++i) {
        const double mu = motions.stiffness[i];
        if (std::abs(mu) <= kNearlyZero * motions.bound[i])
          share[i] = std::abs(share[i]) <= rounding ? 0.0 : share[i] / std::max(shift_, now_.speed_up / length_);
        else
          share[i] /= either_way ? mu : std::abs(mu) + shift_;
      }
      y = share;
    }
    step_ = motion_of(system_, A.at, motions.U * y);
    if (!step_.allFinite()) return false;
    if (const double size = size_of(step_); size > kLongest) step_ *= kLongest / size;
    slope_ = now_.r.dot(step_);
    return true;
  }

  /// (K + s M) dx + J^T dl = r, J dx = -C. s grows until the step goes with the forces and is short enough.
  bool find_sparse_step(bool either_way) {
    constexpr int kMost = 40;
    matrix_.gather(*now_.e, now_.lambda);
    const VecX c = -now_.C;
    for (int k = 0; k < kMost; ++k) {
      bool solved = true;
      try {
        matrix_.factor(std::max(shift_, least_shift()), 0, 1);
        matrix_.solve(now_.r, c, step_, turned_);
      } catch (const SolveError&) {
        solved = false;
      }
      slope_ = solved && step_.allFinite() ? now_.r.dot(step_) : -1;
      const double size = solved && step_.allFinite() ? size_of(step_) : 2 * kLongest;
      const bool shortens = size > kLongest;
      if (solved && !shortens && (slope_ >= 0 || either_way)) return true;
      shift_ = std::max(4 * shift_, 0.25 * now_.speed_up / length_);
      if (shift_ == 0) return false;
    }
    return false;
  }

  bool accepts(double share, double slope_before, double unbalanced_before, double power_before) const {
    if (now_.unbalanced <= options_.tolerance && now_.unbalanced < unbalanced_before) return true;
    if (options_.nearest) return now_.power() <= (1 - 1e-4 * share) * power_before;
    return now_.r.dot(step_) >= -kStillDownhill * slope_before;
  }

  /// The largest turn, rad, or move by the extent of the mechanism.
  double size_of(const VecX& step) const {
    double size = 0;
    for (int k = 0; k < system_.n_slots(); ++k)
      size = std::max({size, step.segment<3>(6 * k).norm() / extent_, step.segment<3>(6 * k + 3).norm()});
    return size;
  }

  /// Looks at the present state. False where its forces are not finite.
  bool look() {
    try {
      now_.look(state_);
      return true;
    } catch (const NonFiniteError&) {
      return false;
    }
  }

  /// One step along the line. False where no share of it is accepted; the state is then the old one.
  bool take_step() {
    constexpr int kHalvings = 12;
    const State from = state_;
    const double slope = slope_, unbalanced = now_.unbalanced, power = now_.power();
    double share = 1;
    for (int k = 0; k < kHalvings; ++k, share *= 0.5) {
      state_ = from;
      advance_state(state_, share, step_);
      if (!settle(state_)) continue;
      if (touch(state_)) {  // the next step knows of the link
        if (!settle(state_) || !look()) continue;
        return true;
      }
      if (!look() || !accepts(share, slope, unbalanced, power)) continue;
      if (share < 1)
        shift_ = std::max(2 * shift_, least_shift());
      else
        shift_ *= now_.r.dot(step_) < 0.7 * slope ? 0.1 : 0.3;
      return true;
    }
    state_ = from;
    now_.look(state_);
    return false;
  }

  bool newton(int most) {
    constexpr int kFailures = 6, kPolish = 4;
    int failures = 0, polish = 0;
    now_.look(state_);
    for (int made = 0;; ++made) {
      const bool done = now_.unbalanced <= options_.tolerance;
      if (done && (++polish > kPolish || now_.unbalanced == 0)) return true;
      if (made >= most && !done) return false;
      if (done) shift_ = 0;
      const double before = now_.unbalanced;
      const State from = state_;
      if (!find_step(done || options_.nearest)) return done;  // at rest rounding has no direction
      ++report_.iterations;
      if (!take_step()) {
        if (done) return true;
        if (++failures > kFailures) return false;
        shift_ = std::max(16 * shift_, now_.speed_up / length_);
        continue;
      }
      failures = 0;
      if (done && !(now_.unbalanced < 0.5 * before)) {  // rounding: the better of the two
        if (now_.unbalanced > before) state_ = from, now_.look(state_);
        return true;
      }
      if (motion_size(system_, now_.a) > 0 && gone()) no_equilibrium();
    }
  }

  // -- dynamic relaxation (FIRE): the motion itself, its velocity turned into the forces' direction, stopped whenever it
  // goes against them.

  void relax() {
    constexpr double kGrow = 1.1, kShrink = 0.5, kStart = 0.1, kFade = 0.99;
    constexpr int kWait = 5, kTrial = 30;
    report_.relaxed = true;
    double goal = 1e-2;
    now_.look(state_);
    VecX v = VecX::Zero(now_.a.size());
    double mix = kStart, h = 0, h_most = 0;
    int well = 0;
    const auto begin = [&] {
      h = now_.speed_up > 0 ? 0.05 * std::sqrt(length_ / now_.speed_up) : 1e-3;
      h_most = 10 * h, mix = kStart, well = 0;
      v.setZero();
    };
    begin();
    for (;; ++report_.relaxation_steps) {
      if (now_.unbalanced <= goal) {
        const State here = state_;
        shift_ = 0;
        if (newton(std::min(kTrial, options_.iterations))) return;
        state_ = here;
        now_.look(state_);
        goal *= 0.03;
        begin();
      }
      if (report_.relaxation_steps >= options_.relaxation_steps || gone()) no_equilibrium();
      if (now_.r.dot(v) > 0) {
        const double share = std::sqrt(mass_norm(v) / std::max(now_.power(), 1e-300));
        v = (1 - mix) * v + mix * share * now_.a;
        if (++well > kWait) h = std::min(kGrow * h, h_most), mix *= kFade;
      } else {
        v.setZero(), h *= kShrink, mix = kStart, well = 0;
      }
      v += h * now_.a;
      if (const double size = h * motion_size(system_, v) / length_; size > 0.1) v *= 0.1 / size;
      const State from = state_;
      advance_state(state_, h, v);
      if (!settle(state_)) {
        state_ = from;
        v.setZero(), h *= kShrink;
      } else if (touch(state_)) {
        settle(state_);
        v.setZero();
      }
      now_.look(state_);
    }
  }

  double mass_norm(const VecX& v) const {
    double sum = 0;
    for (int k = 0; k < system_.n_slots(); ++k)
      sum += system_.slot(k).mass * v.segment<3>(6 * k).squaredNorm() +
             v.segment<3>(6 * k + 3).dot(system_.slot(k).J * v.segment<3>(6 * k + 3));
    return sum;
  }

  bool gone() const {
    double far = 0;
    for (int k = 0; k < system_.n_slots(); ++k)
      far = std::max(far, (state_.q.segment<3>(7 * k) - start_.q.segment<3>(7 * k)).norm());
    return !(far < kFarAway * extent_);
  }

  [[noreturn]] void no_equilibrium() {
    const Stability s = judge_rest(*now_.e, now_.lambda);
    std::string words;
    for (const FreeMotion& m : s.neutral) {
      const double pushes = now_.r.dot(m.motion);
      if (std::abs(pushes) > 1e-3 * now_.r.norm() * m.motion.norm())
        words += (words.empty() ? "" : "; ") +
                 motion_words(system_, now_.e->inputs(), (pushes < 0 ? -1 : 1) * m.motion) + ", and nothing holds it";
    }
    const std::string did = fmt::format(
        "statics: no equilibrium was found by {} iterations of Newton's method and {} steps of dynamic "
        "relaxation; what is left of the forces is {:.3g} of the largest",
        report_.iterations, report_.relaxation_steps, now_.unbalanced);
    const std::string moving = motion_words(system_, now_.e->inputs(), now_.a);
    throw SolveError(did + ". " +
                     (words.empty() ? "Under the forces " + moving +
                                          ". Start nearer to where it should rest, or hold that motion by a spring"
                                    : "Under the forces " + words + ": hold it by a link, a drive or a spring"));
  }

  // -- unstable positions

  void push_off(const FreeMotion& motion) {
    report_.left.push_back(motion.words);
    const State from = state_;
    double size = kPushOff * length_;
    for (int k = 0; k < 20; ++k, size *= 0.5) {
      state_ = from;
      advance_state(state_, size, motion.motion);
      if (settle(state_)) break;
    }
    shift_ = 2 * std::abs(motion.stiffness);
  }

  // -- one-sided links

  /// Puts into force those that the state passes through, or touches. Returns whether there were any.
  bool touch(State& state) {
    bool any = false;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      if (contacts_.in_force(i, state) || !contacts_.watched(i, state)) continue;
      if (contacts_.gap(i, dynamics_.inputs(state)).c > contacts_[i].margin) continue;
      if (released_at_ == static_cast<int>(i) && contacts_.gap(i, dynamics_.inputs(state)).c > -contacts_[i].margin)
        continue;
      contacts_.put(i, true, state);
      ++contacts_switched_;
      any = true;
    }
    if (any) released_at_ = -1;
    return any;
  }

  double push(std::size_t i) const {
    const int row = contacts_.row(i, now_.e->rows());
    return row < 0 ? 0 : -contacts_[i].sign * now_.lambda[row];
  }

  /// Releases the link that pulls most. Returns whether one did.
  bool release() {
    std::size_t worst = contacts_.size();
    double most = -1e-9 * now_.force;
    for (std::size_t i = 0; i < contacts_.size(); ++i)
      if (contacts_.in_force(i, state_) && contacts_.watched(i, state_) && push(i) < most) most = push(i), worst = i;
    if (worst == contacts_.size() || ++contacts_switched_ > kMostSwitches) return false;
    contacts_.put(worst, false, state_);
    released_at_ = static_cast<int>(worst);
    return true;
  }

  std::vector<std::string> contact_names() const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < contacts_.size(); ++i) names.push_back("'" + contacts_[i].link->name() + "'");
    return names;
  }

  void finish() {
    report_.lambda = now_.lambda;
    report_.unbalanced = now_.unbalanced;
    report_.largest_force = now_.force;
    for (std::size_t i = 0; i < contacts_.size(); ++i)
      (contacts_.in_force(i, state_) ? report_.pressed : report_.free).push_back(contacts_[i].link->name());
    for (int k = 0; k < system_.n_slots(); ++k)
      if (const double move = (state_.q.segment<3>(7 * k) - start_.q.segment<3>(7 * k)).norm();
          move > report_.largest_move)
        report_.largest_move = move, report_.moved_most = system_.body_of_slot(k).name;
    for (const Force* force : now_.e->reacting())
      report_.notes.push_back(
          fmt::format("{} '{}' is taken as it acts without motion: friction that is smooth at rest "
                      "holds nothing, and with real friction it may rest beside this position too",
                      force->type(), force->name()));
    if (system_.n_states() > 0)
      report_.notes.push_back("integrated states (controllers, drives by speed) keep their values of the start");
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
  int contacts_switched_ = 0, released_at_ = -1;
};

}  // namespace

std::string EquilibriumReport::method() const {
  const std::string newton = fmt::format("Newton's method, {} iteration{}", iterations, iterations == 1 ? "" : "s");
  return relaxed ? fmt::format("dynamic relaxation, {} steps, then {}", relaxation_steps, newton) : newton;
}

EquilibriumReport find_equilibrium(Dynamics& dynamics, State& state, const EquilibriumOptions& options) {
  EquilibriumReport report;
  State work = state;
  dynamics.to_slots(work);
  Search(dynamics, work, options, report).run();
  state = std::move(work);
  return report;
}

}  // namespace lockstep
