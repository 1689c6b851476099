// SPDX-License-Identifier: BSD-3-Clause
// lockstep itself, by its public interface. Words of its own: --scenes FOLDER (where bench_*.json are; the long ones
// are written on the way), --solver NAME and --planar VALUE (each repeatable: one more variant each), --integrator
// NAME or NAME{"key": value} (repeatable: only these), --plugin NAME (repeatable).
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/lockstep.h>
#include "framework/description/scene/json.h"
#include "framework/description/scene/system_of.h"
#include "tests/benchmark/peers/measure.h"
#include "tests/benchmark/peers/scenes.h"

namespace lockstep::peers {

namespace {

/// What is tried as far as the registry has it, the likeliest first: name, and its keys as JSON.
const std::vector<std::string> kIntegrators = {"dop853",
                                               R"(dop853{"fixed": true})",
                                               "dopri5",
                                               R"(dopri5{"fixed": true})",
                                               "rk4",
                                               "rattle2",
                                               "rattle4",
                                               "radau5",
                                               "generalized_alpha",
                                               "semi_implicit_euler"};
/// On loops before all others: they may have singular positions.
const std::vector<std::string> kOnLoops = {
    R"(dop853{"stages": "auto"})",
    R"(dopri5{"stages": "auto"})",
    R"(dop853{"stages": "manifold"})",
    R"(dop853{"fixed": true, "stages": "manifold"})",
};

/// One way to run a mechanism.
struct Method {
  MethodSpec integrator;
  std::string solver, planar;  ///< "": the scene's own
  Stabilization::Kind stabilization = Stabilization::Kind::project;
  bool dense = false;  ///< sampled at the report times; else at the steps' ends
  std::string name;
  IntegratorInfo info{};
  double setting = 0;  ///< step or tolerance
};

class SceneSource {
 public:
  SceneSource(std::string folder, const Mechanism& m) : mechanism_(m), path_(folder + "/" + scene_name(m) + ".json") {}

  Scene scene(const Method& method) const {
    Value root = std::filesystem::exists(path_) ? read_json_file(path_) : read_json(scene_text(mechanism_), path_);
    if (!method.planar.empty()) {
      root = root.without({"planar"});
      root.object()->push_back({"planar", Value(method.planar), {}});
    }
    Scene scene = scene_from(std::move(root), path_);
    scene.run.integrator = method.integrator;
    if (!method.solver.empty()) scene.run.solver = {method.solver};
    scene.run.stabilization.kind = method.stabilization;
    if (method.info.adaptive)
      scene.run.tolerance = {method.setting, 1e-2 * method.setting};
    else
      scene.run.step = method.setting;
    return scene;
  }

 private:
  const Mechanism& mechanism_;
  std::string path_;
};

/// x and v of the mass centres, world axes.
Motions motions(const System& system, const State& state) {
  Motions all;
  for (const Body& body : system.bodies()) {
    if (body.fixed || &body == &system.bodies().front()) continue;
    const Pose p = body_pose(body, state);
    const Twist t = body_twist(body, state);
    const Mat3 R = rotation(p.q);
    const Vec3 w = R * t.w, arm = R * body.mass.center;
    all.push_back({p.x + arm, R, t.v + cross(w, arm), w});
  }
  return all;
}

/// Looks at the states that the method is judged by: at the steps' ends, or with `dense` at the report times, as the
/// method's own dense output has them.
class Watch final : public Observer {
 public:
  Watch(Run& run, const Integrator* dense, bool reactions) : run_(run), dense_(dense), reactions_(reactions) {}
  void start(const Sample& s) override {
    inside_ = s.state;
    look(s.system(), s.state);
  }
  void step(const Sample& s) override {
    if (reactions_) s.values();
    if (dense_)
      reports_inside(s);
    else
      look(s.system(), s.state);
    if (++n_steps_ % 64 == 0) run_.check_time();
  }

 private:
  void reports_inside(const Sample& s) {
    const double length = run_.mechanism.until;
    for (; n_seen_ <= kReports; ++n_seen_) {
      const double t = length * n_seen_ / kReports;
      if (t > s.state.t + 1e-12 * length) return;
      const bool at_end = t > s.state.t - 1e-12 * length;
      if (!at_end && !dense_->dense(t, inside_)) throw StepError("no dense output inside the last step", t);
      look(s.system(), at_end ? s.state : inside_);
    }
  }
  void look(const System& system, const State& state) {
    if (run_.sampled)
      run_.sample(state.t, motions(system, state));
    else
      last_ = state;
  }

