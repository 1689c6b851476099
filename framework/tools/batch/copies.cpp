// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/batch.h>

#include <algorithm>
#include <cmath>

#include <lockstep/author/force.h>
#include <lockstep/author/registry.h>
#include <lockstep/detail/kernel.h>
#include <lockstep/error.h>
#include <lockstep/step_loop.h>
#include <lockstep/text.h>
#include "framework/dynamics/tree/rows_in_plane.h"
#include "framework/tools/batch/lane_run.h"

namespace lockstep {
namespace {

// Without the flag of parallel markers, which depends on numbers only.
LinkPattern pattern_of(const Lock& link) {
  LinkPattern pattern = link.pattern();
  pattern.laws |= with::parallel;
  return pattern;
}

// How mechanism b differs from the first, a; "" if it has the same topology.
std::string difference(const System& a, const System& b) {
  const auto counts = [](const std::string& what, auto x, auto y) {
    return std::to_string(y) + " " + what + " instead of " + std::to_string(x);
  };
  if (a.n_slots() != b.n_slots()) return counts("moving bodies", a.n_slots(), b.n_slots());
  if (a.links().size() != b.links().size()) return counts("joints", a.links().size(), b.links().size());
  if (a.n_states() != b.n_states()) return counts("integrated states", a.n_states(), b.n_states());
  if (a.auxiliaries().size() != b.auxiliaries().size())
    return counts("custom integrated states", a.auxiliaries().size(), b.auxiliaries().size());
  for (std::size_t k = 0; k < a.auxiliaries().size(); ++k) {
    const Auxiliary &x = *a.auxiliaries()[k], &y = *b.auxiliaries()[k];
    if (x.size() != y.size() || x.first() != y.first() || x.controls_error() != y.controls_error() ||
        x.reads_solution() != y.reads_solution() || x.vanishes_without_laws() != y.vanishes_without_laws() ||
        x.name() != y.name())
      return "states '" + y.name() + "' instead of '" + x.name() + "', or of another kind";
  }
  for (int k = 0; k < a.n_slots(); ++k)
    if (a.slot(k).freedoms != b.slot(k).freedoms)
      return "body '" + b.body_of_slot(k).name + "', which is a particle in one of them only";
  for (std::size_t i = 0; i < a.links().size(); ++i) {
    const Lock &x = *a.links()[i], &y = *b.links()[i];
    const std::string who = "joint '" + y.name() + "', ";
    if (x.type() != y.type()) return who + "which is " + std::string(y.type()) + " instead of " + std::string(x.type());
    if (a.merged(x) != b.merged(y)) return who + "which is merged into a body in one of them only";
    if (x.active_at_start() != y.active_at_start()) return who + "which is active in one of them only";
    if (a.merged(x)) continue;
    if (pattern_of(x) != pattern_of(y)) return who + "which has other constraints, laws or drives";
    const auto bodies = [](const Lock& l) {
      std::vector<int> slots;
      for (const auto& [p, s] : l.pairs()) slots.push_back(p->body->slot), slots.push_back(s->body->slot);
      return slots;
    };
    if (bodies(x) != bodies(y)) return who + "which connects other bodies";
  }
  return "";
}

// Makes the integrator of this name; empty if the registry has none.
std::function<std::unique_ptr<Integrator>()> maker(const Registry& registry, const std::string& name) {
  if (registry.integrators.find(name) == nullptr) return {};
  return [&registry, name] { return registry.integrators.make(name, Params{}, &registry, "batch"); };
}

void check(const CopiesOptions& o, const EmbeddedScheme* scheme) {
  if (scheme == nullptr)
    throw ModelError("batch: integrator \"" + o.integrator + "\" is not vectorised; use dop853, dopri5 or rk4");
  if (scheme->tableau.n_stages > Weights::kMost)
    throw ModelError("batch: integrator \"" + o.integrator + "\" has " + std::to_string(scheme->tableau.n_stages) +
                     " stages, the limit is " + std::to_string(Weights::kMost));
  if (!(o.step >= 0) || !(o.max_step >= 0) || !std::isfinite(o.step + o.max_step) ||
      (scheme->error == nullptr && o.step == 0))
    throw ModelError("batch: step " + text::brief(o.step) + " s, largest " + text::brief(o.max_step) + " s; " +
                     (scheme->error == nullptr ? o.integrator + " needs a step above 0" : "they must be 0 or more"));
  if (!(o.tolerance.relative >= 0) || !(o.tolerance.atol_x >= 0) || !(o.tolerance.relative + o.tolerance.atol_x > 0))
    throw ModelError("batch: tolerances " + text::brief(o.tolerance.relative) + " and " +
                     text::brief(o.tolerance.atol_x) + "; they must be 0 or more, and one of them above 0");
  if (o.stabilization.kind == Stabilization::Kind::baumgarte)
    throw ModelError("batch: Baumgarte stabilisation is not vectorised; use project or none");
  if (!(o.stabilization.tolerance > 0))
    throw ModelError("batch: tolerance of the constraints " + text::brief(o.stabilization.tolerance) +
                     " m; it must be above 0");
}

// Whether its rates need more than coordinates and velocities.
bool reads_solution(const Auxiliary& own, const System& system) {
  return own.reads_solution() && (!own.vanishes_without_laws() || may_have_laws(system));
}

// Why the mechanism cannot be vectorised, apart from its tree; "" if it can. The system is set up.
std::string unsuited(const System& system) {
  for (const auto& own : system.auxiliaries())
    if (reads_solution(*own, system))
      return "the states of '" + own->name() + "' read accelerations or reactions, which a batch does not keep";
  if (system.n_slots() == 0) return "nothing moves";
  for (const auto& force : system.forces()) {
    if (force->is_switched()) return "force '" + force->name() + "' is switched by events";
    if (force->reacting() != nullptr)
      return "force '" + force->name() + "' (" + std::string(force->type()) + ") reads the reactions of joints";
  }
  for (const auto& link : system.links()) {
    if (link->unilateral()) return "joint '" + link->name() + "' is one-sided, and a batch has no impacts";
    if (system.left_out(*link) != 0)
      return "redundant constraints of joint '" + link->name() + "' are left out, which a batch does not support";
  }
  if (system.held_down_to() > 0) return "nearly redundant constraints are kept, which a batch does not support";
  return "";
}

// The same of several, with their trees.
std::string unsuited(std::span<System* const> systems, Formulation formulation) {
  for (System* system : systems) {
    system->setup();
    if (std::string why = unsuited(*system); !why.empty()) return why;
  }
  if (formulation != Formulation::joint && formulation != Formulation::automatic)
    return "a batch needs joint coordinates; use formulation auto or joint";
  std::string why;
  lanes::Batch::trees_of(systems, formulation, why);
  return why;
}

template <class R, class... Of>
std::function<R(Of...)> by_caller(const std::function<R(Of...)>& act) {
  if (!act) return {};
  return [&act](Of... of) {
    try {
      return act(of...);
    } catch (...) {
      throw lanes::CallerThrew{std::current_exception()};
    }
  };
}

}  // namespace

struct Copies::Work {
  std::vector<System*> systems;
  CopiesOptions options;
  Registry own;  // if none was given
  std::function<std::unique_ptr<Integrator>()> make_integrator;
  std::unique_ptr<Integrator> method;  // whose coefficients the lanes use
  std::vector<std::unique_ptr<lanes::Batch>> batches;

