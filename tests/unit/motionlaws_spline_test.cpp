// SPDX-License-Identifier: BSD-3-Clause
// The spline law and its table: interpolation, continuity at the points, reproduced polynomials, ends, outside, errors.
#include <cstdio>
#include <fstream>

#include <lockstep/error.h>
#include <lockstep/math.h>
#include <lockstep/splines.h>
#include "tests/support/law_checks.h"
#include "tests/support/messages.h"

namespace motionlaws_spline_test {

using namespace lockstep;
using namespace lockstep::test;

namespace {

const std::vector<double> kTimes{0.0, 0.1, 0.35, 0.4, 1.0, 1.7, 2.0};

template <class F>
SplinePoints points(F f) {
  SplinePoints p;
  for (const double t : kTimes) p.emplace_back(t, f(t));
  return p;
}

// No number repeats and nothing is smooth, but the last equals the first.
const SplinePoints kRough{{0.0, 0.3}, {0.1, -0.2}, {0.35, 0.9}, {0.4, 1.1}, {1.0, -1.0}, {1.7, 0.2}, {2.0, 0.3}};

constexpr SplineEnds kEnds[] = {SplineEnds::natural, SplineEnds::clamped, SplineEnds::periodic};

// Third and fourth derivative of the quintic from three accelerations on a short piece inside an interval: ydd is a
// cubic there, so divided differences of ydd at four instants give them exactly.
std::pair<double, double> higher(const MotionLaw& law, double t, double h) {
  const double a = law.at(t).ydd, b = law.at(t + h).ydd, c = law.at(t + 2 * h).ydd, d = law.at(t + 3 * h).ydd;
  return {(-11 * a + 18 * b - 9 * c + 2 * d) / (6 * h), (2 * a - 5 * b + 4 * c - d) / (h * h)};
}

}  // namespace

TEST_CASE("spline goes through its points with continuous value, speed and acceleration", "[unit][motionlaws]") {
  for (const int degree : {3, 5})
    for (const SplineEnds ends : kEnds) {
      INFO("degree " << degree << ", ends " << static_cast<int>(ends));
      const auto law = laws::spline(kRough, {.degree = degree, .ends = ends});
      for (const auto& [t, y] : kRough) CHECK(law->at(t).y == Approx(y).margin(1e-12));
      LawValue size{1, 1, 1};
      for (int i = 0; i <= 100; ++i) {
        const LawValue v = law->at(0.02 * i);
        size = {std::max(size.y, std::abs(v.y)), std::max(size.yd, std::abs(v.yd)),
                std::max(size.ydd, std::abs(v.ydd))};
      }
      for (std::size_t i = 1; i + 1 < kTimes.size(); ++i)
        CHECK(remaining_change(*law, kTimes[i] - 0.01, kTimes[i] + 0.01, size) < 1e-6);
      check_breakpoints(*law, 0.0, 2.0, {});
    }
}

TEST_CASE("spline speed and acceleration are derivatives of its value", "[unit][motionlaws]") {
  // Inside an interval the law is a polynomial of known degree: its own values fix it, and with it the derivatives.
  for (const int degree : {3, 5}) {
    const auto law = laws::spline(kRough, {.degree = degree});
    const double a = 1.0, b = 1.7, h = (b - a) / degree;
    MatX V(degree + 1, degree + 1);
    VecX y(degree + 1);
    for (int i = 0; i <= degree; ++i) {
      for (int k = 0; k <= degree; ++k) V(i, k) = std::pow(h * i, k);
      y[i] = law->at(a + h * i - (i == degree ? 1e-14 : 0)).y;
    }
    VecX c = y;  // V c = y by elimination
    for (int k = 0; k <= degree; ++k)
      for (int i = k + 1; i <= degree; ++i) {
        const double f = V(i, k) / V(k, k);
        V.row(i) -= f * V.row(k);
        c[i] -= f * c[k];
      }
    for (int k = degree; k >= 0; --k) {
      for (int j = k + 1; j <= degree; ++j) c[k] -= V(k, j) * c[j];
      c[k] /= V(k, k);
    }
    check_formula(
        *law,
        [&](auto t) {
          auto r = 0.0 * t;
          for (int k = degree; k >= 0; --k) r = r * (t - a) + c[k];
          return r;
        },
        a + 1e-9, b - 1e-9, 1e-10);
  }
}

TEST_CASE("quintic spline: jerk and its rate are continuous, and zero at natural ends", "[unit][motionlaws]") {
  for (const SplineEnds ends : kEnds) {
    const auto law = laws::spline(kRough, {.degree = 5, .ends = ends});
    // From both sides towards each point, exact but for rounding.
    for (std::size_t i = 1; i + 1 < kTimes.size(); ++i) {
      const double t = kTimes[i], hl = (t - kTimes[i - 1]) / 4, hr = (kTimes[i + 1] - t) / 4;
      const auto left = higher(*law, t, -hl), right = higher(*law, t, hr);
      CHECK(left.first == Approx(right.first).epsilon(1e-8).margin(1e-6));
      CHECK(left.second == Approx(right.second).epsilon(1e-7).margin(1e-4));
    }
    const auto first = higher(*law, 0.0, 0.02), last = higher(*law, 2.0, -0.05);
    if (ends == SplineEnds::natural) {
      CHECK(std::abs(first.first) < 1e-6);
      CHECK(std::abs(first.second) < 1e-4);
      CHECK(std::abs(last.first) < 1e-6);
      CHECK(std::abs(last.second) < 1e-4);
    }
    if (ends == SplineEnds::periodic) {
      CHECK(first.first == Approx(last.first).epsilon(1e-8));
      CHECK(first.second == Approx(last.second).epsilon(1e-7));
    }
  }
}

TEST_CASE("spline reproduces the polynomials that its ends admit", "[unit][motionlaws]") {
  const auto line = [](auto t) { return 1.0 - 2.0 * t; };
  check_formula(
      *laws::spline(points(line)), [](auto t) { return 1.0 - 2.0 * t; }, 0, 2, 1e-12, 101, 1.0);
  const auto parabola = [](auto t) { return 1.0 - 2.0 * t + 0.7 * t * t; };
  check_formula(*laws::spline(points(parabola), {.degree = 5}), parabola, 0, 2, 1e-11);
  const auto cubic = [](auto t) { return 1.0 - 2.0 * t + 0.7 * t * t - 0.4 * t * t * t; };
  check_formula(*laws::spline(points(cubic), {.ends = SplineEnds::clamped}, {.start_rate = -2, .end_rate = -4}), cubic, 0, 2,
                1e-12);
  const auto quintic = [&](auto t) { return cubic(t) + t * t * t * t * (0.3 - 0.1 * t); };
  const Time end = quintic(Time(2, 1, 0));
  check_formula(*laws::spline(points(quintic), {.degree = 5, .ends = SplineEnds::clamped}, {-2, end.d, 1.4, end.h}), quintic,
                0, 2, 1e-11);
  // Two points, clamped: one polynomial, at rest at both ends. For the quintic that is the 3-4-5 rise.
  const auto u345 = [](auto t) { return t * t * t * (10.0 - 15.0 * t + 6.0 * t * t); };
  check_formula(*laws::spline({{0, 0}, {1, 1}}, {.degree = 5, .ends = SplineEnds::clamped}), u345, 0, 1, 1e-14);
}

TEST_CASE("a law without a value beyond its points reports the setting that extends it", "[unit][motionlaws]") {
  const auto problem = [](SplineEnds ends) {
    return testing::message_of<ModelError>([&] { laws::spline({{0, 1}, {1, -1}, {2, 1}}, {.ends = ends})->at(3); });
  };
  testing::check_words(problem(SplineEnds::natural),
                       {"has points from 0 to 2 and no value at 3", "\"outside\" to \"hold\""});
  testing::check_words(problem(SplineEnds::periodic), {"\"outside\" to \"repeat\""});
}

TEST_CASE("periodic spline meets itself and repeats", "[unit][motionlaws]") {
  for (const int degree : {3, 5}) {
    const auto law = laws::spline(kRough, {.degree = degree, .ends = SplineEnds::periodic, .outside = SplineOutside::repeat});
    check_breakpoints(*law, -3.3, 5.1, {});
    for (const double t : {0.05, 0.9, 1.9}) {
      CHECK(law->at(t + 4).ydd == Approx(law->at(t).ydd));
      CHECK(law->at(t - 2).yd == Approx(law->at(t).yd));
    }
  }
  // Three points only: one row beside the border.
  const auto three =
      laws::spline({{0, 1}, {1, -1}, {2, 1}}, {.ends = SplineEnds::periodic, .outside = SplineOutside::repeat});
  check_breakpoints(*three, -3, 3, {});
  CHECK(three->at(0.5).y == Approx(0).margin(1e-14));
}

TEST_CASE("spline outside of its points: rejected, or held with its jumps", "[unit][motionlaws]") {
  testing::check_words(testing::message_of<ModelError>([&] { laws::spline(kRough)->at(2.1); }),
                       {"spline", "points from 0 to 2 and no value at 2.1"});
  CHECK_THROWS_WITH(laws::spline(kRough)->at(-0.5),
                    says("spline") && says("from 0 to 2 and no value at -0.5") && says("hold"));
  CHECK(laws::spline(kRough)->at(2.0 + 1e-12).y == Approx(0.3));
  const auto whose = [](const auto& law) {
    try {
      law->at(9);
    } catch (const ModelError& error) {
      return error.thing.kind + " " + error.thing.type + " " + error.thing.origin;
    }
    return std::string("no error");
  };
  CHECK(whose(laws::spline(kRough)) == "law spline built in");
  CHECK(whose(laws::path({{0, Vec3(0, 0, 0)}, {1, Vec3(1, 0, 0)}})) ==
        "law path built in");
  CHECK(whose(laws::spline_rotation({{0, Quat{}}, {1, Quat{}}})) == "law spline_rotation built in");
  const auto held = laws::spline(kRough, {.outside = SplineOutside::hold});
  CHECK(held->at(7).y == Approx(0.3));
  CHECK(held->at(7).yd == 0);
  CHECK(held->at(-7).ydd == 0);
  check_breakpoints(*held, -1, 3, {0, 2});
  check_breakpoints(*laws::spline(kRough, {.degree = 5, .ends = SplineEnds::clamped, .outside = SplineOutside::hold}), -1, 3,
                    {});
}

// Where rate and acceleration of an end are zero, holding the value changes neither.
TEST_CASE("a held spline breaks only at the end with a speed", "[unit][motionlaws]") {
  struct Ends {
    SplineEndValues values;      // at 0.5 s and at 2 s
    std::vector<double> breaks;  // s
  };
  const Ends all[] = {{{0, 0, 0, 0}, {}},       {{0, 1.5, 0, 0}, {2}},     {{-0.7, 0, 0, 0}, {0.5}},
                      {{0, 0, 0, 3}, {2}},      {{0, 0, -2, 0}, {0.5}},    {{0, 1.5, 0, -2}, {2}},
                      {{-0.7, 0, 4, 0}, {0.5}}, {{1, -1, 0, 0}, {0.5, 2}}, {{0, -1, 2, 0}, {0.5, 2}}};
  for (const auto& [values, breaks] : all) {
    CAPTURE(values.start_rate, values.end_rate, values.start_acceleration, values.end_acceleration);
    const SplineSettings held{.degree = 5, .ends = SplineEnds::clamped, .outside = SplineOutside::hold};
    const auto law = laws::spline({{0.5, 1}, {0.9, -0.4}, {1.4, 0.6}, {2, 0.2}}, held, values);
    check_breakpoints(*law, -1, 3, breaks);
    // The interval is open: an end on its edge is no break of it.
    check_breakpoints(*law, 0.5, 2, {});
  }
}

TEST_CASE("a long table stays exact and cheap", "[unit][motionlaws]") {
  SplinePoints p;
  for (int i = 0; i <= 4000; ++i) p.emplace_back(0.001 * i, std::sin(0.001 * i));
  const SplineEndValues ends{1.0, std::cos(4.0), 0.0, -std::sin(4.0)};
  const auto law = laws::spline(p, {.degree = 5, .ends = SplineEnds::clamped}, ends);
  check_formula(
      *law, [](auto t) { return sin(t); }, 0, 4, 1e-9, 333);
}

TEST_CASE("spline rejects impossible arguments", "[unit][motionlaws]") {
  CHECK_THROWS_WITH(laws::spline({{0, 1}}), says("spline") && says("1; at least 2"));
  CHECK_THROWS_WITH(laws::spline({{0, 1}, {1, 2}}, {.degree = 5}), says("at least 3"));
  CHECK_THROWS_WITH(laws::spline({{0, 1}, {1, 2}}, {.degree = 4}), says("degree is 4; must be 3 or 5"));
  CHECK_THROWS_WITH(laws::spline({{0, 1}, {1, 2}, {0.5, 2}}), says("number 3 of points has 0.5, the one before 1"));
  CHECK_THROWS_WITH(laws::spline({{0, 1}, {0, 2}}), says("must increase"));
  CHECK_THROWS_WITH(laws::spline({{0, 1}, {1, std::nan("")}}), says("not finite") && says("number 2"));
  CHECK_THROWS_WITH(laws::spline({{0, 1}, {1, 2}, {2, 3}}, {.ends = SplineEnds::periodic}), says("end 2 away"));
  CHECK_THROWS_WITH(laws::spline(kRough, {.outside = SplineOutside::repeat}), says("outside is \"repeat\""));
}

TEST_CASE("columns of a CSV file, and errors with file and line", "[unit][motionlaws]") {
  const std::string path = "motionlaws_columns_test.csv";
  const auto write = [&](const char* text) { std::ofstream(path) << text; };
  write("# measured\nt [s],x [m],y [m]\n0,1,2.5e-1\n\n 0.5 , +3 ,-4\r\n2,5,6\n");
  const Columns c = read_columns(path, "t", {"y", "x"});
  CHECK(c.t == std::vector<double>{0, 0.5, 2});
  CHECK(c.y(0, 0) == 0.25);
  CHECK(c.y(1, 0) == -4);
  CHECK(c.y(1, 1) == 3);
  CHECK(read_columns(path, "1", {"3"}).y(2, 0) == 6);
  CHECK_THROWS_WITH(read_columns(path, "t", {"why"}), says(path + ":2: no column 'why'"));
  CHECK_THROWS_WITH(read_columns(path, "t", {"9"}), says("no column 9: there are ") && !says("did you mean"));
  write("0;1\n1;2\n");
  CHECK(read_columns(path, "1", {"2"}).y(1, 0) == 2);
  CHECK_THROWS_WITH(read_columns(path, "t", {"2"}), says("no header"));
  write("t,y\n0,1\n1,abc\n");
  CHECK_THROWS_WITH(read_columns(path, "t", {"y"}), says(path + ":3") && says("'abc'"));
  write("t,y\n0,1\n1,nan\n");
  CHECK_THROWS_WITH(read_columns(path, "t", {"y"}), says(path + ":3"));
  write("t,y\n0,1\n1\n");
  CHECK_THROWS_WITH(read_columns(path, "t", {"y"}), says(path + ":3:2: has 1 cell"));
  write("t,y\n0,1\n2,1\n1,5\n");
  CHECK_THROWS_WITH(read_columns(path, "t", {"y"}), says(path + ":4") && says("column 't': 1 does not come after 2"));
  write("t,y\n");
  testing::check_words(testing::message_of<FileError>([&] { read_columns(path, "t", {"y"}); }), {"no rows of numbers"});

  // Decimal commas: numbers where something else separates cells, refused where they separate.
  write("t;y\n0;1,94\n0,5;-2,5e-1\n1;3,5\n");
  const Columns commas = read_columns(path, "t", {"y"});
  CHECK(commas.t == std::vector<double>{0, 0.5, 1});
  CHECK(commas.y(0, 0) == 1.94);
  CHECK(commas.y(1, 0) == -0.25);
  CHECK(commas.y(2, 0) == 3.5);
  write("t\ty\n0\t1,5\n");
  CHECK(read_columns(path, "t", {"y"}).y(0, 0) == 1.5);
  write("t;y\n0;0\n1;1.234\n2;1,5\n");
  testing::check_words(testing::message_of<FileError>([&] { read_columns(path, "t", {"y"}); }),
                       {path + ":4: column 'y' has 1,5, with a decimal comma", "line 3", "one decimal sign"});
  write("0,5;1\n1.5;2\n");
  CHECK_THROWS_WITH(read_columns(path, "1", {"2"}), says(path + ":2: column 1 has 1.5, with a decimal point"));
  // Of columns that are read: notes and numbers of others may be written otherwise.
  write("t;y;note;other\n0;0,5;1.2;1.5\n1;1,5;v 2.0;1,5\n2;0;3,4;1.234,5\n");
  CHECK(read_columns(path, "t", {"y"}).y(1, 0) == 1.5);
  testing::check_words(testing::message_of<FileError>([&] {
                         read_columns(path, "t", {"y", "other"});
                       }),
                       {path + ":2: column 'other' has 1.5, with a decimal point", "line 2"});
  write("t;y;z\n0;0;1.5\n1;0,5;1\n");  // in two columns that are read
  CHECK_THROWS_WITH(read_columns(path, "t", {"y", "z"}), says(path + ":3: column 'y' has 0,5") && says("line 2"));
  CHECK(read_columns(path, "t", {"z"}).y(0, 0) == 1.5);
  write("t;y\n0;1,234.5\n");
  CHECK_THROWS_WITH(read_columns(path, "t", {"y"}), says(path + ":2: column 2, '1,234.5'"));
  write("t,y\n0,1\n0.2,0,02\n");
  CHECK_THROWS_WITH(read_columns(path, "t", {"y"}),
                    says(path + ":3:7: has 3 cells, the first line has 2; if its commas are decimal"));
  write("t,y\n0,\"1,5\"\n");
  CHECK_THROWS_WITH(read_columns(path, "t", {"y"}), says(path + ":2") && says("'1,5'") && says("by semicolons"));

  // Units of the header, quotes, the mark before UTF-8, line ends of other systems.
  write("\xEF\xBB\xBF\"t [ms]\",\"turn, crank [deg]\",y [mm],n [1]\r\n0,0,0.3,7\r\n20,180,12,8\r\n");
  const Columns units = read_columns(path, "t", {"turn, crank", "y", "n"});
  CHECK(units.t == std::vector<double>{0, 0.02});
  CHECK(units.y(0, 1) == 0.0003);
  CHECK(units.y(1, 0) == kPi);
  CHECK(units.y(1, 1) == 0.012);
  CHECK(units.y(1, 2) == 8);
  write("phi [deg],mu [-],\"a; b\"\n0,1,3\n180,2,4\n");  // a table over an angle, and a pure number
  const Columns cam = read_columns(path, "phi", {"mu", "a; b"});
  CHECK(cam.t == std::vector<double>{0, kPi});
  CHECK(cam.y(1, 0) == 2);
  CHECK(cam.y(1, 1) == 4);
  write("t,\ty\n0,\t1\n");  // tabs that only align
  CHECK(read_columns(path, "t", {"y"}).y(0, 0) == 1);
  write(",t,y\n0,0,1\n");
  CHECK_THROWS_WITH(read_columns(path, "t", {"x"}), says("no column 'x'") && !says("no header"));
  write("t,y [mmm]\n0,1\n");
  CHECK_THROWS_WITH(read_columns(path, "t", {"y"}), says(path + ":1: column 'y'") && says("unknown unit \"mmm\""));

  write("t,y,y\n0,1,2\n");
  CHECK_THROWS_WITH(read_columns(path, "t", {"y"}), says(path + ":1: two columns are named 'y'"));
  CHECK(read_columns(path, "t", {"3"}).y(0, 0) == 2);
  write("0,O.5\n1,2\n");
  CHECK_THROWS_WITH(read_columns(path, "1", {"2"}), says(path + ":1") && says("'O.5'"));
  write("t y\n0 1\n");
  CHECK_THROWS_WITH(read_columns(path, "t", {"y"}), says("separated by commas, semicolons or tabs"));
  write("\xFF\xFEt,y\n");
  CHECK_THROWS_WITH(read_columns(path, "t", {"y"}), says("UTF-16"));
  std::remove(path.c_str());
  CHECK_THROWS_WITH(read_columns(path, "t", {"y"}), says(path) && says("cannot be opened"));
}

}  // namespace motionlaws_spline_test
