// SPDX-License-Identifier: BSD-3-Clause
// Formulas: grammar, units, and what is refused. As functions of variables: expression_function_test.cpp.
#include <array>
#include <cmath>
#include <random>

#include <lockstep/error.h>
#include <lockstep/scene.h>
#include "framework/mechanism/expression/evaluate.h"
#include "framework/mechanism/expression/quantity.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace expression_test {

using namespace lockstep;
using namespace lockstep::expression;
using lockstep::testing::message_of;

namespace {

Amount length(double x) {
  Amount q = Amount::number(x);
  q.dimension = {1, 0, 0, 0}, q.measured = true;
  return q;
}

// Names that formulas of these tests read: crank 0.1 m, mass 2 kg, ratio 2.5, phi 30 deg, A = (1, 2, 3) m.
const Amount* known(const std::string& name) {
  static const Amount kCrank = length(0.1), kRatio = Amount::number(2.5), kMass = [] {
    Amount q = Amount::number(2);
    q.dimension = {0, 1, 0, 0}, q.measured = true;
    return q;
  }();
  static const Amount kPhi = [] {
    Amount q = Amount::number(kPi / 6);
    q.dimension = {0, 0, 0, 1}, q.measured = true;
    return q;
  }();
  static const Amount kA = [] {
    Amount q = length(1);
    q.v[1] = 2, q.v[2] = 3, q.is_vector = true;
    return q;
  }();
  if (name == "crank") return &kCrank;
  if (name == "mass") return &kMass;
  if (name == "ratio") return &kRatio;
  if (name == "phi") return &kPhi;
  return name == "A" ? &kA : nullptr;
}

Amount of(const std::string& text) {
  return evaluate(Expression(text), known, [] {
    return std::vector<std::string>{"crank", "mass", "ratio", "phi", "A"};
  });
}
double number(const std::string& text) {
  const Amount q = of(text);
  CHECK_FALSE(q.is_vector);
  return q.v[0];
}
std::string refusal(const std::string& text) {
  return message_of<ModelError>([&] { of(text); });
}

struct Worth {
  const char* text;
  double value;
};

}  // namespace

TEST_CASE("signs bind as in mathematics", "[unit][expression]") {
  for (const Worth& w : {Worth{"=1+2*3", 7},
                         {"1 + 2*3", 7},
                         {"=(1+2)*3", 9},
                         {"=7-3-2", 2},
                         {"=16/4/2", 2},
                         {"=2^3^2", 512},
                         {"=-2^2", -4},
                         {"=2^-2", 0.25},
                         {"=-3*-2", 6},
                         {"=+3", 3},
                         {"=--3", 3},
                         {"=1e3", 1000},
                         {"=.5", 0.5},
                         {"=1 < 2", 1},
                         {"=1 >= 2", 0},
                         {"=2 <= 2 && 3 != 4", 1},
                         {"=1 > 2 || !(2 == 3)", 1},
                         {"=1 > 2 ? 5 : 2 > 1 ? 6 : 7", 6},
                         {"=(1 < 2 ? 3 : 4) + 1", 4},
                         {"=1 + 1 < 3 ? 1 : 0", 1},
                         {"=[1, 2, 3].y", 2},
                         {"=A.z/crank", 30}})
    CHECK(number(w.text) == w.value);
}

TEST_CASE("functions and constants are those of the library", "[unit][expression]") {
  for (const Worth& w : {Worth{"=sin(0.3)", std::sin(0.3)},
                         {"=cos(30 deg)", std::cos(kPi / 6)},
                         {"=tan(phi)", std::tan(kPi / 6)},
                         {"=asin(0.5)", std::asin(0.5)},
                         {"=acos(-0.2)", std::acos(-0.2)},
                         {"=atan(3)", std::atan(3.0)},
                         {"=atan2(-1, -2)", std::atan2(-1.0, -2.0)},
                         {"=sinh(1) + cosh(1) - tanh(1)", std::sinh(1.0) + std::cosh(1.0) - std::tanh(1.0)},
                         {"=sqrt(2)", std::sqrt(2.0)},
                         {"=exp(1)", std::exp(1.0)},
                         {"=log(2)", std::log(2.0)},
                         {"=abs(-3)", 3},
                         {"=sign(-3) + sign(0) + sign(2)", 0},
                         {"=floor(-1.5)", -2},
                         {"=ceil(-1.5)", -1},
                         {"=round(2.4)", 2},
                         {"=round(-2.5)", -3},
                         {"=round(0.49999999999999994)", 0},
                         {"=mod(-1, 3)", 2},
                         {"=min(3, 1, 2)", 1},
                         {"=max(3 mm, crank, 2 m)", 2},
                         {"=hypot(3, 4, 12)", 13},
                         {"=pi", kPi},
                         {"=norm([3 m, 4 m, 0])", 5},
                         {"=dot([1, 2, 3], [4, 5, 6])", 32},
                         {"=cross([1, 0, 0], [0, 1, 0]).z", 1}})
    CHECK(number(w.text) == w.value);
}

