// A scene run many times; recorder and events of a scene.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/recorder.h>
#include <lockstep/scene.h>

namespace lockstep {

// The recorder and the events of a mechanism that came from a scene.


/// Asks for the places of the bodies that move where the scene asks for nothing.
LOCKSTEP_API void record_places(Mechanism&);

/// A recorder with the channels that the scene asks for. Make it before the StepLoop; the mechanism must stay where
/// it is in memory. Throws SceneError with the place of a channel that does not exist.
LOCKSTEP_API std::unique_ptr<Recorder> make_recorder(Mechanism&);

/// The scene's events with their conditions. Make them before the StepLoop too; `recorder` follows their channels.
LOCKSTEP_API std::vector<Event> make_events(Mechanism&, Recorder& recorder);


// Sweep: one mechanism run many times, one row of results a run.


/// Of one recorded column over a run.
struct ColumnRange {
  double last = 0, least = 0, most = 0;
};

/// What a run leaves behind.
struct SweepRun {
  std::vector<ColumnRange> columns;  ///< without the time; none when nothing was recorded
  double t = 0;                      ///< of the last recorded instant, s
  long steps = 0;
  double cpu = 0;           ///< s of this thread, from building to the end
  bool failed = false;      ///< then `status` is the reason, and `columns` do not count
  bool broken_off = false;  ///< by `go_on`
  std::string status;       ///< "ok", or "stopped by 'landed'" where an event ended the run
};

/// The columns that the scene records, with their units and without rows: the time first, places of the bodies that
/// move where it asks for nothing. Throws what build() throws.
LOCKSTEP_API Table recorded_columns(const Scene&, const Registry&);

/// Builds the scene, assembles its start, runs it to its end. Every failure is a result, also columns that are not
/// those of `like`. `go_on` is asked after every step; what was recorded goes to `history` when that is given.
LOCKSTEP_API SweepRun sweep_run(const Scene&, const Registry&, const Table& like,
                                const std::function<bool(const State&)>& go_on = {}, Table* history = nullptr);

/// What a run left behind that came to its end: status "ok", steps and time of computing still to be said.
LOCKSTEP_API SweepRun recorded_run(const Table&);

/// "run,bodies.rod.mass [kg],t final [s],x final [m],x min [m],x max [m],steps,cpu [s],status", with a line end.
LOCKSTEP_API std::string sweep_header(const std::vector<Variable>&, const Table& columns);
/// One line; the cells of results are empty when the run failed.
LOCKSTEP_API std::string sweep_row(long run, const std::vector<Variable>&, const std::vector<std::size_t>& choice,
                                   const Table& columns, const SweepRun&);

}  // namespace lockstep
