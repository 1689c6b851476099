// SPDX-License-Identifier: BSD-3-Clause
// Analyses of a scene's mechanism, at its assembled start or at the present state of a run.
#include <pybind11/complex.h>

#include <lockstep/analysis.h>
#include <lockstep/equilibrium.h>
#include <lockstep/kinematics.h>
#include <lockstep/modes.h>
#include "framework/description/scene/reading.h"
#include "framework/foundation/math/limits.h"
#include "framework/hosts/python/simulation.h"
#include "framework/tools/analysis/driven_scene.h"
#include "framework/tools/analysis/linear_inputs.h"
#include "framework/tools/analysis/mechanism_at.h"
#include "framework/tools/analysis/pose_numbers.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep::python {

namespace {

/// A scene with its values, and the types that it names; a run of it is analysed at its present state.
struct Subject {
  Types& types;
  Scene scene;
  Registry registry;
  Simulation* run;
  Subject(const py::object& source, Types& its, const Settings& set, Run* of)
      : types(its),
        scene(scene_of(source, types)),
        registry(types.registry()),
        run(of == nullptr ? nullptr : &of->simulation()) {
    std::vector<std::string> texts;
    for (const auto& [name, value] : set) texts.push_back(name + "=" + value);
    computing([&] { scene = with_values(std::move(scene), registry, texts); });
  }
  std::unique_ptr<Mechanism> built() const {
    auto m = std::make_unique<Mechanism>(build_mechanism(scene, registry));
    types.check(*m);
    return m;
  }
  /// With the dynamics of matrices. `equilibrium`: at that which is found from there.
  MechanismAt at(std::unique_ptr<Mechanism> m, bool equilibrium) const {
    MechanismAt at = mechanism_at(std::move(m), registry, {});
    at.state = start_or_present(*at.mechanism, *at.dynamics, run);
    if (equilibrium)
      for (const Finding& note : find_equilibrium(*at.dynamics, at.state, {.friction = false}).notes)
        report_finding(note);
    return at;
  }
};

/// Calls `act`, alone with the run if there is one.
template <class Act>
void analysing(Run* run, Act&& act) {
  if (run != nullptr)
    run->alone(std::forward<Act>(act));
  else
    computing(std::forward<Act>(act));
}

py::tuple motion_of(const FreeMotion& m) { return py::make_tuple(m.words, m.stiffness); }

py::dict statics(const py::object& source, Types types, const Settings& set, Run* run, bool friction, bool nearest) {
  const Subject of(source, types, set, run);
  std::unique_ptr<Mechanism> made;
  std::unique_ptr<Dynamics> dynamics;
  State state;
  EquilibriumReport report;
  std::vector<std::pair<std::string, NamedReaction>> reactions;
  analysing(run, [&] {
    made = of.built();
    dynamics.reset(new Dynamics(make_dynamics(*made, of.registry)));
    state = start_or_present(*made, *dynamics, of.run);
    state.v.setZero();
    report = find_equilibrium(*dynamics, state, {.friction = friction, .nearest = nearest});
    reactions = reactions_at_rest(*dynamics, state, report, uniqueness(*dynamics, state));
  });
  py::dict bodies, joints;
  for (const auto& [name, pose] : named_poses(made->system, state))
    bodies[py::str(name)] = py::make_tuple(pose.x, numbers_of(pose.q));
  for (const auto& [name, r] : reactions)
    joints[py::str(name)] = py::make_tuple(r.body, r.wrench.force, r.wrench.moment, r.note.empty());
  const Stability& s = report.stability;
  return py::dict(py::arg("bodies") = bodies, py::arg("reactions") = joints, py::arg("t") = state.t,
                  py::arg("stability") = s.freedoms == 0 ? "no free motion" : to_string(s.kind),
                  py::arg("freedoms") = s.freedoms, py::arg("softest") = s.softest,
                  py::arg("unstable") = listed(s.unstable, motion_of),
                  py::arg("neutral") = listed(s.neutral, motion_of), py::arg("energy") = report.energy,
                  py::arg("method") = report.method(), py::arg("held_by_friction") = report.by_friction,
                  py::arg("unbalanced") = report.unbalanced, py::arg("largest_move") = report.largest_move,
                  py::arg("is_singular") = report.singular, py::arg("findings") = objects_of(report.notes));
}

/// The driven motion at these times, none: those of the scene. `inverse`: with the columns of all drives and reactions.
py::tuple driven(const py::object& source, Types types, const Settings& set, Run* run, std::vector<double> times,
                 const std::vector<std::pair<std::string, std::string>>& record, bool inverse) {
  Subject of(source, types, set, run);
  const auto table = std::make_shared<Table>();
  std::vector<ColumnRange> ranges;
  Turns turns;
  analysing(run, [&] {
    const std::vector<std::string> without = inverse ? std::vector<std::string>{} : fill_masses(of.scene);
    const std::unique_ptr<Mechanism> made = of.built();
    Mechanism& m = *made;
    for (const auto& [name, channel] : record) m.run.record.push_back({channel, name == channel ? "" : name, {}});
    record_driven(m, without, inverse);
    if (times.empty() && m.run.until <= 0)
      throw ModelError("the scene has no end time; give times=numpy.linspace(0, 1, 101), or add \"until\" to \"run\"");
    if (times.empty()) times = pose_times(m.run);
    m.events.clear();
    const std::unique_ptr<Recorder> recorder = make_recorder(m);
    recorder->find_extremes();
    Dynamics dynamics = make_dynamics(m, of.registry);
    State start = start_or_present(m, dynamics, of.run);
    refuse_driven_lock(dynamics, start);
    DrivenMotion motion(dynamics, std::move(start));
    follow(motion, dynamics, times, {recorder.get()}, [&](const Sample& s) { recorder->output(s), turns.take(); });
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

constexpr const char* kAdvice =
    "; equilibrium=True takes the static equilibrium, spin=[x, y, z] a steady rotation, frozen=True this state";

using Complex = std::complex<double>;

py::dict modes(const py::object& source, Types types, const Settings& set, Run* run, const py::object& spin,
               bool frozen, bool equilibrium, int count) {
  const Subject of(source, types, set, run);
  const ModesOptions options{.motion = motion_options(spin, frozen), .count = count};
  Modes found;
  analysing(run, [&] {
    const MechanismAt at = of.at(of.built(), equilibrium);
    found = with_advice(kAdvice, [&] { return find_modes(*at.dynamics, at.state, options); });
  });
  constexpr const char* kKinds[] = {"rigid", "oscillation", "decay", "growth"};
  py::list all;
  for (const Mode& mode : found.modes) {
    py::dict shape;
    for (const BodyShape& s : mode.shape) shape[py::str(s.body)] = py::make_tuple(s.move, s.turn);
    all.append(py::make_tuple(kKinds[static_cast<std::size_t>(mode.kind)], mode.value, mode.frequency(),
                              mode.is_marginal() ? 0.0 : mode.damping(), mode.bound, shape));
  }
  const std::vector<Complex> values = found.eigenvalues();
  return py::dict(py::arg("modes") = all,
                  py::arg("eigenvalues") = py::array_t<Complex>(static_cast<py::ssize_t>(values.size()), values.data()),
                  py::arg("freedoms") = found.freedoms, py::arg("is_complete") = found.complete,
                  py::arg("findings") = objects_of(found.notes));
}

py::tuple signal_of(const Signal& s) { return py::make_tuple(s.name, s.unit); }

py::dict linearized(const py::object& source, Types types, const Settings& set, Run* run, const py::object& spin,
                    bool frozen, bool equilibrium, const std::vector<std::string>& inputs,
                    const std::vector<std::string>& outputs) {
  const Subject of(source, types, set, run);
  const LinearMotionOptions options = motion_options(spin, frozen);
  StateSpace s;
  analysing(run, [&] {
    MechanismWithInputs built = build_with_inputs(of.scene, of.registry, inputs);
    types.check(*built.mechanism);
    const std::vector<Channel> channels = channels_of(*built.mechanism, outputs);
    const MechanismAt at = of.at(std::move(built.mechanism), equilibrium);
    s = with_advice(kAdvice, [&] { return linearize(*at.dynamics, at.state, built.inputs, channels, options); });
  });
  return py::dict(py::arg("A") = s.A, py::arg("B") = s.B, py::arg("C") = s.C, py::arg("D") = s.D,
                  py::arg("states") = listed(s.states, signal_of), py::arg("inputs") = listed(s.inputs, signal_of),
                  py::arg("outputs") = listed(s.outputs, signal_of), py::arg("accuracy") = s.accuracy,
                  py::arg("findings") = objects_of(s.notes));
}

}  // namespace

void bind_analyses(py::module_& m) {
  m.def("statics", &statics);
  m.def("driven", &driven);
  m.def("modes", &modes);
  m.def("linearize", &linearized);
}

}  // namespace lockstep::python
