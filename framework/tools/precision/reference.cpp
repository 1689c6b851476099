// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/precision/reference.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <optional>
#include <utility>

#include <lockstep/error.h>

namespace lockstep {
namespace {

constexpr double kReferenceShare = 0.1;  // of the budget, for one attempt at a reference
constexpr double kLastShare = 0.5;       // the same, if none has reached its end
constexpr double kReferenceTime = 0.6;   // of the budget, after which no wider tolerance is tried
constexpr double kSecondTime = 0.45;     // of the budget, after which no better pair is sought
constexpr double kAgreed = 1e-8;         // of the system's length: references that differ by less are good enough

class Search {
 public:
  Search(const Trajectory& trajectory, const WorkPrecisionOptions& options, const Clocks& clocks)
      : trajectory_(trajectory),
        options_(options),
        clocks_(clocks),
        begin_(clocks.clock()),
        limit_(kReferenceShare * options.budget) {}

  Reference make() {
    const Subject subject = trajectory_.make();
    result_.length = subject.system->length();
    // The tightest runs; if those disagree, other choices of keys at a tolerance further above round-off; then all.
    const double r = options_.reference_tolerance;
    try_all(r, true, false);
    try_all(100 * r, false, true);
    try_all(100 * r, true, false);
    try_all(1000 * r, true, true);
    if (found_.empty()) {  // little time: spend it on one
      limit_ = kLastShare * options_.budget;
      for (const MethodChoice& method : options_.references)
        if (found_.empty() && left() > 0) find(method, 1000 * r);
    }
    if (found_.empty())
      throw StepError("no reference solution could be computed at a tolerance of " +
                          fmt::format("{:g}", options_.reference_tolerance) + " or wider (" + why_ +
                          "); chart a shorter run (--until), or give a larger budget (--budget)",
                      0);
    if (pair_.second == pair_.first) {
      find(*found_.front().method, 100 * found_.front().tolerance);
      pair_ = {0, found_.size() - 1};
      result_.agreement = difference(found_.back().history, found_.front().history, result_.length);
    }
    result_.name = found_[pair_.first].name;
    result_.second = pair_.second > 0 ? found_[pair_.second].name : "itself (no second run finished)";
    result_.truth = std::move(found_[pair_.first].history);
    return std::move(result_);
  }

 private:
  struct Found {
    const MethodChoice* method;
    double tolerance;
    std::string name;
    History history;
  };

  std::optional<History> history_of(const MethodChoice& method, double tolerance) {
    if (options_.progress) options_.progress(fmt::format("reference: {} at {:g}", method.name, tolerance));
    Stabilization tight = options_.gains;
    tight.kind = Stabilization::Kind::project;
    tight.tolerance = std::min(tight.tolerance, 1e-12);
    const Recipe recipe{&method,
                        &options_.solvers.front(),
                        {Formulation::omega, tight},
                        {tolerance, 1e-2 * tolerance},
                        options_.largest_step};
    Outcome out = attempt_run(trajectory_, recipe, limit_, clocks_, RunKind::reference);
    if (out.failure.empty()) return std::move(out.history);
    if (out.given_up) slow_.push_back(integrator_type(method.name));
    why_ = method.name + ": " + out.failure;
    return std::nullopt;
  }

  // The first method of each kind is the default one. One that was too slow is tried again only if there is no other.
  void try_all(double tolerance, bool usual, bool others) {
    std::vector<std::string> kinds;
    for (const MethodChoice& method : options_.references) {
      const std::string kind = integrator_type(method.name);
      const bool first = std::find(kinds.begin(), kinds.end(), kind) == kinds.end();
      if (first) kinds.push_back(kind);
      if (std::find(slow_.begin(), slow_.end(), kind) != slow_.end() && !(first && found_.empty())) continue;
      const double share = found_.size() < 2 ? kReferenceTime : kSecondTime;
      if ((first ? usual : others) && !settled() && clocks_.clock() - begin_ < share * options_.budget)
        find(method, tolerance);
    }
  }

  // Adds a history, and with it possibly a better pair.
  void find(const MethodChoice& method, double tolerance) {
    std::optional<History> history = history_of(method, tolerance);
    if (!history) return;
    found_.push_back({&method, tolerance, fmt::format("{} at {:.0e}", method.name, tolerance), std::move(*history)});
    const std::size_t last = found_.size() - 1;
    for (std::size_t i = 0; i < last; ++i) {
      if (integrator_type(found_[i].method->name) == integrator_type(method.name)) continue;
      const HistoryError e = difference(found_[last].history, found_[i].history, result_.length);
      if (pair_.first != pair_.second && !(e.position < result_.agreement.position)) continue;
      pair_ = {i, last};
      result_.agreement = e;
    }
  }

  bool settled() const { return pair_.first != pair_.second && result_.agreement.position <= kAgreed * result_.length; }
  double left() const { return options_.budget - (clocks_.clock() - begin_); }
  const Trajectory& trajectory_;
  const WorkPrecisionOptions& options_;
  const Clocks& clocks_;
  double begin_;
  double limit_;  // s, of one attempt
  std::vector<Found> found_;
  std::vector<std::string> slow_;                   // kinds that exceeded the limit
  std::pair<std::size_t, std::size_t> pair_{0, 0};  // the two that agree best; equal: there are none yet
  std::string why_ = "no adaptive method is given";
  Reference result_;
};

}  // namespace

Reference make_reference(const Trajectory& trajectory, const WorkPrecisionOptions& options, const Clocks& clocks) {
  return Search(trajectory, options, clocks).make();
}

}  // namespace lockstep
