// SPDX-License-Identifier: BSD-3-Clause
// Jets against the oracle's dual numbers: every operator and every function, alone and in one another; value, gradient,
// first and second derivative along a motion. What the dual numbers lack is made from what they have.
#include <lockstep/author/jet.h>

#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <type_traits>

#include "tests/support/catch.h"
#include "tests/support/dual.h"
#include "tests/support/paths.h"

namespace lockstep::oracle {

inline Dual2 exp(const Dual2& a) {  // the series, differentiated term by term by the arithmetic itself
  Dual2 sum = 1.0, term = 1.0;
  for (int n = 1; n < 60; ++n) sum += term *= a / double(n);
  return sum;
}
inline Dual2 log(const Dual2& a) {  // 2 artanh((a - 1)/(a + 1))
  const Dual2 u = (a - 1.0) / (a + 1.0);
  Dual2 sum = 0.0, power = u;
  for (int n = 1; n < 400; n += 2, power *= u * u) sum += power / double(n);
  return 2.0 * sum;
}
inline Dual2 tan(const Dual2& a) { return sin(a) / cos(a); }
inline Dual2 sinh(const Dual2& a) { return (exp(a) - exp(-a)) / 2.0; }
inline Dual2 cosh(const Dual2& a) { return (exp(a) + exp(-a)) / 2.0; }
inline Dual2 tanh(const Dual2& a) { return sinh(a) / cosh(a); }
inline Dual2 abs(const Dual2& a) { return a.v < 0 ? -a : a; }
inline Dual2 atan(const Dual2& a) { return atan2(a, Dual2(1.0)); }
inline Dual2 asin(const Dual2& a) { return atan2(a, sqrt(1.0 - a * a)); }
inline Dual2 acos(const Dual2& a) { return atan2(sqrt(1.0 - a * a), a); }
/// Powers of which the dual numbers know the meaning.
inline Dual2 pow(const Dual2& a, double p) {
  Dual2 r = 1.0;
  const Dual2 root = sqrt(a);
  for (int n = 0; n < int(std::round(std::abs(2 * p))); ++n) r *= root;
  return p < 0 ? 1.0 / r : r;
}

}  // namespace lockstep::oracle

using lockstep::Jet;
using lockstep::Time;
using lockstep::oracle::Dual2;

namespace {

bool near(double a, double b) { return std::abs(a - b) <= 2e-13 * std::max(1.0, std::abs(b)); }

/// f of two variables u, v that move at the rates ud, vd (and udd, vdd), against dual numbers.
template <class F>
void check(F&& f, double u, double v) {
  const double ud = 0.7, udd = -0.4, vd = -1.3, vdd = 0.9;
  using J = Jet<2>;
  const J got = f(J::variable(0, u, ud, udd), J::variable(1, v, vd, vdd));
  const Dual2 moved = f(Dual2(u, ud, udd), Dual2(v, vd, vdd));
  CAPTURE(u, v);
  CHECK(near(got.v, moved.v));
  CHECK(near(got.d, moved.d));
  CHECK(near(got.h, moved.dd));
  CHECK(near(got.g[0], f(Dual2::parameter(u), Dual2(v)).d));
  CHECK(near(got.g[1], f(Dual2(u), Dual2::parameter(v)).d));
}

/// f of one variable, as a Jet of two and as a law's time.
template <class F>
void check_one(F&& f, std::initializer_list<double> values) {
  for (double u : values) {
    check([&](const auto& a, const auto& b) { return f(a) + 0.0 * b; }, u, 1.0);
    check([&](const auto& a, const auto& b) { return f(a * b); }, u / 1.25, 1.25);
    const Time t = f(Time(u, 1.0, 0.0));
    const Dual2 d = f(Dual2::parameter(u));
    CHECK(near(t.v, d.v));
    CHECK(near(t.d, d.d));
    CHECK(near(t.h, d.dd));
  }
}

}  // namespace

