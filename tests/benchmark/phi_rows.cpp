// SPDX-License-Identifier: BSD-3-Clause
// What a joint from one function costs against the same row written by hand: gather() of one link between two (gear:
// three) free bodies, in one run, and the largest difference of their numbers. A table, and phi_rows.csv.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>

#include <spdlog/fmt/fmt.h>

#include <lockstep/author/passes.h>
#include <lockstep/couplings.h>
#include <lockstep/dynamics.h>
#include <lockstep/joints.h>
#include <lockstep/solvers.h>
#include "framework/tools/precision/work_precision.h"
#include "samples/shared/output.h"
#include "tests/support/hand_joints.h"
#include "tests/support/worst.h"

using namespace lockstep;

namespace {

struct Bench {
  System system;
  Marker *P, *S, *P2, *S2;
  explicit Bench(bool third) {
    const MassProperties mass{1.0, Vec3::Zero(), Vec3(0.1, 0.2, 0.25).asDiagonal()};
    Body& a = system.add_body("a", mass, {Vec3(0.1, 0.2, 0.3), axis_angle(Vec3(1, 2, 3), 0.4)});
    Body& b = system.add_body("b", mass, {Vec3(1.1, -0.2, 0.1), axis_angle(Vec3(-1, 0, 2), 0.3)});
    P = &system.add_marker("P", a, {Vec3(0.2, 0.1, -0.3), axis_angle(Vec3(0, 1, 1), 0.2)});
    S = &system.add_marker("S", b, {Vec3(-0.4, 0.3, 0.2), axis_angle(Vec3(1, 1, 0), -0.3)});
    if (!third) return;
    Body& c = system.add_body("c", mass, {Vec3(0.5, 1.2, 0.1), axis_angle(Vec3(0, 1, 2), 0.5)});
    P2 = &system.add_marker("P2", c, {Vec3(0.1, 0.1, 0.2), axis_angle(Vec3(1, 0, 1), 0.1)});
    S2 = &system.add_marker("S2", b, {Vec3(0.3, 0.3, -0.2), axis_angle(Vec3(0, 2, 1), 0.2)});
  }
};

using Add = std::function<void(Bench&)>;

/// One link in its scene, ready to be gathered again and again.
struct Probe {
  Bench scene;
  std::unique_ptr<Dynamics> dynamics;
  State state;
  const Inputs* inputs = nullptr;
  RowTable table;
  Probe(bool third, const Add& add) : scene(third) {
    add(scene);
    dynamics = std::make_unique<Dynamics>(scene.system, std::make_unique<SchurSolver>());
    state = scene.system.start();
    for (int i = 0; i < state.v.size(); ++i) state.v[i] = std::sin(1.0 + i);
    inputs = &dynamics->gather(state).inputs();
    passes::lay_out(scene.system, state.modes, table);
  }
  void gather() { passes::gather_rows(scene.system, *inputs, table); }
};

double difference(const Probe& a, const Probe& b) {
  const RowView x = a.table.block(a.table.entries.front()), y = b.table.block(b.table.entries.front());
  double worst = 0;
  for (int k = 0; k < x.rows(); ++k) {
    keep_worst(worst, std::abs(x.Ct(k) - y.Ct(k))), keep_worst(worst, std::abs(x.Qhat(k) - y.Qhat(k)));
    for (int i = 0; i < x.slots(); ++i)
      for (std::size_t j = 0; j < 6; ++j) keep_worst(worst, std::abs(x.J(i, k)[j] - y.J(i, k)[j]));
  }
  return worst;
}

double nanoseconds(Probe& probe) {
  long n = 0;
  const double begin = thread_seconds();
  double spent = 0;
  for (; spent < 0.01; spent = thread_seconds() - begin)
    for (int i = 0; i < 1000; ++i, ++n) probe.gather();
  return 1e9 * spent / static_cast<double>(n);
}

double median(std::vector<double> x) {
  std::nth_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2), x.end());
  return x[x.size() / 2];
}

}  // namespace

int main() {
  struct Case {
    const char* name;
    bool third;
    Add phi, hand;
  };
  const std::vector<Case> cases = {
      {"distance", false, [](Bench& s) { s.system.add<Distance>("l", *s.P, *s.S, 1.0); },
       [](Bench& s) { s.system.add<hand::Distance>("l", *s.P, *s.S, Mask::none).length = 1.0; }},
      {"universal (xyz and the row)", false, [](Bench& s) { s.system.add<Universal>("l", *s.P, *s.S); },
       [](Bench& s) { s.system.add<hand::Universal>("l", *s.P, *s.S, Mask::xyz); }},
      {"screw (x y e1 e2 and the row)", false, [](Bench& s) { s.system.add<Screw>("l", *s.P, *s.S, 0.3); },
       [](Bench& s) {
         s.system.add<hand::Screw>("l", *s.P, *s.S, Mask::x | Mask::y | Mask::e1 | Mask::e2).lead = 0.3;
       }},
      {"gear", true,
       [](Bench& s) {
         s.system.add(std::make_unique<Gear>(Attachment{"l", {{s.P, s.S}, {s.P2, s.S2}}}, 2.0));
       },
       [](Bench& s) {
         auto gear = std::make_unique<hand::Gear>("l", *s.P, *s.S, *s.P2, *s.S2);
         gear->ratio = 2.0;
         s.system.add(std::move(gear));
       }},
  };
  const std::string file = samples::output("phi_rows.csv");
  std::ofstream csv(file);
  csv << "link,phi [ns],by hand [ns],ratio,difference\n";
  fmt::print("{:32} {:>9} {:>9} {:>7} {:>11}\n", "one joint's rows", "phi, ns", "hand, ns", "ratio", "difference");
  for (const Case& c : cases) {
    Probe phi(c.third, c.phi), hand(c.third, c.hand);
    phi.gather(), hand.gather();
    std::vector<double> ratios, its, hands;
    for (int round = 0; round < 15; ++round) {
      its.push_back(nanoseconds(phi)), hands.push_back(nanoseconds(hand));
      ratios.push_back(its.back() / hands.back());
    }
    fmt::print("{:32} {:9.1f} {:9.1f} {:7.2f} {:11.2e}\n", c.name, median(its), median(hands), median(ratios),
               difference(phi, hand));
    csv << fmt::format("{},{:.1f},{:.1f},{:.2f},{:.2e}\n", c.name, median(its), median(hands), median(ratios),
                       difference(phi, hand));
  }
  fmt::print("wrote {}\n", file);
}
