// What a search does where Newton's method fails, and how it leaves unstable positions.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <string>

#include <lockstep/error.h>
#include "framework/dynamics/simulate/line_search.h"
#include "framework/tools/analysis/equilibrium_search.h"
#include "framework/tools/analysis/motion_words.h"

namespace lockstep {
namespace {

constexpr double kFarAway = 1e3;   // extents: it falls
constexpr double kPushOff = 0.05;  // lengths

}  // namespace

void EquilibriumSearch::relax() {
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

double EquilibriumSearch::mass_norm(const VecX& v) const {
  double sum = 0;
  for (int k = 0; k < system_.n_slots(); ++k)
    sum += system_.slot(k).mass * v.segment<3>(6 * k).squaredNorm() +
           v.segment<3>(6 * k + 3).dot(system_.slot(k).J * v.segment<3>(6 * k + 3));
  return sum;
}

bool EquilibriumSearch::gone() const {
  double far = 0;
  for (int k = 0; k < system_.n_slots(); ++k)
    far = std::max(far, (state_.q.segment<3>(7 * k) - start_.q.segment<3>(7 * k)).norm());
  return !(far < kFarAway * extent_);
}

void EquilibriumSearch::no_equilibrium() {
  const Stability s = judge_rest(*now_.e, now_.lambda);
  std::string words;
  for (const FreeMotion& m : s.neutral) {
    const double pushes = now_.r.dot(m.motion);
    if (std::abs(pushes) > 1e-3 * now_.r.norm() * m.motion.norm())
      words += (words.empty() ? "" : "; ") + motion_words(system_, now_.e->inputs(), (pushes < 0 ? -1 : 1) * m.motion) +
               ", and nothing holds it";
  }
  const std::string did = fmt::format(
      "statics: no equilibrium was found by {} iterations of Newton's method and {} steps of dynamic "
      "relaxation; what is left of the forces is {:.3g} of the largest",
      report_.iterations, report_.relaxation_steps, now_.unbalanced);
  const std::string moving = motion_words(system_, now_.e->inputs(), now_.a);
  const std::string friction = beyond_friction();
  throw SolveError(did + ". " + (friction.empty() ? "" : "At first, " + friction + ". ") +
                   (words.empty() ? "Under the forces " + moving +
                                        ". Start nearer to where it should rest, or hold that motion by a spring"
                                  : "Under the forces " + words + ": hold it by a link, a drive or a spring"));
}

void EquilibriumSearch::push_off(const FreeMotion& motion) {
  report_.left.push_back(motion.words);
  search_line(state_, [&](double share) {
    advance_state(state_, share * kPushOff * length_, motion.motion);
    return settle(state_);
  });
  shift_ = 2 * std::abs(motion.stiffness);
}

}  // namespace lockstep
