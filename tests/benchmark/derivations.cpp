// SPDX-License-Identifier: BSD-3-Clause
// The paper's own claim as a chart: rows and right side of the lock derived in four ways, cost against error of the
// rows and of a trajectory. CSV and pictures.
#include <fstream>
#include <limits>

#include <spdlog/fmt/fmt.h>

#include <lockstep/assembly.h>
#include "framework/tools/precision/work_precision.h"
#include <lockstep/solvers.h>
#include <lockstep/joints.h>
#include <lockstep/charts.h>
#include <lockstep/integrators.h>
#include "samples/shared/output.h"
#include "tests/support/derivations.h"
#include "tests/support/lock_checks.h"
#include "tests/support/paths.h"

using namespace lockstep;
using namespace lockstep::derivations;

namespace {

constexpr double kFloor = 1e-16;  // where stems begin

// --- rows -----------------------------------------------------------------------------------------------------------

/// ns of one lock with all laws, and its largest error against 60 digits, of rows, Ct and right side.
struct RowResult {
  double ns = 0, error_J = 0, error_Qhat = 0;
};

template <class F>
double nanoseconds(F&& once) {
  double best = std::numeric_limits<double>::infinity(), sum = 0;
  for (int repeat = 0; repeat < 7; ++repeat) {
    long n = 0;
    const double begin = thread_seconds();
    double spent = 0;
    for (; spent < 0.03; spent = thread_seconds() - begin)
      for (int i = 0; i < 100; ++i, ++n) sum += once();
    best = std::min(best, 1e9 * spent / static_cast<double>(n));
  }
  volatile double keep = sum;  // so that nothing is optimised away
  (void)keep;
  return best;
}

RowResult measure_rows(Way way, const oracle::LockChecks& checks, const Steps& steps) {
  RowResult result;
  std::vector<Place> places;
  for (const oracle::LockCheck& check : checks.entries) {
    places.push_back(place(check.input));
    const Rows r = rows(way, places.back(), steps);
    result.error_J = std::max(result.error_J, (r.J - check.at("J")).cwiseAbs().maxCoeff());
    result.error_Qhat = std::max(result.error_Qhat, (r.Qhat - check.at("Qhat")).cwiseAbs().maxCoeff());
  }
  const oracle::Configuration& c = checks.entries.front().input;
  Place in = places.front();
  oracle::Configuration moved = c;
  result.ns = nanoseconds([&] {  // another place each time
    in.O1.x[0] += 1e-9, moved.x1[0] += 1e-9;
    switch (way) {
      case Way::compact:
        return compact(in).Qhat[5];
      case Way::products:
        return products(moved).Qhat[5];
      case Way::jets:
        return jets(moved).Qhat[5];
      default:
        return differences(moved, steps).Qhat[5];
    }
  });
  return result;
}

// --- a trajectory ---------------------------------------------------------------------------------------------------

/// The four-bar of the references, let go: crank 0.1 m, coupler 0.3 m, rocker 0.25 m, pivots 0.28 m apart, the crank at
/// 0.3 rad turning at 10 rad/s. Four hinges of five rows each, redundant in space.
struct FourBar {
  System sys{System::Options{Vec3(0, -9.81, 0)}};
  FourBar(Way way, bool library) {
    const Vec3 A(0, 0, 0), D(0.28, 0, 0), B = 0.1 * Vec3(std::cos(0.3), std::sin(0.3), 0);
    const Vec3 along = (D - B).normalized(), across(-along[1], along[0], 0);
    const double d = (D - B).norm(), x = (0.3 * 0.3 - 0.25 * 0.25 + d * d) / (2 * d);
    const Vec3 C = B + x * along + std::sqrt(0.3 * 0.3 - x * x) * across;
    Body& crank = sys.add_body("crank", shapes::rod(0.5, A, B));
    Body& coupler = sys.add_body("coupler", shapes::rod(1.2, B, C));
    Body& rocker = sys.add_body("rocker", shapes::rod(0.9, D, C));
    const auto hinge = [&](const std::string& name, Body& p, Body& s, const Vec3& at_x) {
      Marker &P = sys.add_marker_at(name + ".P", p, pose_at(at_x)), &S = sys.add_marker_at(name + ".S", s, pose_at(at_x));
      const Mask mask = Mask::xyz | Mask::e1 | Mask::e2;
      if (library)
        sys.add<GenericLock>(name, P, S, mask);
      else
        sys.add(std::make_unique<DerivedLock>(name, P, S, mask, way));
    };
    hinge("A", crank, sys.ground(), A), hinge("B", coupler, crank, B), hinge("C", coupler, rocker, C),
        hinge("D", rocker, sys.ground(), D);
  }
};

Subject subject_of(Way way, bool library) {
  auto four_bar = std::make_shared<FourBar>(way, library);
  Subject subject{four_bar, &four_bar->sys, {}};
  four_bar->sys.setup();
  subject.start = four_bar->sys.start();
  FourBar exact(way, true);  // all begin at one and the same state
  Dynamics dynamics(exact.sys, std::make_unique<SchurSolver>());
  assemble(dynamics, subject.start, {{"A", Axis::rz, 10.0}});
  return subject;
}

WorkPrecision trajectory(Way way) {
  WorkPrecisionOptions options;
  options.integrators = {{"dop853", [] { return std::make_unique<Dop853>(); }}};
  options.solvers = {{"schur", [] { return std::make_unique<SchurSolver>(); }}};
  options.formulations = {Formulation::omega};
  options.stabilizations = {Stabilization::Kind::project};
  options.references = {options.integrators.front(), {"dopri5", [] { return std::make_unique<Dopri5>(); }}};
  options.gains.tolerance = 1e-12;
  options.tolerances = {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11};
  options.reference_tolerance = 1e-12;
  options.budget = 20;
  const Trajectory trajectory{.make = [way] { return subject_of(way, false); },
                      .length = 1.0,
                      .outputs = 20,
                      .truth = [way] { return subject_of(way, true); }};
  return work_precision(trajectory, options);
}

}  // namespace

