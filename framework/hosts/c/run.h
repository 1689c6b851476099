// SPDX-License-Identifier: BSD-3-Clause
// A run as a handle.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <lockstep/linearization.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include "framework/hosts/c/handle.h"

namespace lockstep::c {

struct Run final : Object {
  /// Calls `act` and keeps the findings that it reports.
  template <class Act>
  void collecting(Act&& act) {
    FindingScope scope;
    try {
      act();
    } catch (...) {
      add_new(scope.found, found);
      throw;
    }
    add_new(scope.found, found);
  }
  /// Adds those findings that `all` lacks.
  static void add_new(const std::vector<Finding>& more, std::vector<Finding>& all);
  /// Those so far, with those of the verdict.
  std::vector<Finding> all_findings();
  /// Throws LOCKSTEP_USAGE for an index that is not below count.
  static std::size_t checked(int index, std::size_t count, const char* of);
  /// Begins the run, if it has not begun.
  void begin();
  const Column& column(int index) const;
  ControlInput& input(int index);

  /// The laws of the scene that read inputs, by the names of these.
  std::shared_ptr<std::map<std::string, std::shared_ptr<InputLaw>>> laws =
      std::make_shared<std::map<std::string, std::shared_ptr<InputLaw>>>();
  std::vector<Request> columns;  ///< after the time
  std::optional<Simulation> simulation;
  std::vector<Finding> found;
  bool begun = false;
  State started;    ///< its start, and
  double step = 0;  ///< the step of its settings, s: for the causes of errors
  std::optional<StateSpace> space;
  MatX matrix;            ///< the last one that was asked for, transposed: row by row
  std::string more_text;  ///< a second text beside that of keep()
};

/// The lines of an argument that are not empty; null has none.
std::vector<std::string> lines_of(const char* text, const char* name);

/// Calls `act` with the simulation of a run.
template <class Act>
int call_run(lockstep_run* handle, Act&& act) noexcept {
  return call<Run>(handle, [&](Run& run) { run.collecting([&] { act(run, *run.simulation); }); });
}
/// The same with a call that begins the run.
template <class Act>
int call_begun(lockstep_run* handle, Act&& act) noexcept {
  return call_run(handle, [&](Run& run, Simulation& simulation) {
    run.begin();
    act(run, simulation);
  });
}

}  // namespace lockstep::c
