// One-sided links against closed forms: bounces, their energy and their end, rests and releases.
#include <boost/math/special_functions/ellint_1.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "framework/lockstep.h"
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"

using namespace lockstep;

namespace {

constexpr double kG = 9.81;

/// A particle of 0.5 kg above a plane.
struct Ball {
  System system{{{0, 0, -kG}}};
  Body* body;
  PointOnPlane* floor;
  Ball(double height, OneSided one_sided) {
    body = &system.add_particle("ball", 0.5, {0, 0, height});
    floor = &system.add<PointOnPlane>("floor", system.add_marker("P", *body), system.add_marker("S", system.ground()));
    floor->one_sided = one_sided;
  }
};

/// Height of a ball that falls from h and bounces with e for ever.
double bouncing(double h, double e, double t) {
  double v = std::sqrt(2 * kG * h), from = v / kG;
  if (t < from) return h - 0.5 * kG * t * t;
  for (int k = 0; k < 2000; ++k) {
    v *= e;
    const double flight = 2 * v / kG;
    if (t < from + flight) return v * (t - from) - 0.5 * kG * (t - from) * (t - from);
    from += flight;
  }
  return 0;
}

/// Marks the ends of steps at which a link is hit: the instant, and the observed state just before.
struct Instants : Observer {
  std::vector<double> times;
  long seen = 0;
  const Simulation* simulation = nullptr;
  double before = 0;
  void step(const Sample& s) override {
    if (simulation->report().impacts > seen) times.push_back(before), seen = simulation->report().impacts;
    before = s.state.t;
  }
};

struct Way {
  std::string method;
  double step, tolerance, error;
};

Simulation simulate(Dynamics& dynamics, const Way& way, double output = 0) {
  const Registry registry = builtin_registry();
  SimulationOptions options;
  options.step = way.step, options.tolerance = {way.tolerance, 1e-2 * way.tolerance}, options.output = output;
  return Simulation(dynamics, registry.integrators.make(way.method, {}, &registry, "method"), options);
}

}  // namespace

TEST_CASE("a ball bounces to rest at the instant of the closed form", "[verification][impacts]") {
  const double h = 1, e = 0.8, fall = std::sqrt(2 * h / kG), end = fall * (1 + e) / (1 - e);
  const auto way = GENERATE(Way{"dop853", 0, 1e-10, 1e-9}, Way{"dopri5", 0, 1e-8, 1e-8}, Way{"rk4", 1e-2, 1e-6, 1e-9},
                            Way{"radau5", 0, 1e-8, 1e-8}, Way{"rattle2", 1e-2, 1e-6, 1e-9},
                            Way{"generalized_alpha", 1e-3, 1e-6, 1e-8});
  CAPTURE(way.method);
  Ball ball(h, {e, 1e-4});
  Recorder recorder(ball.system,
                    {"ball.z", "floor.in_contact", "floor.impact_loss", "energy.balance", "floor.lambda_z"});
  Dynamics dynamics(ball.system, std::make_unique<SchurSolver>());
  Simulation simulation = simulate(dynamics, way, 0.05);
  simulation.add_observer(recorder);
  const SimulationReport& report = simulation.run_until(6);
  const Table& t = recorder.table();
  double worst = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i)
    worst = std::max(worst, std::abs(t["ball.z"][i] - bouncing(h, e, t["t"][i])));
  CHECK(worst < way.error);
  // bounces that leave more than the rest speed, and the last
  const int bounces = static_cast<int>(std::log(1e-4 / std::sqrt(2 * kG * h)) / std::log(e)) + 1;
  CHECK(std::abs(report.impacts - bounces) <= (way.error > 1e-6 ? 1 : 0));
  CHECK(end < 4.1);
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    if (t["t"][i] < end - 1e-3) CHECK(t["floor.in_contact"][i] == 0);
    if (t["t"][i] > end + 1e-3) {
      CHECK(t["floor.in_contact"][i] == 1);
      CHECK(t["floor.lambda_z"][i] == Approx(-0.5 * kG));
    }
  }
  CHECK(t["floor.impact_loss"].back() == Approx(0.5 * kG * h).epsilon(way.error > 1e-6 ? 1e-2 : 1e-7));
  if (way.error < 1e-6)
    for (const double b : t["energy.balance"]) CHECK(std::abs(b) < 1e-8);
}