int main() {
  const oracle::LockChecks checks =
      oracle::load_lock_checks(std::string(paths::kSource) + "/tests/verification/data/lock-checks.json");
  ChartSpec by_rows{"Constraint equations of one joint with all laws, derived in four ways",
                    "CPU time of one joint: constraints, Jacobian, right-hand side [ns]",
                    {}};
  by_rows.log_x = true, by_rows.x_range = Range{100, 5000};
  by_rows.panels = {{"error of Jacobian and right-hand side", {}, true}, {"best error of a trajectory [m]", {}, true}};
  by_rows.panels[0].y_range = Range{kFloor, 1e3}, by_rows.panels[1].y_range = Range{kFloor, 1e-2};
  ChartSpec by_trajectory{"A free four-bar for 1 s by dop853, its constraint equations derived in four ways",
                          "CPU time of the run [s]",
                          {}};
  by_trajectory.log_x = true;
  by_trajectory.panels = {{"largest position error [m]", {}, true}};
  std::ofstream csv(samples::output("derivations.csv"));
  csv << "derivation,operations,cpu of a lock [ns],error of the rows,error of the right side [1/s^2],best error of a "
         "trajectory [m],its cpu [s]\n";
  fmt::print("{:32} {:>10} {:>8} {:>10} {:>12} {:>12} {:>9}\n", "derivation", "operations", "ns", "rows", "right side",
             "trajectory m", "CPU s");

  for (const Way way : kWays) {
    const RowResult r = measure_rows(way, checks, {});
    const WorkPrecision runs = trajectory(way);
    const WorkPrecisionRun* best = nullptr;
    Series curve{name(way), {}, {}, SeriesStyle::linespoints};
    for (const WorkPrecisionRun& run : runs.runs) {
      if (!run.done()) continue;
      curve.x.push_back(run.cpu), curve.y.push_back(run.error.position);
      if (best == nullptr || run.error.position < best->error.position) best = &run;
    }
    const long n = operations(way, checks.entries.front().input);
    const std::string legend = fmt::format("{}: {} operations", name(way), n);
    const double error = best == nullptr ? NAN : best->error.position, cpu = best == nullptr ? NAN : best->cpu;
    const auto stem = [&](const std::string& label, double y) {
      return Series{label, {r.ns, r.ns}, {kFloor, std::max(y, kFloor)}, SeriesStyle::linespoints};
    };
    by_rows.panels[0].series.push_back(
        stem(fmt::format("{}: {:.0f} ns, {} operations", name(way), r.ns, n), std::max(r.error_J, r.error_Qhat)));
    by_rows.panels[1].series.push_back(stem(fmt::format("{}: {:.0e} m", name(way), error), error));
    by_trajectory.panels[0].series.push_back(curve);
    csv << fmt::format("{},{},{:.4g},{:.3g},{:.3g},{:.3g},{:.3g}\n", name(way), n, r.ns, r.error_J, r.error_Qhat, error,
                       cpu);
    fmt::print("{:32} {:10} {:8.0f} {:10.1e} {:12.1e} {:12.1e} {:9.2g}   references agree to {:.1e} m\n", name(way), n,
               r.ns, r.error_J, r.error_Qhat, error, cpu, runs.agreement.position);
  }
  // Other steps of the differences: no step is good for the right side.
  const double ns = by_rows.panels[0].series.back().x.front();
  Series other{"differences with steps of 1e-1 to 1e-9", {}, {}, SeriesStyle::points, "#999999"};
  for (double h = 1e-1; h > 0.5e-9; h *= 0.1) {
    double worst = 0;
    for (const oracle::LockCheck& check : checks.entries) {
      const Rows d = differences(check.input, {h, h});
      worst = std::max(
          {worst, (d.J - check.at("J")).cwiseAbs().maxCoeff(), (d.Qhat - check.at("Qhat")).cwiseAbs().maxCoeff()});
    }
    other.x.push_back(1.15 * ns), other.y.push_back(worst);
  }
  by_rows.panels[0].series.push_back(other);
  by_rows.height = 850;
  write_chart(samples::output("derivations"), by_rows);
  write_chart(samples::output("derivations_trajectory"), by_trajectory);
  fmt::print("{}, derivations.svg, derivations.png, derivations_trajectory.svg, derivations_trajectory.png\n",
             samples::output("derivations.csv"));
}
