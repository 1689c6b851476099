// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/params/units.h"

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/math.h>
#include "tests/support/messages.h"

namespace units_test {

using namespace lockstep;
using lockstep::testing::check_words;

namespace {

// The factors are the definitions of the units, worked out by hand.
struct Case {
  const char* text;
  Unit unit;
  double si;
};

}  // namespace

TEST_CASE("texts with a unit are converted to SI", "[unit][model]") {
  const Case cases[] = {{"12 mm", Unit::length, 0.012},
                        {"12mm", Unit::length, 0.012},
                        {" 1.5e2  cm ", Unit::length, 1.5},
                        {"-3 um", Unit::length, -3e-6},
                        {"1 in", Unit::length, 0.0254},
                        {"2 km", Unit::length, 2000},
                        {"30 deg", Unit::angle, kPi / 6},
                        {"30\u00b0", Unit::angle, kPi / 6},
                        {"0.5 rev", Unit::angle, kPi},
                        {"2 mrad", Unit::angle, 0.002},
                        {"1 ms", Unit::time, 0.001},
                        {"2 min", Unit::time, 120},
                        {"5 g", Unit::mass, 0.005},
                        {"5 kg", Unit::mass, 5},
                        {"2 t", Unit::mass, 2000},
                        {"36 km/h", Unit::speed, 10},
                        {"1200 rpm", Unit::angular_speed, 40 * kPi},
                        {"90 deg/s", Unit::angular_speed, kPi / 2},
                        {"3 rad/s", Unit::angular_speed, 3},
                        {"9810 mm/s^2", Unit::acceleration, 9.81},
                        {"9.81 m/s\u00b2", Unit::acceleration, 9.81},
                        {"180 deg/s^2", Unit::angular_acceleration, kPi},
                        {"2 kN", Unit::force, 2000},
                        {"50 N mm", Unit::torque, 0.05},
                        {"50 N*mm", Unit::torque, 0.05},
                        {"3 kNm", Unit::torque, 3000},
                        {"50 Nmm", Unit::torque, 0.05},
                        {"6 inch", Unit::length, 0.1524},
                        {"2 sec", Unit::time, 2},
                        {"180 degrees", Unit::angle, kPi},
                        {"3 kgm2", Unit::inertia, 3},
                        {"40 kg mm^2", Unit::inertia, 4e-5},
                        {"0.3 g/cm^3", Unit::density, 300},
                        {"7850 kg m^-3", Unit::density, 7850},
                        {"4.5 N/mm", Unit::stiffness, 4500},
                        {"1 N m/deg", Unit::torsion_stiffness, 180 / kPi},
                        {"2 N s/mm", Unit::damping, 2000},
                        {"2 kg/s", Unit::damping, 2},
                        {"1 N m s/rad", Unit::torsion_damping, 1},
                        {"10 Hz", Unit::frequency, 10},
                        {"10 1/s", Unit::frequency, 10},
                        {"3 deg", Unit::any, kPi / 60},
                        {"3 mm", Unit::any, 0.003}};
  for (const Case& c : cases) {
    INFO(c.text);
    const Measured q = read_quantity(c.text, c.unit);
    CHECK(q.problem.empty());
    CHECK(std::abs(q.value - c.si) <= 4e-16 * std::abs(c.si));
  }
}

TEST_CASE("powers of ten cost no bit", "[unit][model]") {
  CHECK(read_quantity("12 mm", Unit::length).value == 0.012);
  CHECK(read_quantity("0.3 um", Unit::length).value == 0.3e-6);
  CHECK(read_quantity("7 g", Unit::mass).value == 0.007);
}

namespace {

/// What the tables of the SI say of a symbol: its size, mantissa 10^ten, its dimension, and whether it takes prefixes.
struct Symbol {
  std::string name;
  double mantissa;
  int ten;
  Dimension dimension;  // m, kg, s, rad
  bool takes_prefixes;
};
const std::vector<Symbol> kSymbols = {{"m", 1, 0, {1, 0, 0, 0}, true},
                                      {"g", 1, -3, {0, 1, 0, 0}, true},
                                      {"s", 1, 0, {0, 0, 1, 0}, true},
                                      {"N", 1, 0, {1, 1, -2, 0}, true},   // kg m/s^2
                                      {"Nm", 1, 0, {2, 1, -2, 0}, true},  // kg m^2/s^2
                                      {"J", 1, 0, {2, 1, -2, 0}, true},   // N m
                                      {"W", 1, 0, {2, 1, -3, 0}, true},   // J/s
                                      {"Hz", 1, 0, {0, 0, -1, 0}, true},  // 1/s
                                      {"rad", 1, 0, {0, 0, 0, 1}, true},
                                      {"deg", kPi / 180, 0, {0, 0, 0, 1}, false},
                                      {"\u00b0", kPi / 180, 0, {0, 0, 0, 1}, false},
                                      {"rev", 2 * kPi, 0, {0, 0, 0, 1}, false},
                                      {"turn", 2 * kPi, 0, {0, 0, 0, 1}, false},
                                      {"rpm", kPi / 30, 0, {0, 0, -1, 1}, false},
                                      {"min", 60, 0, {0, 0, 1, 0}, false},
                                      {"h", 3600, 0, {0, 0, 1, 0}, false},
                                      {"t", 1, 3, {0, 1, 0, 0}, false},
                                      {"in", 254, -4, {1, 0, 0, 0}, false},    // 25.4 mm
                                      {"ft", 3048, -4, {1, 0, 0, 0}, false}};  // 12 in
const std::vector<std::pair<std::string, int>> kPrefixes = {
    {"", 0},   {"n", -9}, {"u", -6}, {"\u00b5", -6}, {"\u03bc", -6},  // both signs that are read as micro
    {"m", -3}, {"c", -2}, {"d", -1}, {"h", 2},       {"k", 3},       {"M", 6}, {"G", 9}};

/// x 10^ten as the digits say it, to the last bit.
double decimal(double x, int ten) { return std::stod(std::to_string(static_cast<int>(x)) + "e" + std::to_string(ten)); }

}  // namespace

TEST_CASE("every unit is read with every prefix, its powers and as a divisor", "[unit][model]") {
  std::size_t n_read = 0;
  for (const Symbol& s : kSymbols)
    for (const auto& [prefix, power_of_ten] : kPrefixes) {
      const int ten = power_of_ten;  // clang 14 takes no binding in a lambda
      const std::string unit = prefix + s.name;
      CAPTURE(unit);
      if (unit == "min" && s.name == "in") continue;  // a minute
      const Measured one = read_quantity("2 " + unit, Unit::any);
      if (!prefix.empty() && !s.takes_prefixes) {
        check_words(one.problem, {"unknown unit \"" + unit + "\""});
        continue;
      }
      ++n_read;
      REQUIRE(one.problem.empty());
      CHECK(dimension_of(unit) == std::optional(s.dimension));
      const bool exact = s.mantissa == std::round(s.mantissa);
      const auto check = [&](const Measured& q, double mantissa, int power) {
        CHECK(q.problem.empty());
        if (exact && power > 0)
          CHECK(q.value == decimal(mantissa, power * (s.ten + ten)));
        else
          CHECK(q.value == Approx(mantissa * std::pow(10.0, power * (s.ten + ten))).epsilon(1e-14));
      };
      check(one, 2 * s.mantissa, 1);
      check(read_quantity("3 " + unit + "^2", Unit::any), 3 * s.mantissa * s.mantissa, 2);
      check(read_quantity("5 1/" + unit, Unit::any), 5 / s.mantissa, -1);
      check(in_si(7, unit), 7 * s.mantissa, 1);
    }
  CHECK(n_read == 9 * 12 + 10);
  CHECK(read_quantity("210 GPa", Unit::any).value == 2.1e11);
  CHECK(read_quantity("1013 hPa", Unit::any).value == 101300);
  CHECK(read_quantity("2 GW", Unit::any).value == 2e9);
}

TEST_CASE("every unit understands its own SI symbol and its own example", "[unit][model]") {
  for (int k = 0; k < static_cast<int>(Unit::any); ++k) {
    const Unit unit = static_cast<Unit>(k);
    if (unit == Unit::none) continue;
    INFO(name_of(unit));
    CHECK_FALSE(si_unit(unit).empty());
    const Measured one = read_quantity("1 " + si_unit(unit), unit);
    CHECK(one.problem.empty());
    CHECK(one.value == 1);
    CHECK(read_quantity(example_of(unit), unit).problem.empty());
  }
}

TEST_CASE("a unit of another dimension is rejected by both names", "[unit][model]") {
  check_words(read_quantity("30 deg", Unit::length).problem,
              {"\"30 deg\" is an angle", "a length is expected", "12 mm"});
  check_words(read_quantity("10 Hz", Unit::angular_speed).problem, {"is a frequency", "an angular speed", "1200 rpm"});
  check_words(
      read_quantity("3 N m", Unit::torsion_stiffness).problem,
      {"is a torque", "torsional stiffness", "N m/rad", "only the radian differs: divide by 1 rad in a formula"});
  check_words(read_quantity("3 N m/rad", Unit::torque).problem, {"multiply by 1 rad"});
  CHECK(read_quantity("30 deg", Unit::length).problem.find("radian") == std::string::npos);
  check_words(read_quantity("3 kg", Unit::force).problem, {"is a mass", "a force"});
  check_words(read_quantity("3 kg m", Unit::mass).problem, {"is a quantity in kg m", "a mass"});
  check_words(read_quantity("3 J", Unit::length).problem, {"\"3 J\" is an energy", "a length is expected"});
  CHECK(read_quantity("3 J", Unit::torque).value == 3);
  // No two units of the table may be confused.
  for (int k = 1; k < static_cast<int>(Unit::any); ++k)
    for (int l = 1; l < static_cast<int>(Unit::any); ++l)
      if (k != l)
        CHECK_FALSE(read_quantity("1 " + si_unit(static_cast<Unit>(k)), static_cast<Unit>(l)).problem.empty());
}

TEST_CASE("an unreadable value is rejected with the text and the right form", "[unit][model]") {
  check_words(read_quantity("3 mmm", Unit::length).problem,
              {"\"3 mmm\"", "unknown unit \"mmm\"", "did you mean \"mm\""});
  check_words(read_quantity("3 m/s2", Unit::acceleration).problem, {"unknown unit \"s2\"", "did you mean \"s^2\"?"});
  check_words(read_quantity("3 newton", Unit::force).problem, {"did you mean \"N\"?"});
  check_words(read_quantity("3 %", Unit::length).problem, {"unknown unit \"%\"; see lockstep describe unit"});
  check_words(read_quantity("3", Unit::length).problem, {"\"3\" has no unit", "without quotes"});
  check_words(read_quantity("", Unit::length).problem, {"does not begin with a number", "12 mm"});
  check_words(read_quantity("fast", Unit::speed).problem, {"\"fast\"", "a speed", "20 mm/s"});
  check_words(read_quantity("1,5 mm", Unit::length).problem, {"comma", "point"});
  check_words(read_quantity("nan mm", Unit::length).problem, {"not a finite number"});
  check_words(read_quantity("inf mm", Unit::length).problem, {"not a finite number"});
  check_words(read_quantity("1e999 mm", Unit::length).problem, {"range"});
  check_words(read_quantity("1e308 km", Unit::length).problem, {"range"});
  check_words(read_quantity("5 mm", Unit::none).problem, {"without a unit", "5 mm"});
  check_words(read_quantity("1 N m/rad s", Unit::torsion_damping).problem, {"ambiguous", "N m s/rad"});
  check_words(read_quantity("1 m/", Unit::length).problem, {"ends with \"*\" or \"/\""});
  check_words(read_quantity("1 m^x", Unit::length).problem, {"m^x"});
  check_words(read_quantity("1 m^99", Unit::length).problem, {"m^99"});
  check_words(read_quantity("1 m // s", Unit::speed).problem, {"missing"});
}

}  // namespace units_test
