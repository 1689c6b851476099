// Parallelograms in a row, through ten flat positions in ten seconds. In space every joint is redundant; where all lies
// flat, more ranks are lost and other motions branch off.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/run_scene.h"

using namespace lockstep;

namespace {

struct Passage {
  double error = 0, energy = 0;  ///< largest of the first upright's top, m, and of the energy, J
  SimulationReport report;
};

Passage pass(const std::string& scene, const std::string& method, const std::string& stages, double tolerance,
             double until = 10) {
  const SceneRun run = run_scene(std::string(paths::kScenes) + "/" + scene + ".json", [&](RunSettings& s) {
    s.integrator = {method};
    s.integrator.keys = Value::object({{"stages", stages.c_str()}});
    s.tolerance = {tolerance, 1e-2 * tolerance};
    s.until = until;
  });
  const Table truth = read_csv(std::string(paths::kSource) + "/tests/verification/data/" + scene + ".csv");
  Passage p;
  p.report = run.report;
  REQUIRE(run.table.n_rows() == static_cast<std::size_t>(std::lround(until / 0.1)) + 1);
  for (std::size_t i = 0; i < run.table.n_rows(); ++i) {
    p.error =
        std::max(p.error, std::hypot(run.table["B0x"][i] - truth["B0x"][i], run.table["B0y"][i] - truth["B0y"][i]));
    p.energy = std::max(p.energy, std::abs(run.table["energy"][i] - truth["energy"][i]));
  }
  return p;
}

/// Of log error over log tolerance, by least squares.
double slope_of(const std::vector<double>& tolerance, const std::vector<double>& error) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const double n = static_cast<double>(error.size());
  for (std::size_t i = 0; i < error.size(); ++i) {
    const double a = std::log(tolerance[i]), b = std::log(error[i]);
    x += a, y += b, xx += a * a, xy += a * b;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace

TEST_CASE("through ten flat positions the error of dop853 follows the tolerance to 1e-9 m",
          "[verification][integrators]") {
  const std::vector<double> tolerances{1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10};
  std::vector<double> errors;
  for (const double tolerance : tolerances) {
    const Passage p = pass("nfourbar_2", "dop853", "manifold", tolerance);
    CAPTURE(tolerance, p.error, p.energy);
    CHECK(p.error <= 50 * tolerance);
    CHECK(p.report.manifold_steps == p.report.steps);
    errors.push_back(p.error);
  }
  CHECK(errors.back() < 1e-9);
  CHECK(slope_of(tolerances, errors) == Approx(1).margin(0.2));
}

TEST_CASE("through ten flat positions the error of dopri5 follows the tolerance", "[verification][integrators]") {
  const std::vector<double> tolerances{1e-5, 1e-6, 1e-7, 1e-8};
  std::vector<double> errors;
  for (const double tolerance : tolerances) {
    const Passage p = pass("nfourbar_2", "dopri5", "manifold", tolerance);
    CAPTURE(tolerance, p.error);
    CHECK(p.error <= 200 * tolerance);
    errors.push_back(p.error);
  }
  CHECK(slope_of(tolerances, errors) == Approx(1).margin(0.35));
}

TEST_CASE("forty bays pass their flat positions", "[verification][integrators]") {
  for (const double tolerance : {1e-5, 1e-8}) {
    const Passage p = pass("nfourbar_40", "dop853", "manifold", tolerance);
    CAPTURE(tolerance, p.error, p.energy);
    CHECK(p.error <= 50 * tolerance);
  }
}

TEST_CASE("automatic stages go onto the constraints where the mechanism is singular, and say so",
          "[verification][integrators]") {
  const Passage p = pass("nfourbar_2", "dop853", "auto", 1e-8);
  CAPTURE(p.error, p.report.manifold_steps, p.report.steps);
  CHECK(p.error <= 50 * 1e-8);
  CHECK(p.report.manifold_steps > 0);
}