TEST_CASE("jets add, multiply and divide", "[unit][math]") {
  for (double u : {-1.4, 0.3, 2.0})
    for (double v : {-0.8, 1.7}) {
      check([](const auto& a, const auto& b) { return a + b; }, u, v);
      check([](const auto& a, const auto& b) { return a - b; }, u, v);
      check([](const auto& a, const auto& b) { return -a * b; }, u, v);
      check([](const auto& a, const auto& b) { return a / b; }, u, v);
      check([](const auto& a, const auto& b) { return (2.0 + a) * (b - 3.0) - (4.0 - a) * (b * 5.0); }, u, v);
      check([](const auto& a, const auto& b) { return (a + 2.0) / 7.0 + 3.0 / b + 0.5 * a; }, u, v);
      check(
          [](auto a, const auto& b) {
            a += b;
            a *= b;
            a -= b * b;
            a /= b;
            return a;
          },
          u, v);
    }
}

TEST_CASE("jets know every function that the dual numbers know", "[unit][math]") {
  const auto all = {-1.9, -0.6, 0.2, 0.9, 1.8}, positive = {0.3, 0.9, 1.6, 4.0}, small = {-0.9, -0.3, 0.1, 0.7};
  check_one([](const auto& a) { return sqrt(a); }, positive);
  check_one([](const auto& a) { return sin(a); }, all);
  check_one([](const auto& a) { return cos(a); }, all);
  check_one([](const auto& a) { return tan(a); }, {-1.2, 0.0, 0.4, 1.3});
  check_one([](const auto& a) { return exp(a); }, all);
  check_one([](const auto& a) { return log(a); }, positive);
  for (double p : {2.0, 3.0, 0.5, 2.5, -1.0, -1.5}) check_one([p](const auto& a) { return pow(a, p); }, positive);
  check_one([](const auto& a) { return sinh(a); }, all);
  check_one([](const auto& a) { return cosh(a); }, all);
  check_one([](const auto& a) { return tanh(a); }, all);
  check_one([](const auto& a) { return abs(a); }, all);
  check_one([](const auto& a) { return atan(a); }, all);
  check_one([](const auto& a) { return asin(a); }, small);
  check_one([](const auto& a) { return acos(a); }, small);
}

TEST_CASE("atan2 of jets is right all round", "[unit][math]") {
  for (int degrees = -179; degrees <= 180; degrees += 7) {
    const double a = degrees * 3.14159265358979 / 180;
    check([](const auto& y, const auto& x) { return atan2(y, x); }, 1.7 * std::sin(a), 1.7 * std::cos(a));
  }
  check([](const auto& y, const auto& x) { return atan2(y, x); }, 0.0, 2.0);
  check([](const auto& y, const auto& x) { return atan2(y, x); }, -2.0, 0.0);
  check([](const auto& y, const auto& x) { return atan2(y, x); }, 2.0, 2.0);
}

TEST_CASE("functions of functions keep exact derivatives", "[unit][math]") {
  for (double u : {0.4, 1.1})
    for (double v : {0.5, -0.3}) {
      check(
          [](const auto& a, const auto& b) { return exp(sin(a * b)) / sqrt(1.0 + b * b) - atan2(a, b + 2.0) * cos(a); },
          u, v);
      check([](const auto& a, const auto& b) { return log(1.0 + a * a) * tanh(b) + pow(a, 1.5) * tan(b); }, u, v);
    }
}

TEST_CASE("time enters a jet together with the variables", "[unit][math]") {
  // f(y, t) = t^2 y: along the motion f' = 2 t y + t^2 y', f'' = 2 y + 4 t y'; the gradient sees y alone
  const double t = 1.5, y = 0.7, yd = -2.0;
  const Jet<1> time(t, 1.0, 0.0), f = time * time * Jet<1>::variable(0, y, yd);
  CHECK(near(f.v, t * t * y));
  CHECK(near(f.d, 2 * t * y + t * t * yd));
  CHECK(near(f.h, 2 * y + 4 * t * yd));
  CHECK(near(f.g[0], t * t));
}