TEST_CASE("a formula lists the names that it reads", "[unit][expression]") {
  const auto names = [](const char* formula) { return names_in(Expression(formula)); };
  CHECK(names("=a + rod.to.x*sin(b) - 2 m*a") == std::vector<std::string>{"a", "rod.to", "b"});
  CHECK(names("rod*[C.y, 1, 0]") == std::vector<std::string>{"rod", "C"});
  CHECK(names("1 kg").empty());
}

TEST_CASE("units go through a formula", "[unit][expression]") {
  struct Case {
    const char *text, *value;
  };
  for (const Case& c : {Case{"=2*crank", "0.2 m"},
                        {"=12 mm + crank", "0.112 m"},
                        {"=crank^2", "0.010000000000000002 m^2"},
                        {"=sqrt(crank*crank)", "0.1 m"},
                        {"=sqrt(crank)*sqrt(4 m)", "0.6324555320336759 m"},
                        {"=mass*9.81 m/s^2", "19.62 N"},
                        {"=mass*9.81 m / s^2*crank", "1.9620000000000002 N m"},
                        {"=1200 rpm", "125.66370614359172 rad/s"},
                        {"=phi*crank", "0.05235987755982988 m"},
                        {"=10 rad/s*crank + 1 m/s", "2 m/s"},
                        {"=atan2(crank, crank)", "0.7853981633974483 rad"},
                        {"=1 m/crank", "10 1"},
                        {"=crank/(20 ms)", "5 m/s"},
                        {"=3 N m/rad*phi", "1.5707963267948966 N m"},
                        {"=0 + crank", "0.1 m"},
                        {"=1 kg m^3", "1 kg m^3"},
                        {"=1/(2 s^2)", "0.5 1/s^2"}})
    CHECK(plain_text(expression::value_of(of(c.text))) == c.value);
  CHECK(*expression::value_of(of("=2*ratio")).number() == 5);

  const Value v = expression::value_of(of("=A + crank*[cos(phi), sin(phi), 0]"));
  REQUIRE(v.list() != nullptr);
  CHECK(*(*v.list())[0].text() == "1.0866025403784438 m");
  CHECK(*(*v.list())[1].text() == "2.05 m");
  CHECK(*(*v.list())[2].text() == "3 m");
  CHECK(*(*expression::value_of(of("=A - [1 m, 0, 0]")).list())[0].text() == "0 m");
}

TEST_CASE("a value is read back as the same double", "[unit][expression]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-30, 30);
  for (int i = 0; i < 2000; ++i) {
    const double x = std::pow(10.0, exponent(random));
    for (const auto& [unit, kind] :
         {std::pair{"m", Unit::length}, {"kg", Unit::mass}, {"N m/rad", Unit::torsion_stiffness}}) {
      Amount q = Amount::number(x);
      const Dimension d = *dimension_of(unit);
      q.dimension = {double(d.m), double(d.kg), double(d.s), double(d.rad)}, q.measured = true;
      CHECK(read_quantity(*expression::value_of(q).text(), kind).value == x);
    }
  }
}

