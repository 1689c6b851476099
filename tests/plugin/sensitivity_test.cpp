// SPDX-License-Identifier: BSD-3-Clause
// The command sensitivity, as a person calls it.
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/plugin/search_scenes.h"
#include "tests/support/catch.h"
#include "tests/support/defect_runs.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace sensitivity_test {

using namespace lockstep::testing;
using namespace search_scenes;
using Json = nlohmann::json;
using std::numbers::pi;

namespace {

// A mass on a damped spring, let go 0.1 m from its free length, which is 0.9 m: its position and velocity at t, for
// complex k, m and c, from whose imaginary parts derivatives follow without differences.
using Complex = std::complex<double>;
struct Oscillator {
  Complex k{800}, m{2}, c{3};
  Complex decay() const { return c / (2.0 * m); }
  Complex omega() const { return std::sqrt(k / m - decay() * decay()); }
  Complex x(Complex t) const {
    return 0.9 + 0.1 * std::exp(-decay() * t) * (std::cos(omega() * t) + decay() / omega() * std::sin(omega() * t));
  }
  Complex v(Complex t) const { return -0.1 * k / m / omega() * std::exp(-decay() * t) * std::sin(omega() * t); }
  // The differential equation, m (v(T) - v(0)) + c (x(T) - x(0)) + k (integral of x - 0.9 T) = 0.
  Complex mean_x(double T) const { return 0.9 - (m * v(T) + c * (x(T) - x(0))) / (k * T); }

  static std::string scene() {
    return scene_file("oscillator", R"--(
  "parameters": {"k": "800 N/m", "m": "2 kg", "c": "3 N s/m"}, "gravity": [0, 0, 0],
  "bodies": [{"name": "mass", "mass": "=m", "inertia": [1, 1, 1], "position": [1, 0, 0]}],
  "joints": [{"name": "guide", "type": "prismatic", "p": "mass", "s": "ground", "at": [1, 0, 0], "axis": "x"}],
  "forces": [{"name": "spring", "type": "spring_damper", "p": "mass", "s": "ground", "at_p": [1, 0, 0],
              "at_s": [0, 0, 0], "stiffness": "=k", "damping": "=c", "free_length": 0.9}],
  "run": {"until": 1.3, "output": 0.1, "record": [{"x": "mass.x"}, {"v": "mass.vx"}]})--");
  }
};

// The derivatives of a command, one for each formula and number, in its order.
std::vector<double> slopes(const std::string& words) {
  std::vector<double> all;
  const Json found = json_of("sensitivity " + words + " --json");
  for (const Json& slope : found["sensitivities"]) all.push_back(slope["derivative"].get<double>());
  return all;
}

// The derivative of a value by a number, and their ratio, to which its error is relative if that is larger.
struct ExactSlope {
  double slope, ratio = 0;
};
void check_slopes(const std::vector<double>& found, const std::vector<ExactSlope>& exact, double relative) {
  REQUIRE(found.size() == exact.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    INFO(k << ": " << found[k] << ", exact " << exact[k].slope);
    CHECK(std::abs(found[k] - exact[k].slope) <=
          relative * std::max(std::abs(exact[k].slope), std::abs(exact[k].ratio)));
  }
}

}  // namespace

TEST_CASE("sensitivity: last values, a mean and an extreme of an oscillator against its solution", "[plugin][runner]") {
  constexpr double kTiny = 1e-30, T = 1.3;
  std::vector<ExactSlope> exact;
  for (Complex Oscillator::*number : {&Oscillator::k, &Oscillator::m, &Oscillator::c}) {
    Oscillator o;
    const double x = (o.*number).real();
    o.*number += Complex(0, kTiny);
    for (const Complex value : {o.x(T), o.v(T), o.x(pi / o.omega()), o.mean_x(T)})
      exact.push_back({value.imag() / kTiny, value.real() / x});
  }
  const std::string words =
      Oscillator::scene() + " --of x --of v --of \"min(x)\" --of \"mean(x)\" --to k --to m --to c";
  for (const char* method : {"dop853", "dopri5", "radau5"}) {
    INFO(method);
    check_slopes(slopes(words + " --integrator " + method), exact, 1e-10);
  }
}

TEST_CASE("sensitivity: nothing at the point, kinks, and a run that is wrong", "[plugin][runner]") {
  const std::string begin = "sensitivity " + formulas();
  const Called text = call(begin + " --of miss --to u");
  INFO(text.text);
  CHECK(contains(text.text, " 1 "));  // the derivative; the value is 0
  for (const auto& [formula, slope] : {std::pair<std::string, double>("max(p, q)", 0.5), {"abs(p - q)", 1.0}}) {
    const Json j = json_of(begin + " --of \"" + formula + "\" --to p --json")["sensitivities"];
    INFO(j.dump());
    CHECK(std::abs(j[0]["error"].get<double>() - slope) <= 1e-9);
  }
  const Called wrong = call(begin + " --of x --to L --set L=\"2 m\"");
  INFO(wrong.text);
  CHECK(wrong.exit == 9);
  CHECK(contains(wrong.text, "requirement"));
}

