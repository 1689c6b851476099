// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/dynamics.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/foundation/math/limits.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {
namespace {

constexpr int kMostSolutions = 50;
constexpr double kForceRoundOff = 1e-15;  // relative to all other forces: changes below it do not count

// The largest force on a slot, N; moments are divided by the length.
double largest_force(const VecX& f, double length) {
  double most = 0;
  for (Eigen::Index i = 0; i < f.size(); i += 6)
    most = std::max(most, f.segment<3>(i).norm() + f.segment<3>(i + 3).norm() / length);
  return most;
}

double dot(const VecX& a, const VecX& b, double length) {
  double sum = 0;
  for (Eigen::Index i = 0; i < a.size(); i += 6)
    sum += a.segment<3>(i).dot(b.segment<3>(i)) + a.segment<3>(i + 3).dot(b.segment<3>(i + 3)) / (length * length);
  return sum;
}

}  // namespace

// Fixed point x = g(x): x is what the reacting forces add, g(x) what they would add at the multipliers of f + x. From
// the second solution on, x is where the line through the last two changes r = g(x) - x comes nearest to zero
// (Anderson's method of depth one; for one number, Aitken's), so friction that is stiff to its own reaction costs few
// more solutions. The equations are linear: what a change of x adds to a and lambda is solved for by itself. If rows are
// redundant, the rounding of their split then shrinks with the change.
void ReactionIteration::solve(const Evaluation& e, Factor& factor, const VecX& c, VecX& a, VecX& lambda,
                              SolveReport& report) {
  const double length = e.system().length(), applied = largest_force(e.force(), length);
  const Unsettled all{e, factor, c, a, lambda, report};
  added_.setZero(e.force().size());
  for (int n = 1;; ++n) {
    change_ = -added_;
    e.react(lambda, change_);
    if (!change_.allFinite()) diagnose(all, 1);
    const double left = largest_force(change_, length), size = std::max(largest_force(added_, length), left);
    if (left <= kRoundOff * size + kForceRoundOff * applied && n > 1) return;
    if (left == 0) return;
    if (n > kMostSolutions) diagnose(all, left / size);
    loaded_ = added_ + change_;
    if (n > 1) {
      change_before_ -= change_;
      const double square = dot(change_before_, change_before_, length);
      const double back = square > 0 ? -dot(change_, change_before_, length) / square : 0.0;
      // (1 - back) (x + r) + back (x + r)_before
      loaded_ += back * (added_before_ - added_ + change_before_);
    }
    added_before_ = added_, change_before_ = change_;
    loaded_ -= added_;
    add(all, loaded_);
  }
}

// Adds a load, and what it adds to the solution.
void ReactionIteration::add(const Unsettled& u, const VecX& load) {
  added_ += load;
  no_rows_.setZero(u.c.size());
  u.factor.solve(u.e, load, no_rows_, da_, dlambda_);
  u.a += da_, u.lambda += dlambda_;
}

// How a change grows from one solution to the next when each takes what the forces give at the one before: without
// limit if they answer a change of reactions by a larger one, not at all if they jump between two values. Ends early if
// nothing changes any more.
double ReactionIteration::last_gain(const Unsettled& u) {
  constexpr int kRounds = 5;
  const double length = u.e.system().length();
  double gain = 0;
  for (int k = 0; k < kRounds; ++k) {
    const double before = largest_force(change_, length);
    if (!(before > 0) || !std::isfinite(before)) break;
    add(u, change_);
    change_ = -added_;
    u.e.react(u.lambda, change_);
    gain = largest_force(change_, length) / before;
  }
  return gain;
}

// Names the force whose share still changes most between two solutions.
void ReactionIteration::diagnose(const Unsettled& u, double left) {
  u.factor.check(u.e, u.a, u.lambda, u.report);
  const Inputs& in = u.e.inputs();
  const auto share = [&](const Force& force) {
    VecX one = VecX::Zero(u.e.force().size());
    WrenchSum sum(in.motions, one);
    const Reactions reactions(u.e.rows(), {u.lambda.data(), static_cast<std::size_t>(u.lambda.size())});
    named(force, in.t, [&] { force.reacting()->react(in, reactions, sum); });
    return one;
  };
  std::vector<VecX> first;
  for (const Force* force : u.e.reacting()) {
    first.push_back(share(*force));
    const Thing thing = thing_of(*force);
    if (!first.back().allFinite())
      throw NonFiniteError(
          at_time(in.t) + thing.label() + " is not finite at the present reactions; look at its parameters",
          {.thing = thing, .t = in.t});
    if (share(*force) != first.back())
      throw SolveError(at_time(in.t) + thing.label() +
                           " gives different forces at the same reactions; let react() depend on its inputs and on the "
                           "reactions alone",
                       {.thing = thing, .t = in.t});
  }
  add(u, change_);
  std::size_t worst = 0;
  double most = -1;
  for (std::size_t i = 0; i < first.size(); ++i)
    if (const double size = largest_force(share(*u.e.reacting()[i]) - first[i], u.e.system().length()); !(size <= most))
      most = size, worst = i;
  const Force& force = *u.e.reacting()[worst];
  const Thing culprit = thing_of(force);
  std::string links;
  for (const Lock* link : force.reacting()->reads()) links += (links.empty() ? "joint '" : "', '") + link->name();
  const double gain = last_gain(u);
  const std::string cause =
      gain < 0.9  // between two values it is 1, except for the rest of the way there
          ? "each iteration leaves " + text::brief(gain) +
                " of a change, which converges too slowly; let it depend less steeply on the reactions"
          : gain < 1 + kSlight ? "it jumps as a function of them; let it change over a range of reactions"
                               : "each iteration multiplies a change by " + text::brief(gain) +
                                     " without limit, as friction that jams its joint; reduce the coefficient, or the "
                                     "lever arm of the load";
  throw SolveError(at_time(in.t) + culprit.label() + " and the reactions of " + links +
                       "' that it reads do not converge (" + text::brief(100 * left) + " % still changes after " +
                       std::to_string(kMostSolutions) + " solutions): " + cause,
                   {.thing = culprit, .t = in.t});
}

}  // namespace lockstep
