// SPDX-License-Identifier: BSD-3-Clause
// Cams: the distance of a roller and of a flat face, held against a search along the profile; turn after turn; what
// profiles are refused.
#include <lockstep/couplings.h>

#include <lockstep/author/check.h>
#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/laws.h>
#include <lockstep/splines.h>
#include "framework/description/scene/json.h"
#include "framework/mechanism/links/cam_functions.h"
#include "tests/support/catch.h"
#include "tests/support/link_bench.h"
#include "tests/support/messages.h"
#include "tests/support/worst.h"

namespace cam_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::least, lockstep::testing::LinkBench,
    lockstep::testing::message_of;

namespace {

using Vec2 = CamProfile::Vec2;

/// Convex, and not symmetric.
LawPtr<MotionLaw> egg() {
  return laws::law([](auto u) { return 0.3 + 0.04 * cos(u) + 0.015 * sin(2.0 * u); });
}
/// With hollows of 0.67 m radius.
LawPtr<MotionLaw> lobes() {
  return laws::law([](auto u) { return 0.3 + 0.04 * cos(3.0 * u); });
}
Vec2 point(const LawPtr<MotionLaw>& radius, double u) {
  u -= kTwoPi * std::floor(u / kTwoPi);
  return radius->at(u).y * Vec2(std::cos(u), std::sin(u));
}

Pose at_angle(double psi, double r) { return {Vec3(r * std::cos(psi), r * std::sin(psi), 0.2), Quat{}}; }
/// A face whose normal has the angle alpha, through a point at the height h above the axis and `aside` along it.
Pose face(double alpha, double h, double aside) {
  const Vec3 n(std::cos(alpha), std::sin(alpha), 0), t(-n[1], n[0], 0);
  return {h * n + aside * t + Vec3(0, 0, 0.1), axis_angle(Vec3(0, 0, 1), alpha - kPi / 2)};
}

template <class L, class... More>
L& add(LinkBench& bench, More&&... more) {
  return bench.system.add<L>("cam", bench.p(), bench.s(), std::forward<More>(more)...);
}

}  // namespace

TEST_CASE("A roller's constraint is its distance from the profile", "[unit][links]") {
  for (const auto& radius : {egg(), lobes()})
    for (int i = 0; i < 40; ++i) {
      const double psi = -7 + 0.41 * i, r = 0.36 + 0.005 * i;
      const Pose start = at_angle(psi, r);
      LinkBench bench(start);
      add<CamRoller>(bench, radius, 0.1);
      bench.begin();
      bench.put(start);
      const Vec2 p(start.x[0], start.x[1]);
      const double distance = least([&](double u) { return (point(radius, u) - p).norm(); }, 0, kTwoPi).second;
      CAPTURE(psi, r, distance);
      CHECK(std::abs(bench.C() - (distance - 0.1)) <= 1e-14);
    }
}

TEST_CASE("A roller that goes round stays on its side of the profile", "[unit][links]") {
  LinkBench bench(at_angle(0, 0.45));
  add<CamRoller>(bench, lobes(), 0.05);
  bench.begin();
  double worst = 0;
  for (int i = 1; i <= 200; ++i) {  // 16 turns, 0.5 rad a step, and back
    const double psi = i <= 150 ? 0.5 * i : 75 - 0.7 * (i - 150), r = 0.45 + 0.06 * std::sin(1.3 * i);
    bench.put(at_angle(psi, r), 0.01);
    const Vec2 p(r * std::cos(psi), r * std::sin(psi));
    const double distance = least([&](double u) { return (point(lobes(), u) - p).norm(); }, 0, kTwoPi).second;
    keep_worst(worst, std::abs(bench.C() - (distance - 0.05)));
    bench.accept();
  }
  CHECK(worst <= 1e-13);
}

TEST_CASE("A flat face's constraint is its distance from the foremost point of the profile", "[unit][links]") {
  for (int i = 0; i < 40; ++i) {
    const double alpha = -7 + 0.41 * i, h = 0.2 + 0.005 * i;
    const Pose start = face(alpha, h, 0.1 * std::sin(3.0 * i));
    LinkBench bench(start);
    add<CamFlat>(bench, egg());
    bench.begin();
    bench.put(start);
    const Vec2 n(std::cos(alpha), std::sin(alpha));
    const double support = -least([&](double u) { return -point(egg(), u).dot(n); }, 0, kTwoPi).second;
    CAPTURE(alpha, h, support);
    CHECK(std::abs(bench.C() - (h - support)) <= 1e-14);
  }
  LinkBench bench(face(0, 0.4, 0));
  add<CamFlat>(bench, egg());
  bench.begin();
  double worst = 0;
  for (int i = 1; i <= 150; ++i) {
    const double alpha = 0.6 * i;
    bench.put(face(alpha, 0.33, 0.02 * i), 0.01);
    const Vec2 n(std::cos(alpha), std::sin(alpha));
    const double below = least([&](double u) { return -point(egg(), u).dot(n); }, 0, kTwoPi).second;
    keep_worst(worst, std::abs(bench.C() - 0.33 - below));
    bench.accept();
  }
  CHECK(worst <= 1e-13);
}

