// SPDX-License-Identifier: BSD-3-Clause
// The energy of the double pendulum over a long run, method by method: how far it swings, and how fast it drifts; CSV.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/lockstep.h>
#include <lockstep/recorder.h>
#include "framework/description/scene/system_of.h"
#include "framework/tools/precision/work_precision.h"
#include "samples/shared/output.h"
#include "tests/support/paths.h"

using namespace lockstep;

namespace {

constexpr double kLength = 1000;  // s

struct Way {
  const char* method;
  Value keys;
  double h;          // s; the largest step of adaptive ones: 0, none
  double tolerance;  // of adaptive ones
};

struct Drift {
  double swing = 0;  ///< J, largest distance from the start
  double rate = 0;   ///< J/s: mean over the last tenth less that over the first
  double cpu = 0;    ///< s
  std::string failure{};
};

class Watch final : public Observer {
 public:
  explicit Watch(Channel energy) : energy_(std::move(energy)) {}
  void step(const Sample& s) override {
    if (n_++ % 20 != 0) return;
    const double e = energy_.value(s);
    if (n_ == 1) start_ = e;
    swing = std::max(swing, std::abs(e - start_));
    if (s.state.t < 0.1 * kLength) first_ += e, ++n_first_;
    if (s.state.t > 0.9 * kLength) last_ += e, ++n_last_;
  }
  double rate() const { return n_last_ > 0 ? (last_ / n_last_ - first_ / n_first_) / (0.9 * kLength) : 0; }
  double swing = 0;

 private:
  Channel energy_;
  long n_ = 0;
  double start_ = 0, first_ = 0, last_ = 0, n_first_ = 0, n_last_ = 0;
};

Drift drift_of(const Way& way) {
  const Registry registry = builtin_registry();
  Scene scene = read_scene(fmt::format("{}/double_pendulum.json", paths::kScenes));
  scene.run.integrator = {way.method, way.keys};
  scene.run.step = way.h;
  if (way.tolerance > 0) scene.run.tolerance = {way.tolerance, 1e-2 * way.tolerance};
  Mechanism m = build_mechanism(scene, registry);
  Dynamics dynamics(system_of(m), make_solver(m.run, registry), {m.run.formulation, m.run.stabilization});
  StepLoop sim(dynamics, make_integrator(m.run, registry),
                 {.step = way.h, .tolerance = m.run.tolerance, .output = kLength});
  Watch watch(make_channel(system_of(m), "energy.total"));
  sim.add_observer(watch);
  Drift d;
  const double begin = thread_seconds();
  try {
    sim.run_until(kLength);
  } catch (const Error& error) {
    d.failure = error.what();
  }
  d.cpu = thread_seconds() - begin, d.swing = watch.swing, d.rate = watch.rate();
  return d;
}

}  // namespace

int main() {
  const Value none = Value(Value::Object{}), fixed = Value::object({{"fixed", true}});
  const std::string file = samples::output("energy_drift.csv");
  std::ofstream csv(file);
  csv << "method,step [s],tolerance,largest change of energy [J],drift [J/s],CPU [s]\n";
  fmt::print("{:22} {:>8} {:>9} {:>12} {:>12} {:>8}\n", "method", "step", "tolerance", "swing [J]", "drift [J/s]",
             "CPU [s]");
  for (const Way& w :
       {Way{"semi_implicit_euler", none, 0.005, 0}, Way{"rk4", none, 0.005, 0}, Way{"dopri5", fixed, 0.01, 0},
        Way{"dop853", fixed, 0.02, 0}, Way{"dopri5", none, 0, 1e-6}, Way{"dop853", none, 0, 1e-6},
        Way{"dop853", none, 0, 1e-10}, Way{"generalized_alpha", none, 0.005, 0}, Way{"radau5", none, 0, 1e-6},
        Way{"rattle2", none, 0.005, 0}, Way{"rattle4", none, 0.005, 0}, Way{"rattle4", none, 0.01, 0}}) {
    const Drift d = drift_of(w);
    const std::string name = std::string(w.method) + (w.keys.find("fixed") != nullptr ? ", fixed" : "");
    fmt::print("{:22} {:>8g} {:>9g} {:>12.3g} {:>12.3g} {:>8.3g} {}\n", name, w.h, w.tolerance, d.swing, d.rate, d.cpu,
               d.failure);
    csv << fmt::format("\"{}\",{:g},{:g},{:.4g},{:.4g},{:.3g}\n", name, w.h, w.tolerance, d.swing, d.rate, d.cpu);
  }
  fmt::print("{}\n", file);
}
