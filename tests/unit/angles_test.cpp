// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/params.h>

#include <random>

#include <lockstep/error.h>
#include "tests/support/messages.h"

namespace angles_test {

using namespace lockstep;
using lockstep::testing::check_words;
using lockstep::testing::message_of;

namespace {

const char* const kSequences[] = {"xyz", "yzx", "zxy", "xzy", "zyx", "yxz", "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"};

// The oracle: matrices of the three elementary turns, written out, multiplied in the order of the letters.
Mat3 turn(char axis, double a) {
  const double c = std::cos(a), s = std::sin(a);
  Mat3 A;
  if (axis == 'x') A << 1, 0, 0, 0, c, -s, 0, s, c;
  if (axis == 'y') A << c, 0, s, 0, 1, 0, -s, 0, c;
  if (axis == 'z') A << c, -s, 0, s, c, 0, 0, 0, 1;
  return A;
}

Mat3 turns(const std::string& s, const Vec3& a) { return turn(s[0], a[0]) * turn(s[1], a[1]) * turn(s[2], a[2]); }

double distance(const Mat3& A, const Mat3& B) { return (A - B).cwiseAbs().maxCoeff(); }

bool distinct(const std::string& s) { return s[0] != s[2]; }

}  // namespace

TEST_CASE("angles make the product of three elementary rotations", "[unit][model]") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> angle(-7, 7);
  for (const std::string s : kSequences)
    for (int k = 0; k < 20; ++k) {
      const Vec3 a(angle(random), angle(random), angle(random));
      INFO(s << " " << a.transpose());
      CHECK(distance(rotation(from_angles(s, a)), turns(s, a)) < 1e-14);
    }
}

TEST_CASE("angles come back, in their ranges, for all twelve sequences", "[unit][model]") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> outer(-kPi, kPi), inner(0.01, kPi - 0.01);
  for (const std::string s : kSequences)
    for (int k = 0; k < 50; ++k) {
      const Vec3 a(outer(random), inner(random) - (distinct(s) ? kPi / 2 : 0), outer(random));
      const Quat q = from_angles(s, a);
      INFO(s << " " << a.transpose());
      const Angles there = to_angles(s, q), other = to_angles(s, -q);
      CHECK_FALSE(there.gimbal);
      CHECK((there.value - a).cwiseAbs().maxCoeff() < 1e-12);
      CHECK((other.value - a).cwiseAbs().maxCoeff() < 1e-12);
    }
}

TEST_CASE("in the gimbal pose the third angle is zero and the orientation stays", "[unit][model]") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> outer(-3, 3);
  for (const std::string s : kSequences)
    for (const double side : {0.0, 1.0}) {
      const double middle = distinct(s) ? (side - 0.5) * kPi : side * kPi;
      const Vec3 a(outer(random), middle, outer(random));
      const Mat3 A = turns(s, a);
      INFO(s << " " << a.transpose());
      const Angles there = to_angles(s, from_angles(s, a));
      CHECK(there.gimbal);
      CHECK(there.value[2] == 0);
      CHECK(distance(turns(s, there.value), A) < 1e-14);
    }
}

TEST_CASE("the gimbal pose is flagged within 1e-7 rad and not beyond", "[unit][model]") {
  for (const std::string s : kSequences) {
    const double middle = distinct(s) ? kPi / 2 : 0;
    const double inward = distinct(s) ? -1 : 1;
    INFO(s);
    CHECK(to_angles(s, from_angles(s, {0.4, middle + inward * 5e-8, 0.3})).gimbal);
    const Vec3 near(0.4, middle + inward * 3e-7, 0.3);
    const Angles there = to_angles(s, from_angles(s, near));
    CHECK_FALSE(there.gimbal);
    CHECK(distance(turns(s, there.value), turns(s, near)) < 1e-14);
    CHECK(std::abs(there.value[1] - near[1]) < 1e-14);
  }
}

TEST_CASE("named sequences", "[unit][model]") {
  CHECK(angle_sequence("cardan") == "xyz");
  CHECK(angle_sequence("euler") == "zxz");
  CHECK(angle_sequence("hpb") == "zxy");
  CHECK(angle_sequence("yzx") == "yzx");
  const Vec3 a(0.3, -0.4, 0.5);
  CHECK(distance(rotation(from_angles("hpb", a)), turns("zxy", a)) < 1e-15);
}

TEST_CASE("an invalid sequence is rejected by name", "[unit][model]") {
  for (const char* bad : {"", "xy", "xxy", "xyy", "abc", "xyzx", "XYZ"}) {
    INFO(bad);
    check_words(message_of<ModelError>([&] { from_angles(bad, Vec3::Zero()); }), {"three letters"});
    check_words(message_of<ModelError>([&] { to_angles(bad, Quat{}); }),
                {"\"" + std::string(bad) + "\"", "three letters"});
  }
}

}  // namespace angles_test
