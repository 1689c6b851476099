// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/integrators.h>

#include <lockstep/forces.h>
#include "tests/support/catch.h"
#include "tests/support/motions.h"

namespace linearized_motion_test {

using namespace lockstep;

// A mass on a rail, m z'' = -k z - c z': (g - f') (dq, dv) = (r_q, r_v) is a system of two by two.
TEST_CASE("the linearised motion of a mass on a spring is the one of the textbook", "[unit][integrators]") {
  const double m = 2, k = 300, c = 7;
  System system;
  Body& mass = system.add_particle("mass", m, {0, 0, 1.5});
  Marker &hook = system.add_marker("hook", mass), &anchor = system.add_marker("anchor", system.ground());
  system.add<SpringDamper>("spring", hook, anchor, {.stiffness = k, .damping = c, .free_length = 1.5});
  system.setup();
  Dynamics dynamics = dynamics_of(system);
  const State s = system.start();
  LinearizedMotion linear;
  linear.begin(s);
  linear.gather(dynamics.evaluate(s));
  using C = LinearizedMotion::Complex;
  const auto exact = [&](C g, C r_q, C r_v) {  // dv = (r_v - k/m r_q/g)/(g + c/m + k/(m g)), dq = (dv + r_q)/g
    const C dv = (r_v - k / m * r_q / g) / (g + c / m + k / (m * g));
    return std::pair<C, C>((dv + r_q) / g, dv);
  };
  VecX r = VecX::Zero(12), r_im = r, y = r, y_im = r;
  r[2] = 0.3, r[8] = -1.1, r_im[2] = -0.7, r_im[8] = 0.4;
  linear.factor(5.0);
  linear.solve(5.0, r, y);
  CHECK(y[2] == Approx(exact(5.0, 0.3, -1.1).first.real()).epsilon(1e-6));
  CHECK(y[8] == Approx(exact(5.0, 0.3, -1.1).second.real()).epsilon(1e-6));
  const C g(4, 6);
  linear.factor(g);
  linear.solve(g, r, r_im, y, y_im);
  const auto e = exact(g, C(0.3, -0.7), C(-1.1, 0.4));
  CHECK(std::abs(C(y[2], y_im[2]) - e.first) < 1e-6);
  CHECK(std::abs(C(y[8], y_im[8]) - e.second) < 1e-6);
}

}  // namespace linearized_motion_test
