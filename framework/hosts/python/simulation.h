// SPDX-License-Identifier: BSD-3-Clause
// The run of a scene as Python holds it.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <lockstep/recorder.h>
#include <lockstep/report.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include "framework/hosts/python/bindings.h"

namespace lockstep::python {

using Settings = std::vector<std::pair<std::string, std::string>>;  ///< names and values of a scene

/// A scene that was read once, with the types that it names, for many runs.
struct ReadScene {
  ReadScene(const py::object& source, Types given);
  /// Values in SI of texts with commas between them, NaN for words, and their unit.
  std::pair<std::vector<double>, std::string> quantities(const std::string& name, const std::string& texts) const;
  std::array<py::handle, 1> references() const { return types.references(); }
  Types types;
  Scene scene;
};

/// A scene from a ReadScene, a path, a JSON text (it begins with "{") or a dictionary. Throws SceneError, FileError, TypeError.
Scene scene_of(const py::object& source, Types& types);

/// The columns of a table with their extremes, as arrays without a copy.
py::list columns_of(const std::shared_ptr<Table>&, std::span<const ColumnRange>);

/// A Simulation with the types that its scene names, and the rows that Python holds.
class Run {
 public:
  /// `record`: names of columns and their channels, beside those of the scene.
  Run(const py::object& source, Types types, const Settings& set, const Settings& record, bool with_report);

  /// Calls `act` while no other thread may use the run. If it calls functions of Python it keeps the interpreter's lock,
  /// and lends it to other threads as often as the interpreter does.
  template <class Act>
  void alone(Act&& act) {
    simulation();
    const AtEnd ended([this, before = std::exchange(runner_, std::this_thread::get_id())] { runner_ = before; });
    warn_once(found_by(std::forward<Act>(act), types.has_functions()));
  }
  /// Begins the run. From then on an interrupt (Ctrl-C) ends it after a step.
  void begin();
  /// As alone(), for what makes rows.
  template <class Act>
  void advancing(Act&& act) {
    simulation();
    take_rows_back();
    now_.reset();
    alone(std::forward<Act>(act));
  }
  /// Warns of what the verdict on the run finds.
  void judge() { warn_once(simulation().verdict().findings); }
  /// The columns so far, as arrays without a copy: they stay as they are while the run goes on.
  py::list columns();
  std::string report_page();
  /// The value of a recorded column or of a channel at the present time, and its unit.
  std::pair<double, std::string> value(const std::string& name);
  /// Gives the rows back to the recorder, before it changes or writes them.
  void take_rows_back();

  /// Throws ModelError while another thread runs it.
  Simulation& simulation();

  std::array<py::handle, 3> references() const { return {types.references()[0], functions, on_step}; }

  Types types;
  std::optional<Report> report{};
  ReportText text{};     ///< of the report
  Settings recorded{};   ///< columns and their channels
  bool begun = false;    ///< whether begin() was called
  py::list functions;    ///< of events
  py::object on_step{};  ///< called after each step; false ends the run; null: none

 private:
  bool goes_on();
  void warn_once(std::vector<Finding>);
  std::set<std::string> warned_;
  std::map<std::string, Channel> channels_;  // that value() was asked for
  StepReport none_{};
  std::optional<Sample> now_;    // the present state, evaluated once for all of them; none: it changes
  bool between_steps_ = false;   // in a call, when it calls on_step
  std::shared_ptr<Table> rows_;  // null: the recorder has them
  Turns turns_;
  std::thread::id runner_{};  // none: no call advances it
  Simulation simulation_;
};

}  // namespace lockstep::python
