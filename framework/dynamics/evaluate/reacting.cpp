// Forces that depend on the present reactions (friction): the multipliers that they make, and that make them.
#include <algorithm>
#include <cmath>

#include "framework/dynamics/evaluate/dynamics.h"
#include "framework/foundation/support/error.h"
#include "framework/foundation/support/text.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {
namespace {

constexpr int kMostSolutions = 50;
constexpr double kSettled = 1e-12;   // of the friction: the change that ends the search
constexpr double kRoundOff = 1e-15;  // of all other forces: nor is it followed below that
constexpr double kStalled = 1e-9;    // of the friction: what shrinks no more is round-off below this

// Largest force of a slot, moments by the length.
double size_of(const VecX& f, double length) {
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

void Dynamics::react(const VecX& lambda, VecX& f) const {
  const Reactions reactions(rows_, {lambda.data(), static_cast<std::size_t>(lambda.size())});
  WrenchSum sum(in_.motions, f);
  for (const Force* force : reacting_) named(*force, in_.t, [&] { force->reacting()->react(in_, reactions, sum); });
}

// x = g(x): x is what the reacting forces add, g(x) what they would add at the multipliers of f + x. One factor serves
// all solutions. From the second on x is taken where the line through the last two changes r = g(x) - x is nearest to
// zero (Anderson's method with one earlier try, Aitken's for one number): a friction that is stiff to its own reaction
// costs few solutions more.
void Dynamics::find_reactions(const State& state) {
  const double length = system_.length(), applied = size_of(f_, length);
  added_.setZero();
  double before = HUGE_VAL;
  for (int n = 1;; ++n) {
    change_ = -added_;
    react(lambda_, change_);
    if (!change_.allFinite()) diagnose_reactions(state, 1);
    const double left = size_of(change_, length), size = std::max(size_of(added_, length), left);
    if (left <= kSettled * size + kRoundOff * applied && n > 1) return;
    if (left == 0) return;
    if (n > 2 && left > 0.5 * before && left <= kStalled * size) return;
    if (n > kMostSolutions) diagnose_reactions(state, left / size);
    before = left;
    loaded_ = added_ + change_;
    if (n > 1) {
      change_before_ -= change_;
      const double square = dot(change_before_, change_before_, length);
      const double back = square > 0 ? -dot(change_, change_before_, length) / square : 0.0;
      // (1 - back) (x + r) + back (x + r)_before
      loaded_ += back * (added_before_ - added_ + change_before_);
    }
    added_before_ = added_, change_before_ = change_;
    added_ = loaded_;
    loaded_ += f_;
    solve_loaded(loaded_, c_, true, a_, lambda_);
  }
}

// Names the force whose share still changes most between two solutions.
void Dynamics::diagnose_reactions(const State& state, double left) {
  check_solved(state);
  const auto share = [&](const Force& force) {
    VecX one = VecX::Zero(f_.size());
    WrenchSum sum(in_.motions, one);
    force.reacting()->react(in_, Reactions(rows_, {lambda_.data(), static_cast<std::size_t>(lambda_.size())}), sum);
    return one;
  };
  std::vector<VecX> first;
  for (const Force* force : reacting_) {
    first.push_back(share(*force));
    if (!first.back().allFinite())
      throw NonFiniteError("t = " + number(state.t) + " s: force '" + force->name() + "' (" +
                               std::string(force->type()) +
                               ") is not finite at the present reactions; look at its parameters",
                           state.t);
  }
  loaded_ = f_ + added_ + change_;
  solve_loaded(loaded_, c_, true, a_, lambda_);
  std::size_t worst = 0;
  double most = -1;
  for (std::size_t i = 0; i < reacting_.size(); ++i)
    if (const double size = size_of(share(*reacting_[i]) - first[i], system_.length()); !(size <= most))
      most = size, worst = i;
  const Force& force = *reacting_[worst];
  std::string links;
  for (const Lock* link : force.reacting()->reads()) links += (links.empty() ? "link '" : "', '") + link->name();
  throw SolveError(
      "t = " + number(state.t) + " s: force '" + force.name() + "' (" + std::string(force.type()) +
      ") and the reactions of " + links + "' that it reads do not settle (after " + std::to_string(kMostSolutions) +
      " solutions " + brief(100 * left) +
      " % of the friction still changes): its coefficient lets the friction raise the reaction by more than "
      "it needs itself, so the joint would jam; make the coefficient smaller, or the arm on which the load "
      "presses shorter");
}

}  // namespace lockstep