TEST_CASE("an error gives the column, the problem and the expected text", "[unit][expression]") {
  struct Bad {
    const char* text;
    std::vector<std::string> words;
  };
  const std::vector<Bad> all = {
      {"=crank + mass", {"\"=crank + mass\"", "column 8", "a length and a mass are added"}},
      {"=crank + 0.1", {"column 8", "a length and a pure number are added", "give the number a unit"}},
      {"=2*crnk", {"column 4", "unknown name \"crnk\"", "did you mean \"crank\""}},
      {"=crank**2", {"column 8", "write a power with \"^\""}},
      {"=sim(2)", {"column 2", "unknown function \"sim\"", "did you mean \"sin\""}},
      {"=sin(crank)", {"column 2", "sin of a length", "an angle or a pure number"}},
      {"=exp(phi)", {"exp of an angle"}},
      {"=2^crank", {"column 3", "exponent is a length"}},
      {"=crank < mass", {"column 8", "compared"}},
      {"=crank ? 1 : 2", {"column 2", "a condition is expected"}},
      {"=1 < 2 < 3", {"column 8", "write \"a < b && b < c\""}},
      {"=A*A", {"column 3", "dot(a, b)"}},
      {"=A + 1 m", {"a vector (a length) and a length are added"}},
      {"=crank.x", {"column 7", "a point or a vector"}},
      {"=[1, 2]", {"column 2", "a list of 2"}},
      {"=[1 m, 2 kg, 0]", {"components of one vector"}},
      {"=(1 + 2", {"column 8", "expected \")\"", "column 2"}},
      {"=1 + 2)", {"column 7", "remove it"}},
      {"=1 +", {"column 5", "ends where a number"}},
      {"=", {"column 2", "ends"}},
      {"=0,5", {"column 3", "decimal separator"}},
      {"=2 3", {"column 4", "an operator"}},
      {"=2 crank", {"column 4", "unknown unit \"crank\"", "\"*\""}},
      {"=1e999", {"column 2", "range"}},
      {"=1/0", {"column 3", "division by zero"}},
      {"=sqrt(-1)", {"column 2", "sqrt of -1"}},
      {"*", {"column 1", "expected a number"}},
      {"=asin(2)", {"asin of 2", "from -1 to 1"}},
      {"=acos(1 + 1e-15)", {"acos of 1.000000000000001"}},
      {"=asin(-1 - 1e-15)", {"asin of -1.000000000000001"}},
      {"=log(0)", {"log of 0"}},
      {"=(-8)^0.5", {"a power that is not whole"}},
      {"=exp(1000)", {"not finite"}},
      {"=sin(1, 2)", {"column 2", "takes 1 argument", "2 are given"}},
      {"=atan2(1)", {"takes 2 arguments", "1 is given"}},
      {"=A.w", {"column 3", "\".x\", \".y\" or \".z\""}},
      {"=sqrt(crank)", {"dimension without a unit"}},
      {"=1 ? : 2", {"column 6", "expected a number"}},
      {"=2^*3", {"column 4", "expected an exponent"}},
      {"=1/A", {"a division by a vector"}},
      {"=A < A", {"two vectors are compared"}},
      {"=A^2", {"a power of a vector", "dot(a, a)"}},
      {"=mod(1, 0)", {"mod by zero"}},
      {"=0^(-1)", {"a negative power of 0"}},
      {"=1 # 2", {"column 4"}},
      {"=9.81 m/s ^2", {"column 11", "follows it directly"}},
      {"=2 mm^ratio", {"column 6", "bracket"}},
      {"=\u03b1 + nix", {"column 2", "unknown name"}}};
  for (const Bad& bad : all) {
    const std::string message = refusal(bad.text);
    for (const std::string& word : bad.words) {
      CAPTURE(bad.text, message, word);
      CHECK(message.find(word) != std::string::npos);
    }
  }
}

TEST_CASE("each function has exactly its documented number of arguments", "[unit][expression]") {
  const std::map<std::string, int> exactly = {
      {"sin", 1},  {"cos", 1}, {"tan", 1}, {"asin", 1},  {"acos", 1},  {"atan", 1}, {"sinh", 1},  {"cosh", 1},
      {"tanh", 1}, {"exp", 1}, {"log", 1}, {"abs", 1},   {"sign", 1},  {"sqrt", 1}, {"floor", 1}, {"ceil", 1},
      {"norm", 1}, {"mod", 2}, {"dot", 2}, {"round", 1}, {"atan2", 2}, {"cross", 2}};
  const auto called = [](const std::string& name, int n) {
    const std::string one = name == "norm" || name == "dot" || name == "cross" ? "A" : "1";
    std::string text = "=" + name + "(";
    for (int k = 0; k < n; ++k) text += (k > 0 ? ", " : "") + one;
    return text + ")";
  };
  for (const auto& [name, count] : exactly)
    for (const int n : {count - 1, count + 1}) {
      if (n == 0) continue;
      const std::string message = refusal(called(name, n));
      CAPTURE(name, n, message);
      CHECK(message.find(name + " takes " + std::to_string(count) + " argument") != std::string::npos);
    }
  for (const std::string name : {"min", "max", "hypot"}) {
    const std::string one = refusal(called(name, 1)), seventeen = refusal(called(name, 17));
    CAPTURE(name, one, seventeen);
    CHECK(one.find(name + " takes 2 or more arguments") != std::string::npos);
    CHECK(seventeen.find(name + " takes 2 or more arguments") != std::string::npos);
    CHECK(refusal(called(name, 16)) == "no error");
  }
}

