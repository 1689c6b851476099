// SPDX-License-Identifier: BSD-3-Clause
// The laws as a scene asks for them: made by name from the registry, units taken, errors with place and key.
#include <cstdio>
#include <fstream>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/frame_laws.h>
#include <lockstep/laws.h>
#include <lockstep/math.h>
#include <lockstep/splines.h>
#include "framework/description/registry/builtins.h"
#include "tests/support/law_checks.h"

namespace motionlaws_make_test {

using namespace lockstep;
using namespace lockstep::test;

namespace {

const Registry& registry() {
  static const Registry r = [] {
    Registry made;
    register_motion_laws(made);
    return made;
  }();
  return r;
}

using Members = std::initializer_list<std::pair<const char*, Value>>;

LawPtr<MotionLaw> make(const char* type, Members members) {
  return registry().laws.make(type, Params(members), &registry(), "link 'A', law");
}

Value law_value(const char* type, const char* key, double value) {
  return Value::object({{"type", type}, {key, value}});
}

void check_same(const MotionLaw& a, const MotionLaw& b) {
  for (const double t : {-0.3, 0.0, 0.1, 0.25, 0.4, 0.77, 1.0}) {
    INFO("t = " << t);
    CHECK(a.at(t).y == Approx(b.at(t).y).margin(1e-14));
    CHECK(a.at(t).yd == Approx(b.at(t).yd).margin(1e-13));
    CHECK(a.at(t).ydd == Approx(b.at(t).ydd).margin(1e-12));
  }
}

}  // namespace

TEST_CASE("every scalar law is made by name like its C++ function", "[unit][motionlaws]") {
  check_same(*make("constant", {{"value", "12 mm"}}), *laws::ramp(0, 0, 0.012));
  check_same(*make("ramp", {{"slope", "60 rpm"}, {"t0", 0.2}, {"y0", 1}}), *laws::ramp(kTwoPi, 0.2, 1));
  check_same(*make("sine", {{"amplitude", 2}, {"frequency", "3 Hz"}, {"phase", "90 deg"}, {"offset", 1}}),
             *laws::sine({2, 3 * kTwoPi, kPi / 2, 1}));
  check_same(*make("sine", {{"omega", "120 rpm"}}), *laws::sine({.omega = 2 * kTwoPi}));
  check_same(*make("fourier", {{"omega", 2}, {"cosines", Value::list({1, 2})}, {"sines", Value::list({3})}}),
             *laws::fourier({2, 0, {1, 2}, {3}}));
  check_same(*make("polynomial", {{"coefficients", Value::list({1, 2, 3})}, {"t0", 0.1}}), *laws::polynomial({1, 2, 3}, 0.1));
  const RiseSettings rise{2, 0.5, 0.1, 1};
  const Members given{{"rise", 2}, {"duration", "500 ms"}, {"t0", 0.1}, {"y0", 1}};
  check_same(*make("poly345", given), *laws::poly345(rise));
  check_same(*make("cycloid", given), *laws::cycloid(rise));
  check_same(*make("harmonic_rise", given), *laws::harmonic_rise(rise));
  check_same(*make("trapezoid", {{"distance", 1}, {"speed", 2}, {"duration", 0.8}}),
             *laws::trapezoid({.distance = 1, .speed = 2, .duration = 0.8}));
  const auto inner = laws::ramp(2.0);
  const Value two = law_value("ramp", "slope", 2.0);
  check_same(*make("sum", {{"laws", Value::List{two, 0.5}}}), *laws::sum({inner, laws::ramp(0, 0, 0.5)}));
  check_same(*make("product", {{"laws", Value::List{two, two}}}), *laws::product({inner, inner}));
  check_same(*make("scale", {{"law", two}, {"factor", 3}, {"offset", 1}}), *laws::scale(inner, 3, 1));
  check_same(*make("shift", {{"law", two}, {"delay", 0.3}}), *laws::shift(inner, 0.3));
  check_same(*make("repeat", {{"law", two}, {"period", 0.3}, {"drift", true}}), *inner);
  const Members pieces{{"durations", Value::list({0.3, 0.4})},
                       {"laws", Value::List{two, two}},
                       {"continue", true},
                       {"outside", "run_on"}};
  check_same(*make("sequence", pieces), *inner);
}

TEST_CASE("spline is made from points and from a file next to the scene", "[unit][motionlaws]") {
  const SplinePoints points{{0, 1}, {0.5, 3}, {1, 2}};
  const auto expected = laws::spline(points, {5, SplineEnds::clamped, SplineOutside::hold}, {1, 2, 3, 4});
  const Value list(Value::List{Value::list({0, 1}), Value::list({0.5, 3}), Value::list({1, 2})});
  check_same(*make("spline", {{"points", list},
                              {"degree", 5},
                              {"ends", "clamped"},
                              {"outside", "hold"},
                              {"start_rate", 1},
                              {"end_rate", 2},
                              {"start_acceleration", 3},
                              {"end_acceleration", 4}}),
             *expected);
  const std::string file = "motionlaws_make_test.csv";
  std::ofstream(file) << "time [s],lift [m]\n0,1\n0.5,3\n1,2\n";
  check_same(*make("spline", {{"file", file.c_str()}, {"t_column", "time"}, {"y_column", "lift"}, {"outside", "hold"}}),
             *laws::spline(points, {.outside = SplineOutside::hold}));
  std::ofstream(file) << "t,y\n0,1\n0.5,x\n";
  CHECK_THROWS_WITH(make("spline", {{"file", file.c_str()}}), says(file + ":3"));
  std::remove(file.c_str());
  CHECK_THROWS_WITH(make("spline", {{"file", file.c_str()}, {"points", list}}),
                    says("link 'A', law") && says("one of the two"));
  CHECK_THROWS_WITH(make("spline", {{"points", list}, {"start_rate", 1}}), says("start_rate") && says("clamped"));
  CHECK_THROWS_WITH(make("spline", {{"points", list}, {"ends", "periodic"}}), says("points") && says("first"));
  CHECK_THROWS_WITH(make("spline", {{"points", Value(Value::List{Value::list({0, 1, 2})})}}),
                    says("3 numbers in point 1"));
}

TEST_CASE("makers report errors with place, key, value and limit", "[unit][motionlaws]") {
  CHECK_THROWS_WITH(make("poly345", {{"rise", 1}, {"duration", -1}}),
                    says("link 'A', law.duration") && says("is -1; must be above 0"));
  CHECK_THROWS_WITH(make("ramp", {{"slop", 1}}), says("slop") && says("slope"));
  CHECK_THROWS_WITH(make("sine", {}), says("omega") && says("frequency"));
  CHECK_THROWS_WITH(make("sine", {{"omega", 1}, {"frequency", 1}}), says("one of the two"));
  CHECK_THROWS_WITH(make("fourier", {}), says("omega"));
  CHECK_THROWS_WITH(make("trapezoid", {{"distance", 1}, {"speed", 0}, {"duration", 1}}),
                    says("law.speed") && says("above 0"));
  CHECK_THROWS_WITH(make("trapezoid", {{"distance", 1}, {"speed", 1}}), says("give two"));
  CHECK_THROWS_WITH(make("sequence", {{"durations", Value::list({1, 2})}, {"laws", Value::List{1.0}}}),
                    says("2 for 1 laws"));
  CHECK_THROWS_WITH(make("repeat", {{"law", 1}, {"period", 0}}), says("law.period"));
  CHECK_THROWS_WITH(make("polynomial", {{"coefficients", Value(Value::List{})}}), says("law.coefficients"));
}

TEST_CASE("translation and rotation laws are made by name like their C++ functions", "[unit][motionlaws]") {
  const auto translation_of = [](const char* type, Members m) {
    return registry().translation_laws.make(type, Params(m), &registry(), "marker 'P', slide");
  };
  const auto rotation_of = [](const char* type, Members m) {
    return registry().rotation_laws.make(type, Params(m), &registry(), "marker 'P', spin");
  };
  const auto same_way = [](const TranslationLaw& a, const TranslationLaw& b) {
    for (const double t : {0.0, 0.3, 1.0}) {
      CHECK((a.at(t).x - b.at(t).x).norm() < 1e-14);
      CHECK((a.at(t).v - b.at(t).v).norm() < 1e-13);
      CHECK((a.at(t).a - b.at(t).a).norm() < 1e-12);
    }
  };
  const auto same_turn = [](const RotationLaw& a, const RotationLaw& b) {
    for (const double t : {0.0, 0.3, 1.0}) {
      CHECK((a.at(t).q.coefficients() - b.at(t).q.coefficients()).norm() < 1e-14);
      CHECK((a.at(t).w - b.at(t).w).norm() < 1e-13);
      CHECK((a.at(t).a - b.at(t).a).norm() < 1e-12);
    }
  };
  const Value two = law_value("ramp", "slope", 2.0);
  same_way(*translation_of("constant", {{"value", Value(Value::List{"1 mm", 0, 2})}}),
           *laws::constant_translation(Vec3(1e-3, 0, 2)));
  same_way(*translation_of("components", {{"y", two}}), *laws::components(laws::ramp(0), laws::ramp(2), laws::ramp(0)));
  same_way(*translation_of("along", {{"axis", "-z"}, {"law", two}, {"origin", Value::list({1, 2, 3})}}),
           *laws::along(Vec3(0, 0, -1), laws::ramp(2), Vec3(1, 2, 3)));
  const Value points(Value::List{Value::list({0, 1, 2, 3}), Value::list({0.5, 3, 2, 1}), Value::list({1, 0, 0, 0})});
  same_way(*translation_of("path", {{"points", points}, {"ends", "clamped"}, {"end_velocity", Value::list({1, 2, 3})}}),
           *laws::path({{0, {1, 2, 3}}, {0.5, {3, 2, 1}}, {1, {0, 0, 0}}}, {.ends = SplineEnds::clamped},
                 {.end_velocity = {1, 2, 3}}));

  const Value turn = Value::object({{"axis", "x"}, {"angle", "90 deg"}});
  same_turn(*rotation_of("constant", {{"orientation", turn}}), *laws::constant_rotation({1, 1, 0, 0}));
  same_turn(*rotation_of("axis_rotation", {{"axis", "y"}, {"law", two}}), *laws::axis_rotation(Vec3(0, 1, 0), laws::ramp(2)));
  const Value spin = Value::object({{"type", "axis_rotation"}, {"axis", "y"}, {"law", two}});
  const Value fixed = Value::object({{"type", "constant"}, {"orientation", turn}});
  same_turn(*rotation_of("product", {{"first", fixed}, {"second", spin}}),
            *laws::rotation_product(laws::constant_rotation({1, 1, 0, 0}), laws::axis_rotation(Vec3(0, 1, 0), laws::ramp(2))));
  const Value poses(Value::List{Value(Value::List{0, Value::list({1, 0, 0, 0})}), Value(Value::List{"1 s", turn})});
  same_turn(*rotation_of("spline_rotation", {{"points", poses}, {"ends", "clamped"}}),
            *laws::spline_rotation({{0, {}}, {1, {1, 1, 0, 0}}}, {.ends = SplineEnds::clamped}));

  CHECK_THROWS_WITH(translation_of("path", {{"points", points}, {"start_velocity", Value::list({1, 2, 3})}}),
                    says("start_velocity"));
  CHECK_THROWS_WITH(rotation_of("spline_rotation", {{"points", 3}}),
                    says("spin (spline_rotation).points: ") && says("list"));
  CHECK_THROWS_WITH(rotation_of("spline_rotation", {{"points", Value(Value::List{Value::list({0})})}}),
                    says("spin (spline_rotation).points[0]: "));
  CHECK_THROWS_WITH(rotation_of("spline_rotation", {{"points", poses}, {"degree", 2}}),
                    says("spin (spline_rotation).degree: ") && says("3 or 5"));
}

template <class L>
void check_tables(const Shelf<LawPtr<L>>& shelf, std::size_t n_expected) {
  for (const auto& [name, entry] : shelf.entries()) {
    INFO(name);
    CHECK(entry.info.name == name);
    CHECK(!entry.info.help.empty());
    for (const Key& key : entry.info.keys) CHECK(!key.help.empty());
    CHECK_NOTHROW(check_type_info(entry.info));
  }
  CHECK(shelf.entries().size() == n_expected);
}

TEST_CASE("every law's table of keys can be read", "[unit][motionlaws]") {
  check_tables(registry().laws, 18);
  check_tables(registry().translation_laws, 4);
  check_tables(registry().rotation_laws, 4);
}

}  // namespace motionlaws_make_test