TEST_CASE("sensitivity: joints that laws alone move, in joint coordinates", "[plugin][runner]") {
  // F = m r w^2 + m g at the bottom.
  for (const char* of : {"auto", "joint", "omega"}) {
    INFO(of);
    check_slopes(slopes(rotor() + " --of \"max(F)\" --to speed --to r --formulation " + of), {{12}, {200}}, 1e-9);
  }
}

TEST_CASE("sensitivity: the time of an impact moves", "[plugin][runner]") {
  // From the height h, with restitution e: y = e v (T - t) - g (T - t)^2/2 after an impact at t = v/g, v = sqrt(2 g h).
  const std::string scene = scene_file("bounce", R"--(
  "parameters": {"h": "1 m", "e": 0.7}, "gravity": [0, -9.81, 0],
  "bodies": [{"name": "ball", "mass": 1, "inertia": [1, 1, 1], "position": [0, "=h", 0]}],
  "markers": [{"name": "base", "body": "ground", "orientation": {"axis": "x", "angle": "-90 deg"}},
              {"name": "centre", "body": "ball", "orientation": {"axis": "x", "angle": "-90 deg"}}],
  "joints": [{"name": "guide", "type": "prismatic", "p": "centre", "s": "base",
              "stops": [{"axis": "z", "low": 0, "restitution": "=e"}]}],
  "run": {"until": 0.8, "output": 0.1, "record": [{"y": "ball.y"}, {"vy": "ball.vy"}]})--");
  constexpr double g = 9.81, tiny = 1e-30;
  std::vector<ExactSlope> exact;
  for (const bool of_height : {true, false}) {
    const Complex h(1, of_height ? tiny : 0), e(0.7, of_height ? 0 : tiny), v = std::sqrt(2 * g * h), s = 0.8 - v / g;
    for (const Complex value : {e * v * s - 0.5 * g * s * s, e * v - g * s}) exact.push_back({value.imag() / tiny});
  }
  check_slopes(slopes(scene + " --of y --of vy --to h --to e"), exact, 1e-9);
}

TEST_CASE("sensitivity: a double pendulum against differences of runs with their own steps", "[plugin][runner]") {
  const auto last = [](double upper) {
    call("run " + sample("double_pendulum") + " --until 1.5 --tolerance 1e-12 --no-picture --quiet --record swing.csv" +
         " --set upper=" + std::to_string(upper));
    const lockstep::Table table = table_of("swing");
    return std::array{table.last("q1"), table.last("q2_d")};
  };
  const auto difference = [&](double h, std::size_t k) { return (last(1 + h)[k] - last(1 - h)[k]) / (2 * h); };
  std::vector<ExactSlope> expected;
  for (const std::size_t k : {0U, 1U}) expected.push_back({(4 * difference(0.001, k) - difference(0.002, k)) / 3});
  check_slopes(slopes(sample("double_pendulum") + " --until 1.5 --of q1 --of q2_d --to upper"), expected, 1e-6);
}

TEST_CASE("sensitivity: derivatives of extremes, last values and frequencies", "[plugin][runner]") {
  const Json j =
      json_of("sensitivity " + rotor() + " --of \"max(F)\" --of phi --to speed --to r --json")["sensitivities"];
  REQUIRE(j.size() == 4);
  const std::vector<double> exact{2 * 2 * 0.3 * 10, 2, 2 * 100, 0};  // F = m r w^2 + m g, phi = w t
  for (std::size_t k = 0; k < exact.size(); ++k) {
    INFO(j[k].dump());
    CHECK(std::abs(j[k]["derivative"].get<double>() - exact[k]) <= 1e-6 * std::max(exact[k], 1.0));
    CHECK(j[k]["error"].get<double>() <= 1e-6 * std::max(exact[k], 1.0));
  }
  CHECK(j[0]["unit"] == "N/(rad/s)");
  // A mass on a spring: f = sqrt(k/m)/(2 pi), df/dk = f/(2 k), df/dm = -f/(2 m).
  const std::string spring = scene_file("spring_mass", R"--(
  "parameters": {"k": "800 N/m", "m": "2 kg"}, "gravity": [0, 0, 0],
  "bodies": [{"name": "mass", "mass": "=m", "inertia": [1, 1, 1], "position": [1, 0, 0]}],
  "joints": [{"name": "guide", "type": "prismatic", "p": "mass", "s": "ground", "at": [1, 0, 0], "axis": "x"}],
  "forces": [{"name": "spring", "type": "spring_damper", "p": "mass", "s": "ground", "at_p": [1, 0, 0], "at_s": [0, 0, 0],
              "stiffness": "=k", "free_length": 1}],
  "run": {"until": 1})--");
  const Json f = json_of("sensitivity " + spring + " --modes 1 --to k --to m --json")["sensitivities"];
  const double frequency = std::sqrt(400.0) / (2 * pi);
  CHECK(std::abs(f[0]["derivative"].get<double>() - frequency / 1600) <= 1e-10 * frequency / 1600);
  CHECK(std::abs(f[1]["derivative"].get<double>() + frequency / 4) <= 1e-10 * frequency / 4);
  check_refused(call("sensitivity " + spring + " --to k"), 2, {"a formula is missing"});
  check_refused(call("sensitivity " + spring + " --modes 3 --to k"), 2, {"3 frequencies", "has 1 with k = 800 N/m"});
}

}  // namespace sensitivity_test
