// SPDX-License-Identifier: BSD-3-Clause
// Analyses of a scene's mechanism, at its assembled start or at the present state of a run.
#include <pybind11/complex.h>

#include <algorithm>

#include <lockstep/analysis.h>
#include <lockstep/equilibrium.h>
#include <lockstep/kinematics.h>
#include <lockstep/modes.h>
#include "framework/description/scene/with_values.h"
#include "framework/foundation/math/limits.h"
#include "framework/hosts/python/simulation.h"
#include "framework/tools/analysis/driven_scene.h"
#include "framework/tools/analysis/linear_inputs.h"
#include "framework/tools/analysis/pose_numbers.h"
#include "framework/tools/rank/cause.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep::python {

namespace {

/// A scene with its values, and the types that it names.
struct Subject {
  Registry registry;
  Scene scene;
  Subject(const py::object& source, Types& types, const Settings& set) : scene(scene_of(source, types)) {
    registry = types.registry();
    computing([&] { scene = with_values(std::move(scene), registry, set); });
  }
};

// The states of an auxiliary that both mechanisms have; others keep their start.
void take_states(const System& from, const State& given, const System& to, State& state) {
  for (const auto& mine : to.auxiliaries())
    for (const auto& other : from.auxiliaries())
      if (other->name() == mine->name() && other->size() == mine->size())
        state.s.segment(mine->first(), mine->size()) = given.s.segment(other->first(), other->size());
}

/// Calls `act`, alone with the run if there is one.
template <class Act>
void analysing(Run* run, Act&& act) {
  if (run != nullptr)
    run->alone(std::forward<Act>(act));
  else
    computing(std::forward<Act>(act));
}

/// The assembled start in the slots' own coordinates, or the present state of a run of the same scene.
State state_of(Dynamics& dynamics, Mechanism& m, Run* run) {
  if (run != nullptr)
    for (ControlInput& input : system_of(m).control_inputs()) input.set(run->simulation().input(input.name()).value());
  State state = assembled_start(dynamics, m);
  dynamics.to_slots(state);
  if (run == nullptr) return state;
  State now = run->simulation().dynamics().in_slots(run->simulation().state());
  take_states(run->simulation().system(), now, m.system, state);
  now.s = state.s;
  if (now.q.size() != state.q.size() || now.z.size() != state.z.size())
    throw ModelError("the run was changed after its scene was read; analyse a scene that has these changes");
  return now;
}

/// Dynamics for matrices: six velocities a body, without stabilisation.
std::unique_ptr<Dynamics> plain_dynamics(Mechanism& m, const Registry& registry) {
  return std::make_unique<Dynamics>(
      system_of(m), make_solver(m.run, registry),
      DynamicsOptions{.formulation = Formulation::omega, .stabilization = {.kind = Stabilization::Kind::none}});
}

py::list motions_of(const std::vector<FreeMotion>& motions) {
  py::list all;
  for (const FreeMotion& m : motions) all.append(py::make_tuple(m.words, m.stiffness));
  return all;
}

py::dict statics(const py::object& source, Types types, const Settings& set, Run* run, bool friction, bool nearest) {
  Subject of(source, types, set);
  Mechanism m;
  std::unique_ptr<Dynamics> dynamics;
  State state;
  EquilibriumReport report;
  std::vector<std::pair<std::string, NamedReaction>> reactions;
  UniquenessReport unique;
  analysing(run, [&] {
    m = build_mechanism(of.scene, of.registry);
    dynamics.reset(new Dynamics(make_dynamics(m, of.registry)));
    state = state_of(*dynamics, m, run);
    state.v.setZero();
    report = find_equilibrium(*dynamics, state, {.friction = friction, .nearest = nearest});
    const VecX none = VecX::Zero(6 * m.system.n_slots());
    const Evaluation& e = dynamics->gather(state);
    reactions = reactions_of(m.system, {e.inputs(), none, report.lambda, e.rows()});
    unique = uniqueness(*dynamics, state);
  });
  py::dict bodies, joints;
  for (const auto& [name, pose] : named_poses(m.system, state)) {
    const std::array<double, 4> q{pose.q.w, pose.q.x, pose.q.y, pose.q.z};
    bodies[py::str(name)] = py::make_tuple(array_of(pose.x), py::array_t<double>(4, q.data()));
  }
  for (const auto& [name, r] : reactions) {
    const auto is_of = [&, start = name + "."](const std::string& channel) { return channel.starts_with(start); };
    const double least = kNegligible * report.largest_force;
    const auto rounded = [](const Vec3& x, double zero) {
      return array_of(Vec3(x.unaryExpr([zero](double each) { return std::abs(each) <= zero ? 0 : each; })));
    };
    joints[py::str(name)] =
        py::make_tuple(r.body, rounded(r.wrench.force, least), rounded(r.wrench.moment, least * m.system.length()),
                       r.note.empty() && std::ranges::none_of(unique.channels, is_of));
  }
  const Stability& s = report.stability;
  return py::dict(py::arg("bodies") = bodies, py::arg("reactions") = joints, py::arg("t") = state.t,
                  py::arg("stability") = s.freedoms == 0 ? "no free motion" : to_string(s.kind),
                  py::arg("freedoms") = s.freedoms, py::arg("softest") = s.softest,
                  py::arg("unstable") = motions_of(s.unstable), py::arg("neutral") = motions_of(s.neutral),
                  py::arg("energy") = report.energy, py::arg("method") = report.method(),
                  py::arg("held_by_friction") = report.by_friction, py::arg("unbalanced") = report.unbalanced,
                  py::arg("largest_move") = report.largest_move, py::arg("is_singular") = report.singular,
                  py::arg("findings") = objects_of(report.notes));
}

/// The driven motion at these times, none: those of the scene. `inverse`: with the columns of all drives and reactions.
py::tuple driven(const py::object& source, Types types, const Settings& set, Run* run, std::vector<double> times,
                 const std::vector<std::pair<std::string, std::string>>& record, bool inverse) {
  Subject of(source, types, set);
  const auto table = std::make_shared<Table>();
  std::vector<ColumnRange> ranges;
  analysing(run, [&] {
    const std::vector<std::string> without = inverse ? std::vector<std::string>{} : fill_masses(of.scene);
    Mechanism m = build_mechanism(of.scene, of.registry);
    for (const auto& [name, channel] : record) m.run.record.push_back({channel, name == channel ? "" : name, {}});
    record_places(m);
    if (times.empty() && m.run.until <= 0)
      throw ModelError("the scene has no end time; give times=numpy.linspace(0, 1, 101), or add \"until\" to \"run\"");
    if (times.empty()) times = pose_times(m.run);
    if (!without.empty()) refuse_columns_of_masses(m, without);
    if (inverse) record_reactions(m);
    refuse_integrated_columns(m);
    m.events.clear();
    const std::unique_ptr<Recorder> recorder = make_recorder(m);
    recorder->find_extremes();
    Dynamics dynamics = make_dynamics(m, of.registry);
    State start = state_of(dynamics, m, run);
    refuse_driven_lock(dynamics, start);
    DrivenMotion motion(dynamics, std::move(start));
    const StepReport none;
    try {
      for (const double& t : times) {
        const DrivenMotion before = motion;
        motion.to(t);
        const Sample sample(dynamics, motion.state(), none);
        if (&t == &times.front())
          recorder->start(sample);
        else
          recorder->inside(BetweenPoses(before, dynamics, sample)), recorder->step(sample);
        recorder->output(sample);
      }
    } catch (const Error& error) {
      rethrow_with(cause_of_stop(dynamics, motion.state()), error);
    }
    ranges.assign(recorder->ranges().begin(), recorder->ranges().end());
    *table = recorder->table();
  });
  return py::make_tuple(of.scene.title, columns_of(table, ranges));
}

LinearMotionOptions motion_options(const py::object& spin, bool frozen) {
  LinearMotionOptions options{.frozen = frozen};
  if (!spin.is_none()) options.spin = vec3_of(spin, "spin");
  return options;
}

/// Calls an analysis, and names the arguments that help against its errors.
template <class Analysis>
auto with_words_of_python(Analysis&& analysis) {
  try {
    return analysis();
  } catch (const ModelError& error) {
    const std::string words = error.what();
    const std::size_t advice = words.find("; use an equilibrium");
    if (advice == std::string::npos) throw;
    throw ModelError(words.substr(0, advice) +
                     "; equilibrium=True takes the static equilibrium, spin=[x, y, z] a steady rotation, "
                     "frozen=True this state");
  }
}

/// The state for a linearisation. `equilibrium`: that which is found from there.
State linear_state(Dynamics& dynamics, Mechanism& m, Run* run, bool equilibrium) {
  State state = state_of(dynamics, m, run);
  if (equilibrium)
    for (const Finding& note : find_equilibrium(dynamics, state, {.friction = false}).notes) report_finding(note);
  return state;
}

using Complex = std::complex<double>;
py::array_t<Complex> array_of(const Eigen::Vector3cd& v) { return py::array_t<Complex>(3, v.data()); }

py::dict modes(const py::object& source, Types types, const Settings& set, Run* run, const py::object& spin,
               bool frozen, bool equilibrium, int count) {
  Subject of(source, types, set);
  const ModesOptions options{.motion = motion_options(spin, frozen), .count = count};
  Modes found;
  analysing(run, [&] {
    Mechanism m = build_mechanism(of.scene, of.registry);
    const std::unique_ptr<Dynamics> dynamics = plain_dynamics(m, of.registry);
    const State state = linear_state(*dynamics, m, run, equilibrium);
    found = with_words_of_python([&] { return find_modes(*dynamics, state, options); });
  });
  constexpr const char* kKinds[] = {"rigid", "oscillation", "decay", "growth"};
  py::list all;
  for (const Mode& mode : found.modes) {
    py::dict shape;
    for (const BodyShape& s : mode.shape) shape[py::str(s.body)] = py::make_tuple(array_of(s.move), array_of(s.turn));
    all.append(py::make_tuple(kKinds[static_cast<std::size_t>(mode.kind)], mode.value, mode.frequency(),
                              mode.is_marginal() ? 0.0 : mode.damping(), mode.bound, shape));
  }
  const std::vector<Complex> values = found.eigenvalues();
  return py::dict(py::arg("modes") = all,
                  py::arg("eigenvalues") = py::array_t<Complex>(static_cast<py::ssize_t>(values.size()), values.data()),
                  py::arg("freedoms") = found.freedoms, py::arg("is_complete") = found.complete,
                  py::arg("findings") = objects_of(found.notes));
}

py::list signals_of(const std::vector<Signal>& signals) {
  py::list all;
  for (const Signal& s : signals) all.append(py::make_tuple(s.name, s.unit));
  return all;
}

py::dict linearized(const py::object& source, Types types, const Settings& set, Run* run, const py::object& spin,
                    bool frozen, bool equilibrium, const std::vector<std::string>& inputs,
                    const std::vector<std::string>& outputs) {
  Subject of(source, types, set);
  const LinearMotionOptions options = motion_options(spin, frozen);
  StateSpace s;
  analysing(run, [&] {
    const MechanismWithInputs built = build_with_inputs(of.scene, of.registry, inputs);
    Mechanism& m = *built.mechanism;
    std::vector<Channel> channels;
    for (const std::string& name : outputs) {
      const auto own = std::ranges::find(m.run.record, name, &ChannelRequest::column);
      channels.push_back(make_channel(system_of(m), own != m.run.record.end() ? own->channel : name));
      channels.back().name = name;
    }
    const std::unique_ptr<Dynamics> dynamics = plain_dynamics(m, of.registry);
    const State state = linear_state(*dynamics, m, run, equilibrium);
    s = with_words_of_python([&] { return linearize(*dynamics, state, built.inputs, channels, options); });
  });
  return py::dict(py::arg("A") = matrix_of(s.A), py::arg("B") = matrix_of(s.B), py::arg("C") = matrix_of(s.C),
                  py::arg("D") = matrix_of(s.D), py::arg("states") = signals_of(s.states),
                  py::arg("inputs") = signals_of(s.inputs), py::arg("outputs") = signals_of(s.outputs),
                  py::arg("accuracy") = s.accuracy, py::arg("findings") = objects_of(s.notes));
}

}  // namespace

void bind_analyses(py::module_& m) {
  m.def("statics", &statics);
  m.def("driven", &driven);
  m.def("modes", &modes);
  m.def("linearize", &linearized);
}

}  // namespace lockstep::python