  Run& run_;
  const Integrator* dense_;
  bool reactions_;
  long n_steps_ = 0;
  int n_seen_ = 1;  // report times, the start among them
  State inside_, last_;
};

void simulate(Run& run, const SceneSource& source, const Registry& registry, const Method& method) {
  lockstep::Mechanism mechanism = build_mechanism(source.scene(method), registry);
  const RunSettings& settings = mechanism.run;
  Dynamics dynamics(system_of(mechanism), make_solver(settings, registry), {settings.formulation, settings.stabilization});
  State start = mechanism.system.start();
  if (settings.assemble) assemble(dynamics, start, mechanism.start_speeds);
  StepLoop simulation(dynamics, make_integrator(settings, registry),
                        {.step = settings.step, .tolerance = settings.tolerance});
  simulation.set_state(start);
  Watch watch(run, method.dense ? &simulation.integrator() : nullptr, run.mechanism.kind == Kind::slider_crank);
  simulation.add_observer(watch);
  const WorkCount before = dynamics.work();
  run.start_clock();
  const SimulationReport& report = simulation.run_until(run.mechanism.until);
  run.stop_clock();
  run.steps = report.steps;
  if (!(report.largest_violation <= run.violation)) run.violation = report.largest_violation;
  run.note = "evaluations=" + std::to_string(dynamics.work().evaluations - before.evaluations) +
             " rejected=" + std::to_string(report.rejected) + " solver=" + std::string(dynamics.solver().name());
}

/// "dop853{...}" as a name with keys.
MethodSpec typed(const std::string& text) {
  const std::size_t brace = text.find('{');
  MethodSpec t{text.substr(0, brace)};
  if (brace != std::string::npos) t.keys = read_json(text.substr(brace), "--integrator");
  return t;
}

/// Commas part the columns of the CSV.
std::string column_name(std::string text) {
  std::string name;
  for (const char c : text)
    if (c != '"' && c != ' ') name += c == ',' ? ';' : c;
  return name;
}

/// What the integrator says of itself, when the registry has it, takes its keys, and it can begin on this mechanism;
/// and whether it has dense output.
struct Trial {
  IntegratorInfo info;
  bool dense = false;
};
std::optional<Trial> trial(const SceneSource& source, const Registry& registry, Method method) {
  try {
    method.info.adaptive = false;  // a step, should it need one; an adaptive method takes it as the largest
    method.setting = 1e-3;
    lockstep::Mechanism mechanism = build_mechanism(source.scene(method), registry);
    const std::unique_ptr<Integrator> integrator = make_integrator(mechanism.run, registry);
    Dynamics dynamics(system_of(mechanism), make_solver(mechanism.run, registry),
                      {mechanism.run.formulation, mechanism.run.stabilization});
    State start = mechanism.system.start(), inside = start;
    if (mechanism.run.assemble) assemble(dynamics, start, mechanism.start_speeds);
    integrator->begin(dynamics, start);
    return Trial{integrator->info(), integrator->dense(start.t, inside)};
  } catch (const Error& e) {
    std::fprintf(stderr, "lockstep %s: left out: %s\n", method.name.c_str(), e.what());
    return std::nullopt;
  }
}

class Ours {
 public:
  Ours(int argc, char** argv) : bench_("lockstep", argc, argv), registry_(builtin_registry()) {
    folder_ = bench_.word("--scenes");
    for (const std::string& plugin : bench_.all_words("--plugin")) load_plugin(registry_, plugin);
    integrators_ = bench_.all_words("--integrator");
    solvers_ = or_else(bench_.all_words("--solver"), {""});
    planar_ = or_else(bench_.all_words("--planar"), {""});
  }

  void run() {
    for (const Mechanism& m : all_mechanisms()) {
      if (!bench_.wants(m)) continue;
      for (const std::string& planar : planar_)
        for (const std::string& solver : solvers_)
          for (const std::string& integrator : integrators_for(m)) try_method(m, integrator, solver, planar);
    }
  }

 private:
  static std::vector<std::string> or_else(std::vector<std::string> given, const std::vector<std::string>& standard) {
    return given.empty() ? standard : given;
  }

  std::vector<std::string> integrators_for(const Mechanism& m) const {
    if (!integrators_.empty()) return integrators_;
    std::vector<std::string> names = has_loops(m) ? kOnLoops : std::vector<std::string>();
    names.insert(names.end(), kIntegrators.begin(), kIntegrators.end());
    return names;
  }

  void try_method(const Mechanism& m, const std::string& integrator, const std::string& solver,
                  const std::string& planar) {
    Method method;
    method.integrator = typed(integrator);
    method.solver = solver;
    method.planar = planar;
    method.name = column_name(integrator) + (solver.empty() ? "" : "@" + solver) +
                  (planar.empty() ? "" : "+planar(" + planar + ")");
    if (!bench_.wants(m, method.name)) return;
    const SceneSource source(folder_, m);
    const std::optional<Trial> known = trial(source, registry_, method);
    if (!known) return;
    method.info = known->info;
    sweep(m, source, method);
    if (!known->dense) return;
    method.dense = true;
    method.name += "+dense";
    sweep(m, source, method);
  }

  void sweep(const Mechanism& m, const SceneSource& source, const Method& method) {
    const auto make = [&](double setting) {
      Method set = method;
      set.setting = setting;
      return [this, &source, set](Run& run) { simulate(run, source, registry_, set); };
    };
    if (method.info.adaptive)
      bench_.sweep(m, method.name, tolerance_ladder(), make, 1.0 / method.info.order);
    else
      bench_.sweep(m, method.name, step_ladder(m), make);
  }

  Bench bench_;
  Registry registry_;
  std::string folder_;
  std::vector<std::string> integrators_, solvers_, planar_;
};

}  // namespace

}  // namespace lockstep::peers

int main(int argc, char** argv) {
  lockstep::peers::Ours(argc, argv).run();
  return 0;
}
