// SPDX-License-Identifier: BSD-3-Clause
// Formulas as functions of variables: derivatives, breakpoints, constants.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <lockstep/error.h>
#include <lockstep/scene.h>
#include "framework/mechanism/expression/evaluate.h"
#include "tests/support/catch.h"
#include "tests/support/dimension_check.h"
#include "tests/support/messages.h"

namespace expression_function_test {

using namespace lockstep;
using namespace lockstep::expression;
using lockstep::testing::check_dimensions, lockstep::testing::MeasuredVariable, lockstep::testing::message_of;

namespace {

// Derivatives of the formula by central differences of the same expression in long double, written out by hand.
struct Smooth {
  const char* text;
  long double (*by_hand)(long double t);
};
const Smooth kSmooth[] = {
    {"=0.1*sin(3*t)", [](long double t) { return 0.1L * std::sin(3 * t); }},
    {"=t^3 - 2*t^-1 + t^0.5", [](long double t) { return t * t * t - 2 / t + std::sqrt(t); }},
    {"=exp(-t)*cos(2*t + 1)/(1 + t^2)", [](long double t) { return std::exp(-t) * std::cos(2 * t + 1) / (1 + t * t); }},
    {"=tan(t/2) + atan(t) + log(1 + t)",
     [](long double t) { return std::tan(t / 2) + std::atan(t) + std::log(1 + t); }},
    {"=asin(t/3) - acos(t/4)", [](long double t) { return std::asin(t / 3) - std::acos(t / 4); }},
    {"=atan2(sin(t), 2 - t)", [](long double t) { return std::atan2(std::sin(t), 2 - t); }},
    {"=hypot(t, 1) + sqrt(t)", [](long double t) { return std::hypot(t, 1.0L) + std::sqrt(t); }},
    {"=sinh(t)*tanh(t) - cosh(t)", [](long double t) { return std::sinh(t) * std::tanh(t) - std::cosh(t); }},
    {"=2^t + t^t", [](long double t) { return std::pow(2.0L, t) + std::pow(t, t); }},
    {"=t > 1 ? 2*(t - 1)^2 : 0", [](long double t) { return t > 1 ? 2 * (t - 1) * (t - 1) : 0.0L; }},
    {"=max(t, 1.5 - t) + abs(t - 0.9) + mod(t, 0.35)",
     [](long double t) { return std::max(t, 1.5L - t) + std::abs(t - 0.9L) + (t - 0.35L * std::floor(t / 0.35L)); }}};

Time at(const FormulaFunction& f, double t) {
  const std::array<Time, 1> v = {Time(t, 1, 0)};
  return f(std::span<const Time>(v));
}

}  // namespace

TEST_CASE("derivatives of formulas are exact", "[unit][expression]") {
  for (const Smooth& s : kSmooth) {
    const FormulaFunction f(s.text, {"t"});
    for (const double t : {0.31, 0.77, 1.23, 1.6}) {
      const long double h = 1e-4L, y = s.by_hand(t), up = s.by_hand(t + h), down = s.by_hand(t - h),
                        up2 = s.by_hand(t + 2 * h), down2 = s.by_hand(t - 2 * h);
      const double d = double((8 * (up - down) - (up2 - down2)) / (12 * h)),
                   dd = double((16 * (up + down) - (up2 + down2) - 30 * y) / (12 * h * h));
      const Time a = at(f, t);
      CAPTURE(s.text, t);
      CHECK_THAT(a.v, Catch::Matchers::WithinAbs(double(y), 1e-14 * (1 + std::abs(double(y)))));
      CHECK_THAT(a.d, Catch::Matchers::WithinAbs(d, 1e-11 * (1 + std::abs(d))));
      CHECK_THAT(a.h, Catch::Matchers::WithinAbs(dd, 1e-9 * (1 + std::abs(dd))));
    }
  }
}

TEST_CASE("breakpoints are where comparisons switch, to the last bit", "[unit][expression]") {
  struct Case {
    const char* text;
    std::vector<double> instants;  // in (0, 4)
  };
  const double k = 2 * kPi / 3;
  for (const Case& c : {Case{"=t > 1 ? 2*(t - 1)^2 : 0", {1}},
                        {"=t >= 1 ? 1 : 0", {1}},
                        {"=t^2 < 2 ? t : 1", {std::sqrt(2.0)}},
                        {"=t < 1 || t > 3 ? 0 : 1", {1, 3}},
                        {"=t < 1 && t > 3 ? 0 : 1", {1}},
                        {"=abs(sin(1.5*t))", {k}},
                        {"=max(t, 3 - t, 1.8)", {1.2, 1.5, 1.8}},
                        {"=mod(t, 1.5)", {1.5, 3}},
                        {"=floor(2.5 - t)", {0.5, 1.5, 2.5, 3.5}},
                        {"=sign(t - 2)", {2}},
                        {"=(t - 2)^2 > 0 ? 1 : 0", {}},
                        {"=sin(t)", {}},
                        {"=t < 0 ? 1 : 2", {}},
                        {"=exp(t) > 20 ? 1 : 0", {std::log(20.0)}}}) {
    const FormulaFunction f(c.text, {"t"});
    std::vector<double> out = {-7};
    f.breakpoints(0, 0, 4, out);
    CAPTURE(c.text, out);
    REQUIRE(out.size() == c.instants.size() + 1);
    CHECK(out[0] == -7);
    for (std::size_t i = 0; i < c.instants.size(); ++i)
      CHECK_THAT(out[i + 1], Catch::Matchers::WithinULP(c.instants[i], 4));
  }
}

TEST_CASE("at a breakpoint holds what holds afterwards", "[unit][expression]") {
  for (const char* text : {"=t > 1 ? 5 : 0", "=t >= 1 ? 5 : 0", "=t < 1 ? 0 : 5", "=t <= 1 ? 0 : 5", "=!(t < 1)*5",
                           "=floor(t)*5", "=(t - 1)^3 > 0 ? 5 : 0 "}) {
    const FormulaFunction f(text, {"t"});
    CAPTURE(text);
    if (std::string(text).find("^3") == std::string::npos) CHECK(at(f, 1).v == 5);
    CHECK(at(f, std::nextafter(1.0, 0.0)).v == 0);
    CHECK(at(f, std::nextafter(1.0, 2.0)).v == 5);
  }
  CHECK(at(FormulaFunction("=abs(t - 1)", {"t"}), 1).d == 1);
  CHECK(at(FormulaFunction("=max(1, t)", {"t"}), 1).d == 1);
  CHECK(at(FormulaFunction("=min(1, t)", {"t"}), 1).d == 0);
}

TEST_CASE("many breakpoints are all found", "[unit][expression]") {
  const FormulaFunction f("=sin(100*t) > 0 ? 1 : 0", {"t"});
  std::vector<double> out;
  f.breakpoints(0, 0, 10, out);
  REQUIRE(out.size() == 318);  // 1000/pi
  for (std::size_t i = 0; i < out.size(); ++i)
    CHECK_THAT(out[i], Catch::Matchers::WithinAbs(kPi * double(i + 1) / 100, 1e-12));
}

TEST_CASE("equal values over a span hide no switch", "[unit][expression]") {
  struct Case {
    const char* text;
    std::vector<double> instants;  // in (0, 10)
  };
  for (const Case& c :
       {Case{"=(max(0,t-8) > 0 ? 0 : 0) + (t>7.003 && t<7.004 ? 1000 : 0)", {7.003, 7.004, 8}},
        {"=(min(t,1) < 1 ? 20 : 0)*0 + (t>7.003 && t<7.004 ? 1000 : 0)", {1, 7.003, 7.004}},
        {"=max(min(t,1),1)*0 + (t>7.003 && t<7.004 ? 1000 : 0)", {1, 7.003, 7.004}},
        {"=max(t,8) > t ? (t>7.003 && t<7.004 ? 1000 : 0) : 1", {7.003, 7.004, 8}},
        {"=abs(max(0,t-8)) + (t>7.003 && t<7.004 ? 1000 : 0)", {7.003, 7.004, 8}},
        {"=sign(floor(t/20)) + (t>7.003 && t<7.004 ? 1000 : 0)", {7.003, 7.004}},
        {"=t > 5 ? (sqrt(t-5) > 1 ? 1 : 0) : 0", {5, 6}},
        {"=max(0.3*t, 3*t/10)*0 + (t>7.003 && t<7.004 ? 1000 : 0)", {7.003, 7.004}},  // warns: equal but for round-off
        {"=t^2 - t*t > 0 ? 1 : (t>7.003 && t<7.004 ? 1000 : 0)", {7.003, 7.004}}}) {  // warns of the first
    const FormulaFunction f(c.text, {"t"});
    std::vector<double> out;
    f.breakpoints(0, 0, 10, out);
    CAPTURE(c.text, out);
    REQUIRE(out.size() == c.instants.size());
    for (std::size_t i = 0; i < out.size(); ++i) CHECK_THAT(out[i], Catch::Matchers::WithinULP(c.instants[i], 4));
  }
}

TEST_CASE("a switch on a whole number is found from both sides", "[unit][expression]") {
  for (const char* text : {"=floor(t)", "=ceil(t)", "=-floor(-t)", "=round(t - 0.5)"}) {
    std::vector<double> out;
    FormulaFunction(text, {"t"}).breakpoints(0, 0, 4, out);
    CAPTURE(text, out);
    CHECK(out == std::vector<double>{1, 2, 3});
  }
}

TEST_CASE("too many switches are rejected with the formula", "[unit][expression]") {
  std::vector<double> out;
  const FormulaFunction f("=floor(1e6*t)", {"t"});
  const std::string refused = message_of<ModelError>([&] { f.breakpoints(0, 0, 10, out); });
  CAPTURE(refused);
  CHECK(refused.find("\"=floor(1e6*t)\"") != std::string::npos);
  CHECK(refused.find("more than 1000000 times between t = 0 and 10 s") != std::string::npos);
}

TEST_CASE("halves are rounded away from zero, of what moves as it is just afterwards", "[unit][expression]") {
  const FormulaFunction still("=round(x)", {"x"}), falling("=round(-x)", {"x"});
  const auto fixed = [&](double x) {
    const Time at_rest(x);
    return still(std::span<const Time>(&at_rest, 1)).v;
  };
  for (const double x : {-2.5, 2.5, 0.49999999999999994, -0.49999999999999994, 0.5, -0.5, 4503599627370497.0})
    CHECK(fixed(x) == std::round(x));
  CHECK(at(still, 2.5).v == 3);
  CHECK(at(still, -2.5).v == -2);
  CHECK(at(falling, 2.5).v == -3);
  CHECK(at(falling, -2.5).v == 2);
  CHECK(at(still, 0.49999999999999994).v == 0);
}

TEST_CASE("a unit ends before a variable", "[unit][expression]") {
  CHECK(at(FormulaFunction("=t + 1 s/t*100", {"t"}), 1).v == 101);
  CHECK(at(FormulaFunction("=exp(-1 s/t)", {"t"}), 2).v == std::exp(-0.5));
  CHECK(at(FormulaFunction("=8 m/s/t^2", {"t"}), 2).v == 2);
  CHECK(message_of<ModelError>([] { FormulaFunction("=2 s t", {"t"}); }).find("expected an operator") !=
        std::string::npos);
  CHECK_THAT(at(FormulaFunction("=q*1 kg/t", {"q"}), 1).v, Catch::Matchers::WithinULP(1e-3, 2));  // no variable: tonnes
}

TEST_CASE("a variable that is a constant as well is rejected at its place", "[unit][expression]") {
  const NamedNumbers t{"t", {5}};
  const std::string refused = message_of<ModelError>([&] { FormulaFunction("=2*t", {"t"}, {t}); });
  CAPTURE(refused);
  CHECK(refused.find("\"=2*t\", column 4") != std::string::npos);
  CHECK(refused.find("\"t\" is both a variable") != std::string::npos);
  CHECK(refused.find("rename the parameter") != std::string::npos);
  CHECK(FormulaFunction("=2*x", {"x", "t"}, {t}).reads(0));
}

TEST_CASE("constants of functions are SI, and unknown names name the nearest", "[unit][expression]") {
  const NamedNumbers R{"R", {0.5}}, A{"A", {1, 2, 3}};
  const std::array<Time, 2> v = {Time(2), Time(3, 1, 0)};
  const FormulaFunction f("=x^2/(2*R) + A.y*t + 30 deg*0 + 100 mm", {"x", "t"}, {R, A});
  CHECK_THAT(f(std::span<const Time>(v)).v, Catch::Matchers::WithinULP(4.0 + 6.0 + 0.1, 2));
  CHECK(f.reads(0));
  CHECK_FALSE(FormulaFunction("=2*t", {"x", "t"}).reads(0));
  CHECK(FormulaFunction("=2*R + pi", {"t"}, {R}).is_constant());
  const auto refused = [&](const char* text) {
    return message_of<ModelError>([&] { FormulaFunction(text, {"x", "t"}, {R, A}); });
  };
  CHECK(refused("=sinn(t)").find("did you mean \"sin\"") != std::string::npos);
  CHECK(refused("=x + Qqq").find("unknown name \"Qqq\"; known: x, t, R, A, pi") != std::string::npos);
  CHECK(refused("=A*t").find("A.x") != std::string::npos);
  CHECK(refused("=[1, 2, 3]").find("a number is expected") != std::string::npos);
  CHECK(refused("=2 t").find("\"*\"") != std::string::npos);  // not two tonnes
  CHECK(refused("=1/0").find("not finite") != std::string::npos);
}

TEST_CASE("formulas with units are held against what they read and drive", "[unit][expression]") {
  const std::optional<Dimension> angle = dimension_of(Unit::angle), length = dimension_of(Unit::length),
                                 force = dimension_of(Unit::force), torque = dimension_of(Unit::torque);
  const std::vector<MeasuredVariable> variables = {
      {"t", dimension_of(Unit::time)}, {"q", length}, {"rz", angle}, {"e1", Dimension{}}, {"u", std::nullopt}};
  const std::vector<NamedNumbers> constants = {
      {"L", {0.1}, "m"}, {"w", {3}, "rad/s"}, {"n", {2}}, {"A", {1, 2, 3}, "m"}};
  const auto problem = [&](const char* text, const std::optional<Dimension>& value) {
    return message_of<ModelError>([&] { check_dimensions(text, variables, constants, value); });
  };
  struct Good {
    const char* text;
    std::optional<Dimension> value;
  };
  // Without a unit all is in SI; no value of the variables is out of range.
  for (const Good& good : {Good{"=3*t + sin(t) + q^t", angle},
                           {"=n*t", length},
                           {"=w*t", angle},
                           {"=L*sin(3*t) + (t > 1 s ? 2*(t - 1 s)^2 : 0)", length},  // 3 and 2 of any dimension
                           {"=L*exp(-t/2)*cos(t)", length},
                           {"=L*sin(w*t) + (t > 1 s ? 2 m/s^2*(t - 1 s)^2 : 0)", length},
                           {"=sqrt(t - 2 s)*sqrt(1 s - t)*1 m/s", length},
                           {"=L/(t - 1 s)*1 s", length},
                           {"=L*asin(3*q/L)", length},
                           {"=mod(t, t - 1 s)*w", angle},
                           {"=L*log(-t/1 s)^n", length},
                           {"=L*2^(t/(1 s))", length},
                           {"=q/L", angle},
                           {"=rz - q/L + 0.5", angle},
                           {"=t > 1 s ? 0.1 : 0.2", length},
                           {"=t > 1 s && !(q > L) || t > 3 s ? 1 : 0", length},
                           {"=-3 N/m*q", force},
                           {"=-3 N m/rad*rz - 1 N m/rad^3*rz^3", torque},
                           {"=-3 N*q*rz", torque},
                           {"=A.y*e1 + max(0, q, L)", length},
                           {"=3 kg*u", length},
                           {"=-3 N m/rad*sin(q/L)", torque},
                           {"=5 N/m*(q > 0 ? q : 0)", force},
                           {"=q*1 kg", std::nullopt}}) {
    CAPTURE(good.text);
    CHECK_NOTHROW(check_dimensions(good.text, variables, constants, good.value));
  }
  struct Bad {
    const char* text;
    std::optional<Dimension> value;
    std::vector<std::string> words;
  };
  for (const Bad& bad : {Bad{"=3 m", angle, {"\"=3 m\"", "its value is a length", "an angle is expected"}},
                         {"=3 kg*t", angle, {"kg s", "an angle is expected", "t is a time"}},
                         {"=1 m + t", angle, {"a length and a time are added"}},
                         {"=t*1 s", angle, {"s^2", "an angle"}},
                         {"=3 kg", torque, {"a mass", "a torque"}},
                         {"=3 mm", torque, {"a length", "a torque"}},
                         {"=-3 m/s*q", force, {"m^2/s", "a force", "q is a length"}},
                         {"=L*t", angle, {"m s", "an angle"}},
                         {"=A.x*t", length, {"m s", "a length"}},
                         {"=L*sin(1 s*t)", length, {"sin of", "s^2", "this formula has a unit"}},
                         {"=L + 0.1", length, {"a length and a pure number are added", "give the number a unit"}},
                         {"=t > 1 s ? L : t", length, {"a length and a time are the two sides of one choice"}},
                         {"=t < 1 s ? L : (1 m > t ? L : 0)", length, {"a length and a time are compared"}},
                         {"=0 > 1 && t > L ? 1 : 0", length, {"a time and a length are compared"}},
                         {"=L^(t/(1 s))", length, {"to a power that varies"}},
                         {"=5 N*(rz > 0 ? rz : 0)", torque, {"a torque is expected"}},
                         {"=5 N/m*(q + 0)", torque, {"a force", "a torque"}},
                         {"=0 m", angle, {"a length", "an angle"}}}) {
    const std::string message = problem(bad.text, bad.value);
    for (const std::string& word : bad.words) {
      CAPTURE(bad.text, message, word);
      CHECK(message.find(word) != std::string::npos);
    }
    CHECK(message.find("column") != std::string::npos);
  }
}

}  // namespace expression_function_test
