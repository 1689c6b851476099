// SPDX-License-Identifier: BSD-3-Clause
// Points on curves and followers of paths: held against a search along the curve; round and round; what is refused.
#include <lockstep/couplings.h>

#include <lockstep/author/check.h>
#include <lockstep/error.h>
#include <lockstep/frame_laws.h>
#include <lockstep/laws.h>
#include <lockstep/splines.h>
#include "tests/support/catch.h"
#include "tests/support/link_bench.h"
#include "tests/support/messages.h"
#include "tests/support/worst.h"

namespace curve_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::least, lockstep::testing::LinkBench,
    lockstep::testing::message_of;

namespace {

LawPtr<TranslationLaw> helix() {
  return laws::translation([](auto s) { return std::array{0.5 * cos(s), 0.5 * sin(s), 0.2 * s}; });
}
LawPtr<TranslationLaw> loop() {  // a closed curve in space
  return laws::translation([](auto s) { return std::array{cos(s), 0.6 * sin(s), 0.2 * sin(2.0 * s)}; });
}
LawPtr<RotationLaw> turning() {
  return laws::rotation([](auto s) {
    return QuatT<decltype(s)>{cos(0.5 * s), 0.3 * sin(s), 0.2 * cos(s), sin(0.5 * s)};
  });
}

/// The same moved.
LawPtr<TranslationLaw> shifted(const LawPtr<TranslationLaw>& path, const Vec3& by) {
  class Shifted final : public TranslationLaw {
   public:
    Shifted(LawPtr<TranslationLaw> path, const Vec3& by) : path_(std::move(path)), by_(by) {}
    TranslationValue at(double t) const override {
      TranslationValue v = path_->at(t);
      return v.x += by_, v;
    }

   private:
    LawPtr<TranslationLaw> path_;
    Vec3 by_;
  };
  return std::make_shared<const Shifted>(path, by);
}

Vec3 aside(const LawPtr<TranslationLaw>& path, double s, double by) {
  return path->at(s).x + by * Vec3(std::sin(3 * s), std::cos(2 * s), std::sin(5 * s + 1));
}

}  // namespace

TEST_CASE("A point's two constraints are its distance from its curve", "[unit][links]") {
  for (const auto& path : {helix(), loop()})
    for (int i = 0; i < 30; ++i) {
      const double s = 0.2 * i;
      const Vec3 p = aside(path, s, 0.05);
      LinkBench bench({p, Quat{}});
      const auto& link = bench.system.add<PointOnCurve>("wire", bench.p(), bench.s(), path, s + 0.3);
      bench.begin();
      bench.put({p, Quat{}});
      const auto [foot, distance] = least([&](double u) { return (path->at(u).x - p).norm(); }, s - 0.5, s + 0.5);
      CAPTURE(s);
      CHECK(std::abs(std::hypot(bench.C(0), bench.C(1)) - distance) <= 1e-14);
      CHECK(std::abs(bench.quantity(link, 0) - foot) <= 1e-6);  // the search finds a minimum's place no better
    }
}

TEST_CASE("A point on a closed curve counts its way, and a rewound step counts once", "[unit][links]") {
  LinkBench bench({loop()->at(0).x, Quat{}});
  const auto& link = bench.system.add<PointOnCurve>("wire", bench.p(), bench.s(), loop());
  bench.begin();
  double s = 0, worst = 0;
  const auto go = [&](double by) {
    const double dt = 0.1;
    s += by;
    bench.put({loop()->at(s).x, Quat{}}, dt, loop()->at(s).v * by / dt);
    for (const double off : {bench.C(0), bench.C(1), bench.quantity(link, 0) - s}) keep_worst(worst, std::abs(off));
    CHECK(std::abs(bench.quantity(link, 1) - by / dt) <= 1e-11 * std::max(1.0, std::abs(by / dt)));
    bench.accept();
  };
  for (int i = 0; i < 200; ++i) go(0.4);  // 12 rounds
  const State before = bench.state;
  const double there = s;
  for (int i = 0; i < 20; ++i) go(0.4);
  bench.state = before, s = there;
  for (int i = 0; i < 100; ++i) go(-0.5);
  CHECK(s > 20);
  CHECK(worst <= 1e-12);
}