  void check_states(std::span<const State> states) const {
    if (states.size() != systems.size())
      throw ModelError("batch: " + std::to_string(states.size()) + " states for " + std::to_string(systems.size()) +
                       " instances; give one for each");
    for (std::size_t i = 0; i < states.size(); ++i) {
      systems[i]->check_size(states[i]);
      if (states[i].coordinates)
        throw ModelError("batch: the state of instance " + std::to_string(i) +
                         " is in joint coordinates; convert it first (Dynamics::to_slots)");
      for (std::size_t k = 0; k < states[i].modes.size(); ++k)
        if (states[i].modes[k] != systems[i]->links()[k]->active_at_start())
          throw ModelError("batch: joint '" + systems[i]->links()[k]->name() +
                           "' is switched in a state; start with the active joints of System::start");
    }
  }
};

std::string Copies::unsuited(System& system, Formulation formulation) {
  System* const one[] = {&system};
  return lockstep::unsuited(one, formulation);
}

Copies::Copies(std::vector<System*> systems, CopiesOptions options) : work_(std::make_unique<Work>()) {
  static_assert(kLanes == lanes::kLanes);
  Work& w = *work_;
  if (options.registry == nullptr) w.own = builtin_registry();
  w.make_integrator = maker(options.registry ? *options.registry : w.own, options.integrator);
  if (w.make_integrator) w.method = w.make_integrator();
  check(options, w.method ? w.method->scheme() : nullptr);
  if (systems.empty()) throw ModelError("batch: no mechanism is given; give at least one");
  if (!w.method->info().joint)
    throw ModelError("batch: integrator \"" + options.integrator +
                     "\" does not support joint coordinates; use dop853, dopri5 or rk4");
  for (std::size_t i = 0; i < systems.size(); ++i) {
    if (!systems[i]) throw ModelError("batch: instance " + std::to_string(i) + " is null; give a mechanism");
    systems[i]->setup();
    const std::string differs = difference(*systems[0], *systems[i]);
    if (!differs.empty())
      throw ModelError("batch: instance " + std::to_string(i) + " differs from instance 0: it has " + differs +
                       "; give instances with the same bodies and joints");
  }
  if (const std::string why = lockstep::unsuited(systems, options.formulation); !why.empty())
    throw ModelError("batch: this mechanism cannot be vectorised: " + why + "; run its instances one by one");
  w.systems = std::move(systems), w.options = std::move(options);
  const std::span<System* const> all(w.systems);
  for (std::size_t i = 0; i < all.size(); i += kLanes) {
    const auto some = all.subspan(i, std::min<std::size_t>(kLanes, all.size() - i));
    w.batches.push_back(std::make_unique<lanes::Batch>(some, static_cast<int>(i), w.options));
  }
}
Copies::~Copies() = default;

int Copies::size() const { return static_cast<int>(work_->systems.size()); }
const CopiesOptions& Copies::options() const { return work_->options; }

std::vector<CopyReport> Copies::run(std::span<const State> starts, std::span<const double> times, const Output& output,
                                    const Step& step, const GoOn& go_on) {
  Work& w = *work_;
  w.check_states(starts);
  if (!std::is_sorted(times.begin(), times.end()) ||
      !std::all_of(times.begin(), times.end(), [](double t) { return std::isfinite(t); }))
    throw ModelError("batch: the times must be ascending and finite; sort them");
  for (const State& state : starts)
    if (!times.empty() && state.t > times.front())
      throw ModelError("batch: a start at " + text::number(state.t) + " s is after the first output time, " +
                       text::number(times.front()) + " s; remove the times before the starts");
  std::vector<CopyReport> reports(starts.size());
  if (times.empty()) return reports;
  const bool watches = w.method->info().passes_singular && w.options.stabilization.kind == Stabilization::Kind::project;
  const EmbeddedScheme& scheme = *w.method->scheme();
  const StepLoopOptions loop{.step = scheme.error != nullptr ? w.options.max_step : w.options.step,
                             .tolerance = w.options.tolerance,
                             .output_times = {times.begin(), times.end()},
                             .max_steps = w.options.max_steps};
  const lanes::RunTask task{w.options,       *w.method,         scheme, loop,
                            watches,         w.make_integrator, times,  by_caller(output),
                            by_caller(step), by_caller(go_on)};
  const auto run_batch = [&](lanes::Batch& batch) {
    const auto n = static_cast<std::size_t>(batch.size());
    const auto states = starts.subspan(batch.first(), n);
    const std::span<CopyReport> told(reports.data() + batch.first(), n);
    if (w.options.lanes) return lanes::LaneRun(batch, task, told).run(states);
    for (int l = 0; l < batch.size(); ++l)
      lanes::run_alone(batch.system(l), batch.first() + l, states[l], 0, StepLoopOptions().start_limit, task, told[l]);
  };
  try {
    for (const auto& batch : w.batches) run_batch(*batch);
  } catch (const lanes::CallerThrew& threw) {
    std::rethrow_exception(threw.what);
  }
  return reports;
}

}  // namespace lockstep
