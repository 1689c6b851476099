// SPDX-License-Identifier: BSD-3-Clause
#include <optional>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/recorder.h>
#include <lockstep/scene.h>
#include "framework/description/scene/system_of.h"
#include "tests/fuzz/answered.h"
#include "tests/fuzz/targets.h"

namespace lockstep::fuzz {

namespace {

constexpr std::size_t kMostLines = 4;

constexpr const char* kScene = R"({"lockstep": 1, "gravity": [0, -9.81, 0],
  "parameters": {"L": "0.5 m", "n": 2},
  "bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": ["=L",0,0]}},
             {"name": "bob", "particle": 1, "position": [1,0,0]}],
  "markers": [{"name": "M", "body": "arm", "at": [0.1,0,0]}],
  "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0,0,0], "friction": {"mu": 0.1, "radius": 0.01}},
            {"name": "B", "type": "distance", "p": "bob", "s": "arm", "at_p": [1,0,0], "at_s": [0.5,0,0]}],
  "forces": [{"name": "F", "type": "spring_damper", "p": "bob", "s": "ground", "at_p": [1,0,0], "at_s": [1,1,0], "stiffness": 10}],
  "run": {"until": 1, "integrator": {"type": "dop853", "stages": "plain"}}})";

/// The scene's mechanism at its start.
class Probe {
 public:
  Probe(const Scene& scene, const Registry& registry)
      : mechanism_(build_mechanism(scene, registry)), n_states_(mechanism_.system.auxiliaries().size()) {
    system_of(mechanism_).setup();
  }
  // A quadrature is a state that is integrated along: what a channel adds is there for good.
  bool has_grown() const { return mechanism_.system.auxiliaries().size() != n_states_; }

  void read(const std::string& name, const Registry& registry) {
    const Channel made = make_channel(system_of(mechanism_), name);
    if (!made.value) throw Broken{"a channel without a value"};
    if (has_grown()) system_of(mechanism_).setup();
    Dynamics dynamics(system_of(mechanism_), make_solver(mechanism_.run, registry));
    const State state = mechanism_.system.start();
    const StepReport report;
    const Sample sample(dynamics, state, report);
    if (made.memory) made.memory->start(sample);
    must_be_finite(made.value(sample), "channel " + name);
  }

 private:
  Mechanism mechanism_;
  std::size_t n_states_;
};

void one(const std::string& line, const Scene& scene, const Registry& registry) {
  static std::optional<Probe> probe;
  if (!probe || probe->has_grown()) probe.emplace(scene, registry);
  answered([&] { probe->read(line, registry); });
  answered([&] { read_method_spec(line, types_of(registry.integrators)); });
  if (line.find('=') == std::string::npos) return;
  answered([&] {
    const Variable variable = read_variable(line, scene, registry);
    if (variable.values.empty()) throw Broken{"a variable without values"};
    vary_scene(scene, {variable}, {variable.values.size() - 1}, registry);
  });
  answered([&] { set_in_scene(scene, {line}, registry); });
}

}  // namespace

void channel(Bytes bytes) {
  static const Registry registry = builtin_registry();
  static const Scene scene = scene_from_text(kScene, "fuzz.json");
  const std::string text = text_of(bytes);
  std::size_t lines = 0;
  for (std::size_t at = 0; at <= text.size() && lines < kMostLines; ++lines) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    one(text.substr(at, end - at), scene, registry);
    at = end + 1;
  }
}

}  // namespace lockstep::fuzz