TEST_CASE("A follower's constraints are zero on its path with its path's axes, and only there", "[unit][links]") {
  for (int i = 0; i < 20; ++i) {
    const double s = 0.3 * i + 0.1;
    const Pose on{helix()->at(s).x, turning()->at(s).q};
    LinkBench bench(on);
    const auto& link = bench.system.add<PathFollower>("rail", bench.p(), bench.s(), {helix(), turning(), s});
    bench.begin();
    bench.put(on);
    CAPTURE(s);
    for (int k = 0; k < 5; ++k) CHECK(std::abs(bench.C(k)) <= 1e-14);
    CHECK(std::abs(bench.quantity(link, 0) - s) <= 1e-13);
    const Vec3 half(0.03, -0.05, 0.02);  // turned by twice that, in the path's axes
    bench.put({on.x, on.q * Quat{std::sqrt(1 - half.squaredNorm()), half[0], half[1], half[2]}});
    for (int k = 0; k < 3; ++k) CHECK(std::abs(bench.C(2 + k) - half[k]) <= 1e-14);
    CHECK(std::hypot(bench.C(0), bench.C(1)) <= 1e-14);
  }
}

TEST_CASE("Points on curves and followers pass the check of links", "[unit][links]") {
  PathPoints points;  // longer than the check goes
  for (int i = -4; i <= 8; ++i) points.emplace_back(i, Vec3(i, 0.3 * std::sin(i), 0.3 * std::cos(2 * i)));
  const auto splined = laws::path(points, {.degree = 5});
  for (const auto& way : {helix(), loop(), splined})
    for (const bool follower : {false, true})
      for (int i = 0; i < 3; ++i) {
        const double s = 1.2 + 0.6 * i;
        // P near z of S, where turns about it leave it: else it would leave its piece of the curve
        const auto near = shifted(way, -aside(way, s, 0.03));
        LinkBench bench({Vec3::Zero(), turning()->at(s).q});
        Lock& link =
            follower
                ? static_cast<Lock&>(bench.system.add<PathFollower>("way", bench.p(), bench.s(), {near, turning(), s}))
                : static_cast<Lock&>(bench.system.add<PointOnCurve>("way", bench.p(), bench.s(), near, s));
        const CheckReport report = check_lock(bench.system, link, {.seed = 5, .reach = 0.05, .turn = 0.2});
        INFO(report.text());
        CHECK(report.ok());
        CHECK(link.row_count() == (follower ? 5 : 2));
      }
}

TEST_CASE("A path that cannot be followed is rejected in words", "[unit][links]") {
  const auto wire = [](const LawPtr<TranslationLaw>& path, double near) {
    LinkBench bench({Vec3(0.2, 0.1, 0), Quat{}});
    return message_of<ModelError>(
        [&] { bench.system.add<PointOnCurve>("wire", bench.p(), bench.s(), path, near), bench.begin(); });
  };
  const auto rail = [](const LawPtr<TranslationLaw>& path, const LawPtr<RotationLaw>& turn) {
    LinkBench bench;
    return message_of<ModelError>([&] {
      bench.system.add<PathFollower>("rail", bench.p(), bench.s(), {path, turn}), bench.begin();
    });
  };
  CHECK(wire(helix(), 0) == "no error");
  CHECK(rail(helix(), turning()) == "no error");
  check_words(wire(laws::constant_translation(Vec3(1, 2, 3)), 0.5), {"joint 'wire'", "near s = 0.5", "\"near\""});
  check_words(wire(nullptr, 0), {"joint 'wire'", "no path was given"});
  check_words(rail(nullptr, turning()), {"joint 'rail'", "no path was given"});
  check_words(rail(helix(), nullptr), {"joint 'rail'", "no law for the axes"});
  // beyond the end of a spline that is not said to go on: the law itself says so
  const auto splined = laws::path({{0, Vec3(1, 0, 0)}, {1, Vec3(2, 0, 0)}, {2, Vec3(3, 1, 0)}});
  check_words(wire(splined, 0.5), {"joint 'wire'", "path"});
}

}  // namespace curve_test
