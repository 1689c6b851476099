// Simulation::Loop: what the step loop remembers between two steps. Internal to Simulation.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "framework/dynamics/simulation.h"

namespace lockstep {

struct Simulation::Loop {
  explicit Loop(Simulation& simulation) : sim(simulation) {}

  // -- simulation.cpp: the run
  /// First call of a run: start checked, method begun, observers told, events of this very instant fired.
  void start();
  /// One accepted step, not past `limit`, and all that hangs on it.
  void advance(double limit, double largest);
  void observe_end();
  /// Tells the observers of the end. `quietly`: what they throw is dropped, since another error is under way.
  void finish(bool quietly);

  // -- simulation_times.cpp: where to land, what to put out
  struct Target {
    double t = 0;       ///< where the state shall stand
    double reach = 0;   ///< where the step shall end: t, or a few roundings before it (a law's jump)
    bool jump = false;  ///< a law jumps at t
  };
  Target next_target(double limit);
  double step_towards(const Target&, double largest) const;
  void cross_to(double t);
  void take_advice(double asked);
  void refresh_breakpoints(double limit, double largest);
  double output_time(long k) const;  ///< infinity: none left
  void skip_outputs_before(double t);
  void outputs_inside(double t0, double t1);
  bool output_due_at_end();
  void put_out(const Sample&);
  void output_end();  ///< the end of a run, when it is not among the output times

  // -- simulation_events.cpp: events
  void watch();          ///< remembers every condition's value at the present state
  bool locate_events();  ///< cuts the step at the first condition met; true when one was met
  void fire_due();       ///< timed events and those that were met, at the present state
  void act(const Event&);
  void engage(const std::vector<std::string>& links);
  void check_links(const std::vector<std::string>& links, const std::string& cause);
  void make_consistent(const std::string& cause);
  void begin_method();

  bool projecting() const { return sim.dynamics_.options().stabilization.kind == Stabilization::Kind::project; }
  bool fixed() const { return !adaptive; }

  Simulation& sim;
  bool adaptive = false, has_dense = false, started = false;
  State from;              ///< where the present step began
  State scratch;           ///< a state inside it
  Snapshot before, after;  ///< the method's memory around it
  StepReport step;         ///< report of the present step
  StateRate hair_rate;     ///< scratch of cross_to

  double advised = 0;  ///< the method's next step
  double anchor = 0;   ///< fixed steps: the n-th ends at anchor + n step
  long n_from_anchor = 0;
  double t_start = 0, t_end = 0;

  long next_output = 0;
  double last_output = -std::numeric_limits<double>::infinity();
  std::vector<double> breakpoints;
  std::size_t next_breakpoint = 0;
  double breakpoints_to = -std::numeric_limits<double>::infinity();

  struct Watched {
    double value = 0, now = 0;                               ///< at the beginning and the end of the present step
    double last = -std::numeric_limits<double>::infinity();  ///< when it fired last
    double at = 0;                                           ///< where the present step meets it
    bool over = false, met = false;
  };
  std::vector<Watched> watched;

 private:
  double value_of(std::size_t event, const State&);
  bool crosses(std::size_t event, double now) const;
  double locate(std::size_t event, double t1);
  void state_at(double t, State& out);
};

}  // namespace lockstep