TEST_CASE("functions of pure numbers take no angle, and none of an angle takes a length", "[unit][expression]") {
  for (const std::string name : {"sin", "cos", "tan"}) {
    CAPTURE(name);
    CHECK(refusal("=" + name + "(30 deg)") == "no error");
    CHECK(refusal("=" + name + "(1 m)").find(name + " of a length; an angle or a pure number is expected") !=
          std::string::npos);
  }
  for (const std::string name :
       {"asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "floor", "ceil", "round"})
    for (const auto& [given, what] : {std::pair("30 deg", "an angle"), std::pair("1 m", "a length")}) {
      const std::string message = refusal("=" + name + "(" + given + ")");
      CAPTURE(name, message);
      CHECK(message.find(name + " of " + what + "; a pure number is expected") != std::string::npos);
    }
}

TEST_CASE("a function of variables rejects a value that is no number by its cause", "[unit][expression]") {
  struct Bad {
    const char* text;
    std::vector<std::string> words;
  };
  for (const Bad& bad : {Bad{"=2*t.x", {"only a point or a vector has components", "this is a number"}},
                         {"=pi.y", {"only a point or a vector has components"}},
                         {"=(1 + t).z", {"only a point or a vector has components"}},
                         {"=u.x", {"column 2", "unknown name \"u\""}},
                         {"=norm(t)", {"column 2", "norm of a number", "a vector is expected"}},
                         {"=[t, 1, 2]", {"a number is expected", "this is a vector"}}}) {
    const std::string message = message_of<ModelError>([&] { FormulaFunction(bad.text, {"t"}); });
    for (const std::string& word : bad.words) {
      CAPTURE(bad.text, message, word);
      CHECK(message.find(word) != std::string::npos);
    }
  }
}

TEST_CASE("formulas that are nested too deeply are rejected", "[unit][expression]") {
  const auto repeated = [](const std::string& what, int n) {
    std::string text;
    for (int i = 0; i < n; ++i) text += what;
    return text;
  };
  CHECK(number("=" + repeated("(", kMostNesting - 1) + "1" + repeated(")", kMostNesting - 1)) == 1);
  CHECK(refusal("=" + repeated("(", kMostNesting) + "1" + repeated(")", kMostNesting)).find("nested deeper than 256") !=
        std::string::npos);
  for (const char* deep : {"-", "!", "[", "sin(", "2^", "1?", "1?2:", "1+("})
    CHECK(refusal("=" + repeated(deep, 900)).find("nested deeper") != std::string::npos);
}

TEST_CASE("a formula may have any number of parts", "[unit][expression]") {
  const auto chain = [](std::string text, const std::string& what, int n) {
    for (int i = 0; i < n; ++i) text += what;
    return text;
  };
  for (const int n : {63, 64, 65, 66, 200, 1000, 100'000}) {
    INFO(n << " parts");
    const double parts = n;
    CHECK(number(chain("=1", "+1", n)) == 1 + parts);
    CHECK(number(chain("=1", "-1", n)) == 1 - parts);
    CHECK(number(chain("=8", "*2/2", n)) == 8);
    CHECK(number(chain("=0", "||1", n)) == 1);
    const std::array<Time, 1> t = {Time(3)};
    CHECK(FormulaFunction(chain("=t", "-t+t", n), {"t"})(std::span<const Time>(t)).v == 3);
  }
}

TEST_CASE("random texts are read or rejected, never more", "[unit][expression]") {
  const std::vector<std::string> words = {
      "1", "2.5",  "crank", "A",  "t",  "sin(", "max(", "(",   ")", "[", "]", ",",     "+",   "-",
      "*", "/",    "^",     "<",  ">=", "==",   "&&",   "||",  "!", "?", ":", ".x",    " mm", " s",
      "=", "\xff", "1e9",   "\t", "pi", "#$",   "deg",  "^-1", ".", "°", "0", "hypot("};
  std::mt19937 random(11);
  int read = 0, refused = 0;
  for (int i = 0; i < 200'000; ++i) {
    std::string text = "=";
    for (std::size_t k = 0, n = 1 + random() % 12; k < n; ++k) text += words[random() % words.size()];
    try {
      const Amount q = of(text);
      CHECK(std::isfinite(q.v[0]));
      ++read;
    } catch (const ModelError& error) {
      if (std::string(error.what()).find("column") == std::string::npos) FAIL(text);
      ++refused;
    }
    try {
      const FormulaFunction f(text, {"t"});
      const std::array<Time, 1> t = {Time(0.3, 1, 0)};
      f(std::span<const Time>(t));
      std::vector<double> out;
      if (i % 50 == 0) f.breakpoints(0, 0, 1, out);
    } catch (const ModelError&) {
    }
  }
  CHECK(read > 500);
  CHECK(refused > 100'000);
}

}  // namespace expression_test
