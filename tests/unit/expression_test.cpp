// Formulas: grammar, units, derivatives, breakpoints, and what is refused.
#include <algorithm>
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

TEST_CASE("a formula tells the names that it reads", "[unit][expression]") {
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

TEST_CASE("a refusal says the column, what is wrong and what was expected", "[unit][expression]") {
  struct Bad {
    const char* text;
    std::vector<std::string> words;
  };
  const std::vector<Bad> all = {
      {"=crank + mass", {"\"=crank + mass\"", "column 8", "a length and a mass are added"}},
      {"=crank + 0.1", {"column 8", "a length and a pure number are added", "give the number a unit"}},
      {"=2*crnk", {"column 4", "unknown name \"crnk\"", "did you mean \"crank\""}},
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
      {"=asin(2)", {"asin of 2", "from -1 to 1"}},
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
      {"=9.81 m/s ^2", {"column 11", "directly behind it"}},
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

TEST_CASE("a function of variables refuses what is no number by its cause", "[unit][expression]") {
  struct Bad {
    const char* text;
    std::vector<std::string> words;
  };
  for (const Bad& bad : {Bad{"=2*t.x", {"only a point has components", "leave the component out"}},
                         {"=pi.y", {"only a point has components"}},
                         {"=(1 + t).z", {"only a point has components"}},
                         {"=u.x", {"column 2", "unknown name \"u\""}},
                         {"=norm(t)", {"column 2", "norm is of vectors", "numbers are expected"}},
                         {"=[t, 1, 2]", {"numbers are expected", "a vector stands in geometry only"}}}) {
    const std::string message = message_of<ModelError>([&] { FormulaFunction(bad.text, {"t"}); });
    for (const std::string& word : bad.words) {
      CAPTURE(bad.text, message, word);
      CHECK(message.find(word) != std::string::npos);
    }
  }
}

TEST_CASE("formulas that are too deep or too long are refused", "[unit][expression]") {
  const auto repeated = [](const std::string& what, int n) {
    std::string text;
    for (int i = 0; i < n; ++i) text += what;
    return text;
  };
  CHECK(number("=" + repeated("(", kMostNesting - 1) + "1" + repeated(")", kMostNesting - 1)) == 1);
  CHECK(refusal("=" + repeated("(", kMostNesting) + "1" + repeated(")", kMostNesting)).find("nested deeper than 64") !=
        std::string::npos);
  for (const char* deep : {"-", "!", "[", "sin(", "2^", "1?", "1?2:", "1+("})
    CHECK(refusal("=" + repeated(deep, 900)).find("nested deeper") != std::string::npos);
  CHECK(number("=1" + repeated("+1", 190)) == 191);
  CHECK(refusal("=1" + repeated("+1", 400)).find("more than 400 parts") != std::string::npos);
  CHECK(refusal("=" + repeated(" ", 4000)).find("4001 characters") != std::string::npos);
}

TEST_CASE("random texts are read or refused, never more", "[unit][expression]") {
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

// -- functions of variables

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

TEST_CASE("what stays equal over a span hides no switch", "[unit][expression]") {
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

TEST_CASE("too many switches are refused with the formula", "[unit][expression]") {
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

TEST_CASE("a variable that is a constant as well is refused where it is read", "[unit][expression]") {
  const expression::Constant t{"t", {5, 0, 0}, false};
  const std::string refused = message_of<ModelError>([&] { FormulaFunction("=2*t", {"t"}, {t}); });
  CAPTURE(refused);
  CHECK(refused.find("\"=2*t\", column 4") != std::string::npos);
  CHECK(refused.find("\"t\" is a variable") != std::string::npos);
  CHECK(refused.find("rename the parameter") != std::string::npos);
  CHECK(FormulaFunction("=2*x", {"x", "t"}, {t}).reads(0));
}

TEST_CASE("constants of functions are SI, and unknown names name the nearest", "[unit][expression]") {
  expression::Constant R{"R", {0.5, 0, 0}, false}, A{"A", {1, 2, 3}, true};
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
  CHECK(refused("=[1, 2, 3]").find("numbers are expected") != std::string::npos);
  CHECK(refused("=2 t").find("\"*\"") != std::string::npos);  // not two tonnes
  CHECK(refused("=1/0").find("not finite") != std::string::npos);
}

}  // namespace expression_test
