// SPDX-License-Identifier: BSD-3-Clause
// ContactManager: the unilateral links of a run. Locates hits and releases inside a step, and resolves impacts,
// contacts and releases. Internal to the step loop.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "framework/dynamics/simulate/contacts.h"
#include "framework/dynamics/simulate/guard_finder.h"
#include "framework/dynamics/simulate/last_steps.h"

namespace lockstep {

class ContactManager : public GuardOwner {
 public:
  /// `limit`: m, how deep on its forbidden side a link may start.
  ContactManager(Dynamics& dynamics, StepInterval& interval, GuardFinder& finder, const double& limit)
      : dynamics_(dynamics), interval_(interval), finder_(finder), limit_(limit) {}

  /// Starts a new run; throws AssemblyError for a link that starts on its forbidden side.
  void start(const State&);
  bool empty() const { return contacts_.empty(); }
  /// Throws AssemblyError, naming `cause`, if one of these links is on its forbidden side.
  void check_sides(const State&, const std::vector<std::string>& links, const std::string& cause);
  /// Notes gaps and pushes at the start of the next step. `moved`: the state has changed since they were evaluated.
  void note(const State&, bool moved);
  /// Adds gaps and pushes to the guards of the step that ended with this state.
  void add_guards(const State&);
  /// Whether one of them is met where the step ends now.
  bool meet(const State&);

  struct Settled {
    bool impact = false;        ///< velocities jumped
    bool restart = false;       ///< the method must restart
    std::uint64_t touched = 0;  ///< bits of the links that made or lost contact (the first 64), except those at rest
    std::string resting;        ///< names the links that stay in contact, whose rows must be made consistent
  };
  /// Resolves impacts, contacts and releases at this state. What a row or a force throws leaves the contacts as they
  /// were, to be settled when the run continues.
  Settled settle(State&);

  /// Names those that made or lost contact in at least a tenth of these steps, "one-sided joint 'floor' made or lost
  /// contact in 998 of the last 1000 steps: ..."; "" if none did.
  std::string who_was_touched(const LastSteps&) const;

  // -- checkpoints
  void save(Snapshot&) const;
  /// In place of start().
  void load(SnapshotReader&);

 private:
  void lay_out();
  // contact_manager.cpp: inside a step
  double guard(std::size_t contact, const Sample&) override;
  void check_side(std::size_t contact, const State&, const std::string& cause);
  double height(const Contact&, double gap, double t) const;
  void add_gaps(const State& end);
  void add_pulls(const State& end);
  const Solution& evaluate_pushes(const State&);
  // contact_impacts.cpp: at the instant
  bool find_touching(const State&);
  template <class Misfit>
  void pivot(State&, const char* what, const Misfit&);
  template <class Fits>
  std::size_t first_misfit(const Fits& fits) const {
    return static_cast<std::size_t>(std::ranges::find_if_not(touching_, fits) - touching_.begin());
  }
  std::size_t find_kick(const State&);
  void take_impact(State&);
  std::string rest(State&, bool here);
  void put_active(State&) const;
  [[noreturn]] void fail(const State&, const char* what) const;

  Dynamics& dynamics_;
  StepInterval& interval_;
  GuardFinder& finder_;
  const double& limit_;
  Contacts contacts_;
  double contact_time_ = kNever;       // where the present step meets a contact
  std::vector<std::size_t> released_;  // the links that pull there
  // Of an impact: what touches.
  struct Touch {
    std::size_t of;
    Gap gap;      // before the impact
    double aim;   // its least rate after it
    bool active;  // it pushes
  };
  std::vector<Touch> touching_;
  VecX C_, Cd_, no_force_, kick_, impulse_;
  State trial_;
  std::vector<bool> modes_before_;
};

}  // namespace lockstep
