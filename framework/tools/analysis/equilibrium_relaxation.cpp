// SPDX-License-Identifier: BSD-3-Clause
// Dynamic relaxation if Newton's method fails, and the way out of unstable positions.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <string>

#include <lockstep/error.h>
#include "framework/dynamics/simulate/line_search.h"
#include "framework/tools/analysis/equilibrium_search.h"
#include "framework/tools/rank/motion_words.h"

namespace lockstep {
namespace {

constexpr double kFarAway = 1e3;   // extents: it falls
constexpr double kPushOff = 0.05;  // lengths

}  // namespace

void EquilibriumSearch::relax() {
  report_.relaxed = true;
  shift_ = now_.speed_up / length_;
  if (!newton(report_.relaxation_steps, options_.relaxation_steps)) no_equilibrium();
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
    if (std::abs(pushes) > kSlight * now_.r.norm() * m.motion.norm())
      words += (words.empty() ? "" : "; ") + motion_words(system_, now_.e->inputs(), (pushes < 0 ? -1 : 1) * m.motion) +
               ", and nothing holds it";
  }
  const std::string did =
      fmt::format("{} iterations of Newton's method and {} steps of relaxation leave {:.3g} of the largest force",
                  report_.iterations, report_.relaxation_steps, now_.unbalanced);
  const std::string moving = motion_words(system_, now_.e->inputs(), now_.a);
  const std::string friction = beyond_friction();
  throw SolveError("statics: no equilibrium: under the forces " +
                   (words.empty() ? moving + "; start nearer to the equilibrium, or hold that motion by a spring"
                                  : words + "; hold it by a joint, a drive or a spring") +
                   ". " + (friction.empty() ? "" : "At first, " + friction + ". ") + did);
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
