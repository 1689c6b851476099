// Simulation::Loop: what the step loop remembers between two steps. Internal to Simulation.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "framework/dynamics/simulate/contacts.h"
#include "framework/dynamics/simulate/simulation.h"

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
  bool fire_due();       ///< timed events and those that were met, at the present state; whether any changed it
  void act(const Event&);
  void engage(const std::vector<std::string>& links);
  void check_links(const std::vector<std::string>& links, const std::string& cause);
  void make_consistent(const std::string& cause);
  void begin_method();

  // -- simulation_contacts.cpp: where one-sided links are hit, and where they would pull
  void begin_contacts();  ///< whom to watch; throws AssemblyError for one that starts on the wrong side
  void check_side(std::size_t contact, const std::string& cause);
  /// Gaps and pushes at the present state, where the next step begins. `moved`: since pushes were looked at.
  void note_contacts(bool moved);
  bool locate_contacts();  ///< cuts the step at the first of them; true when there was one

  // -- simulation_impacts.cpp: what happens there
  void settle_contacts();  ///< impacts, rests and releases at the present state; begins the method anew if any

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

  Contacts contacts;

 private:
  // simulation_contacts.cpp
  bool nears(std::size_t contact, const Gap& a, const Gap& b, double h) const;
  Gap gap_at(std::size_t contact, double t);
  double push_at(std::size_t contact, double t);
  double hit_between(std::size_t contact, double ta, const Gap& a, double tb, const Gap& b);
  double lowest_between(std::size_t contact, double ta, const Gap& a, double tb, const Gap& b, double& c);
  double locate_hit(double t1);
  void look_at_pushes(const State&);
  double locate_release(std::size_t contact, double t1);
  double pull_limit() const;
  // simulation_impacts.cpp
  bool find_touching();
  void impact();
  void kick_with(bool& fits, std::size_t& misfit);
  void take_impact();
  void rest();
  void put_active();
  [[noreturn]] void blame_contacts(const char* what) const;

  double contact_time = 0;            // where the present step meets a contact
  std::vector<std::size_t> released;  // the links that pull there
  std::vector<Gap> samples;           // of all contacts at one instant after the other
  std::vector<double> sample_times;
  // of an impact: the contacts that touch, their gaps before it, the rates they are to have at least, who pushes
  std::vector<std::size_t> touching;
  std::vector<Gap> hits;
  std::vector<double> aim;
  std::vector<char> active;
  VecX C, Cd, no_force, kick, impulse;
  State trial;
  std::vector<bool> modes_before;

  double value_of(std::size_t event, const State&);
  bool crosses(std::size_t event, double now) const;
  double locate(std::size_t event, double t1);
  void state_at(double t, State& out);
};

}  // namespace lockstep