// A circle of radius R whose centre is e off the axis reaches R + e cos(alpha) far.
TEST_CASE("A flat face on an eccentric circle has a closed form, however far off its centre is", "[unit][links]") {
  constexpr double R = 0.3;
  for (const double e : {0.1, 0.2, 0.28}) {
    const auto radius = laws::law([e](auto u) {
      const auto s = e * sin(u);
      return e * cos(u) + sqrt(R * R - s * s);
    });
    for (int i = 0; i < 40; ++i) {
      const double alpha = -7 + 0.37 * i;
      LinkBench bench(face(alpha, 0.7, 0.1));
      add<CamFlat>(bench, radius);
      bench.begin();
      bench.put(face(alpha, 0.7, 0.1));
      CAPTURE(e, alpha);
      CHECK(std::abs(bench.C() - (0.7 - R - e * std::cos(alpha))) <= 1e-14);
    }
  }
}

TEST_CASE("Cams pass the check of joints, with splines for profiles as well", "[unit][links]") {
  SplinePoints points;
  for (int i = 0; i <= 12; ++i) points.emplace_back(kTwoPi * i / 12, 0.3 + 0.03 * std::cos(kTwoPi * (i % 12) / 12));
  const auto quintic = laws::spline(points, {.degree = 5, .ends = SplineEnds::periodic});
  for (const auto& radius : {egg(), lobes(), quintic})
    for (const bool flat : {false, true}) {
      for (int i = 0; i < 4; ++i) {
        LinkBench bench(flat ? face(1.5 * i, 0.35, 0.1) : at_angle(1.5 * i, 0.5));
        if (flat && message_of<ModelError>([&] { CamProfile(radius).check("x", HUGE_VAL); }) != "no error") continue;
        Lock& link = flat ? static_cast<Lock&>(add<CamFlat>(bench, radius))
                          : static_cast<Lock&>(add<CamRoller>(bench, radius, 0.08));
        const CheckReport report =
            check_lock(bench.system, link, {.seed = std::uint64_t(i + 1), .reach = 0.05, .turn = 0.3});
        INFO(report.text());
        CHECK(report.ok());
        CHECK(link.row_kind(0) == RowKind::translation);
        CHECK(link.row_name(0) == "contact");
      }
    }
}

TEST_CASE("An impossible profile is rejected in words", "[unit][links]") {
  const auto roller = [](const LawPtr<MotionLaw>& radius, double size) {
    LinkBench bench(at_angle(0, 1.0));
    return message_of<ModelError>([&] { add<CamRoller>(bench, radius, size), bench.begin(); });
  };
  const auto flat = [](const LawPtr<MotionLaw>& radius) {
    LinkBench bench(face(0, 1.0, 0));
    return message_of<ModelError>([&] { add<CamFlat>(bench, radius), bench.begin(); });
  };
  CHECK(roller(lobes(), 0.05) == "no error");
  CHECK(flat(egg()) == "no error");
  check_words(roller(laws::law([](auto u) { return 0.3 + 0.01 * u; }), 0.05),
              {"joint 'cam'", "does not close", "0.3 m", "0.36", "repeat after 2 pi"});
  check_words(roller(laws::law([](auto u) { return 0.3 + 0.1 * sin(0.5 * u); }), 0.05),
              {"joint 'cam'", "does not close", "slope", "m/rad"});
  check_words(roller(laws::law([](auto u) { return 0.3 + 0.4 * cos(u); }), 0.05),
              {"joint 'cam'", "the radius of its cam is", "deg", "above zero"});
  check_words(roller(lobes(), 3.0), {"joint 'cam'", "curvature", "1/m at", "a roller of 3 m does not fit", "hollow"});
  check_words(flat(lobes()), {"joint 'cam'", "curvature", "flat face", "convex", "use cam_roller"});
  check_words(roller(nullptr, 0.05), {"joint 'cam'", "no law for its radius"});
  check_words(flat(nullptr), {"joint 'cam'", "no law for its radius"});
  check_words(roller(egg(), -0.1), {"joint 'cam'", "roller is -0.1 m", "must not be negative"});
  check_words(roller(egg(), std::nan("")), {"joint 'cam'", "roller", "negative"});
}

}  // namespace cam_test