TEST_CASE("jets compare by their values", "[unit][math]") {
  const Jet<1> a = Jet<1>::variable(0, 1.0, 5.0), b(2.0);
  CHECK(a < b);
  CHECK(b > a);
  CHECK(a < 1.5);
  CHECK(a > 0.5);
  CHECK(a <= 1.0);
  CHECK(a >= 1.0);
  CHECK_FALSE(a > b);
}

namespace {

/// A function of jets with its derivatives in closed form: f, f', f''.
struct Known {
  std::function<Time(const Time&)> on_jet;
  std::function<std::array<double, 3>(double)> closed;
  std::vector<double> at;
};

/// Functions of two arguments are tried as functions of each.
std::multimap<std::string, Known> known_functions() {
  const std::vector<double> all = {-1.7, -0.4, 0.3, 2.1}, positive = {0.2, 1.3, 5.0}, small = {-0.8, 0.1, 0.6};
  using A = std::array<double, 3>;
  return {
      {"sqrt",
       {[](const Time& a) { return sqrt(a); },
        [](double x) {
          return A{std::sqrt(x), 0.5 / std::sqrt(x), -0.25 / (x * std::sqrt(x))};
        },
        positive}},
      {"sin",
       {[](const Time& a) { return sin(a); },
        [](double x) {
          return A{std::sin(x), std::cos(x), -std::sin(x)};
        },
        all}},
      {"cos",
       {[](const Time& a) { return cos(a); },
        [](double x) {
          return A{std::cos(x), -std::sin(x), -std::cos(x)};
        },
        all}},
      {"tan",
       {[](const Time& a) { return tan(a); },
        [](double x) {
          const double y = std::tan(x), d = 1 + y * y;
          return A{y, d, 2 * y * d};
        },
        small}},
      {"exp",
       {[](const Time& a) { return exp(a); },
        [](double x) {
          return A{std::exp(x), std::exp(x), std::exp(x)};
        },
        all}},
      {"log",
       {[](const Time& a) { return log(a); },
        [](double x) {
          return A{std::log(x), 1 / x, -1 / (x * x)};
        },
        positive}},
      {"pow",
       {[](const Time& a) { return pow(a, 2.5); },
        [](double x) {
          return A{std::pow(x, 2.5), 2.5 * std::pow(x, 1.5), 3.75 * std::sqrt(x)};
        },
        positive}},
      {"sinh",
       {[](const Time& a) { return sinh(a); },
        [](double x) {
          return A{std::sinh(x), std::cosh(x), std::sinh(x)};
        },
        all}},
      {"cosh",
       {[](const Time& a) { return cosh(a); },
        [](double x) {
          return A{std::cosh(x), std::sinh(x), std::cosh(x)};
        },
        all}},
      {"tanh",
       {[](const Time& a) { return tanh(a); },
        [](double x) {
          const double c = 1 / std::cosh(x);
          return A{std::tanh(x), c * c, -2 * std::tanh(x) * c * c};
        },
        all}},
      {"abs",
       {[](const Time& a) { return abs(a); },
        [](double x) {
          return A{std::abs(x), x < 0 ? -1. : 1., 0};
        },
        all}},
      {"atan",
       {[](const Time& a) { return atan(a); },
        [](double x) {
          const double n = 1 + x * x;
          return A{std::atan(x), 1 / n, -2 * x / (n * n)};
        },
        all}},
      {"atan2",
       {[](const Time& a) { return atan2(a, Time(2)); },
        [](double x) {
          const double n = 4 + x * x;
          return A{std::atan2(x, 2), 2 / n, -4 * x / (n * n)};
        },
        all}},
      {"atan2",
       {[](const Time& a) { return atan2(Time(2), a); },
        [](double x) {
          const double n = 4 + x * x;
          return A{std::atan2(2, x), -2 / n, 4 * x / (n * n)};
        },
        all}},
      {"asin",
       {[](const Time& a) { return asin(a); },
        [](double x) {
          const double n = 1 - x * x;
          return A{std::asin(x), 1 / std::sqrt(n), x / (n * std::sqrt(n))};
        },
        small}},
      {"acos",
       {[](const Time& a) { return acos(a); },
        [](double x) {
          const double n = 1 - x * x;
          return A{std::acos(x), -1 / std::sqrt(n), -x / (n * std::sqrt(n))};
        },
        small}},
      {"max",
       {[](const Time& a) { return max(a * a, 1); },
        [](double x) {
          return x * x > 1 ? A{x * x, 2 * x, 2} : A{1, 0, 0};
        },
        all}},
      {"max",
       {[](const Time& a) { return max(1.0, a * a); },
        [](double x) {
          return x * x > 1 ? A{x * x, 2 * x, 2} : A{1, 0, 0};
        },
        all}},
      {"max",
       {[](const Time& a) { return max(a, a * a); },
        [](double x) {
          return x * x > x ? A{x * x, 2 * x, 2} : A{x, 1, 0};
        },
        all}},
      {"min",
       {[](const Time& a) { return min(a * a, 1); },
        [](double x) {
          return x * x < 1 ? A{x * x, 2 * x, 2} : A{1, 0, 0};
        },
        all}},
      {"min",
       {[](const Time& a) { return min(1.0, a * a); },
        [](double x) {
          return x * x < 1 ? A{x * x, 2 * x, 2} : A{1, 0, 0};
        },
        all}},
      {"min",
       {[](const Time& a) { return min(a, a * a); },
        [](double x) {
          return x * x < x ? A{x * x, 2 * x, 2} : A{x, 1, 0};
        },
        all}},
      {"inverse",
       {[](const Time& a) { return inverse(a); },
        [](double x) {
          return A{1 / x, -1 / (x * x), 2 / (x * x * x)};
        },
        all}},
  };
}

std::string text_of(const std::string& file) {
  std::ifstream in(std::string(lockstep::paths::kSource) + file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace

TEST_CASE("every function of jets has its derivatives in closed form", "[unit][math]") {
  for (const auto& [name, k] : known_functions())
    for (const double x : k.at) {
      const auto f = k.closed(x);
      const Time got = k.on_jet(Time(x, 1, 0)), faster = k.on_jet(Time(x, -2, 0.5));
      INFO(name << " at " << x);
      CHECK(near(got.v, f[0]));
      CHECK(near(got.d, f[1]));
      CHECK(near(got.h, f[2]));
      CHECK(near(faster.d, -2 * f[1]));
      CHECK(near(faster.h, 4 * f[2] + 0.5 * f[1]));
    }
}

TEST_CASE("the authors' page lists the functions that jets know", "[unit][math]") {
  const std::string header = text_of("/framework/include/lockstep/author/jet.h"),
                    page = text_of("/framework/docs/joints.md");
  std::set<std::string> known, listed, tried;
  const std::regex function("inline (?:Jet<N, T, D>|jet_detail::JetOf<A, B>) ([a-z0-9]+)\\("),
      row("\\n\\| `([a-z0-9_]+)\\([a-z, ]*\\)` \\|");
  for (std::sregex_iterator it(header.begin(), header.end(), function), end; it != end; ++it) known.insert((*it)[1]);
  known.erase("chain");  // of jet_detail
  for (std::sregex_iterator it(page.begin(), page.end(), row), end; it != end; ++it) listed.insert((*it)[1]);
  for (const auto& entry : known_functions()) tried.insert(entry.first);
  CHECK(known.size() >= 17);
  CHECK(known == tried);
  known.insert("value_of");
  CHECK(listed == known);
}

TEST_CASE("functions of std that return one of their arguments know jets", "[unit][math]") {
  const Time a(1.0, 2.0, 3.0), b(4.0, 5.0, 6.0);
  CHECK(std::max(a, b).d == 5.0);
  CHECK(std::min(a, b).d == 2.0);
  CHECK(std::clamp(Time(7), a, b).d == 5.0);
  CHECK(max(a, a + 0.0 * b).d == 2.0);  // of equal ones the first
  using std::max, std::min;
  static_assert(std::is_same_v<decltype(max(a, b)), Time>, "no reference to what may be a temporary");
  static_assert(std::is_same_v<decltype(min(a, b)), Time>);
  std::ostringstream written;
  written << b;
  CHECK(written.str() == "4");
}
