// SPDX-License-Identifier: BSD-3-Clause
// Oracles for scalar laws: the formula on jets, and a search for jumps that knows nothing of the law.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <lockstep/author/jet.h>
#include <lockstep/author/law.h>
#include "tests/support/catch.h"

namespace lockstep::test {

/// Value and derivatives of a law against its formula, evaluated on jets, at n instants of [t0, t1]; relative to
/// the largest of each, or to `least` where that is more.
template <class F>
void check_formula(const MotionLaw& law, F f, double t0, double t1, double tolerance = 1e-13, int n = 101,
                   double least = 0) {
  LawValue size{least, least, least};
  for (int i = 0; i < n; ++i) {
    const Time y = f(Time(t0 + (t1 - t0) * i / (n - 1), 1.0, 0.0));
    size = {std::max(size.y, std::abs(y.v)), std::max(size.yd, std::abs(y.d)), std::max(size.ydd, std::abs(y.h))};
  }
  for (int i = 0; i < n; ++i) {
    const double t = t0 + (t1 - t0) * i / (n - 1);
    const Time y = f(Time(t, 1.0, 0.0));
    const LawValue v = law.at(t);
    INFO("t = " << t);
    CHECK(std::abs(v.y - y.v) <= tolerance * size.y);
    CHECK(std::abs(v.yd - y.d) <= tolerance * size.yd);
    CHECK(std::abs(v.ydd - y.h) <= tolerance * size.ydd);
  }
}

/// The message contains these words, with Catch2 of either version.
inline auto says(const std::string& words) {
#if __has_include(<catch2/catch_all.hpp>)
  return Catch::Matchers::ContainsSubstring(words);
#else
  return Catch::Matchers::Contains(words);
#endif
}

inline std::vector<double> breakpoints_of(const MotionLaw& law, double t0, double t1) {
  std::vector<double> b;
  law.breakpoints(t0, t1, b);
  std::sort(b.begin(), b.end());
  return b;
}

inline double change(const LawValue& a, const LawValue& b, const LawValue& size) {
  return std::max({std::abs(a.y - b.y) / size.y, std::abs(a.yd - b.yd) / size.yd, std::abs(a.ydd - b.ydd) / size.ydd});
}

/// The change of (y, yd, ydd) that remains when [t0, t1] is halved to nothing, always into the half that changes more.
inline double remaining_change(const MotionLaw& law, double t0, double t1, const LawValue& size) {
  for (int k = 0; k < 25; ++k) {
    const double m = 0.5 * (t0 + t1);
    const LawValue mid = law.at(m);
    (change(law.at(t0), mid, size) > change(mid, law.at(t1), size) ? t1 : t0) = m;
  }
  return change(law.at(t0), law.at(t1), size);
}

/// Every listed instant is a jump of y, yd or ydd, or the beginning or end of a rest; the law is continuous from the
/// right there, and there is no other jump.
inline void check_breakpoints(const MotionLaw& law, double t0, double t1, const std::vector<double>& expected) {
  const std::vector<double> listed = breakpoints_of(law, t0, t1);
  REQUIRE(listed.size() == expected.size());
  const double e = 1e-9 * (t1 - t0);
  LawValue size{1e-9, 1e-9, 1e-9};
  for (int i = 0; i <= 200; ++i) {
    const LawValue v = law.at(t0 + (t1 - t0) * i / 200.0);
    size = {std::max(size.y, std::abs(v.y)), std::max(size.yd, std::abs(v.yd)), std::max(size.ydd, std::abs(v.ydd))};
  }
  for (std::size_t i = 0; i < listed.size(); ++i) {
    INFO("breakpoint " << listed[i]);
    CHECK(listed[i] == Approx(expected[i]).margin(1e-12));
    const LawValue before = law.at(listed[i] - e), after = law.at(listed[i] + e);
    const auto rests = [](const LawValue& v) { return v.yd == 0 && v.ydd == 0; };
    CHECK((change(before, after, size) > 1e-6 || rests(before) || rests(after)));
    CHECK(change(law.at(listed[i]), law.at(listed[i] + e), size) < 1e-6);
  }
  std::vector<double> edges{t0};
  edges.insert(edges.end(), listed.begin(), listed.end());
  edges.push_back(t1);
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const double from = edges[i] + e, h = (edges[i + 1] - e - from) / 64;
    for (int k = 0; k < 64; ++k) {
      INFO("between " << from + k * h << " and " << from + (k + 1) * h);
      CHECK(remaining_change(law, from + k * h, from + (k + 1) * h, size) < 1e-6);
    }
  }
}

}  // namespace lockstep::test
