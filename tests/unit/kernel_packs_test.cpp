// SPDX-License-Identifier: BSD-3-Clause
// The equations of the lock on packs: every lane gives what a double gives. And in a plane: with components that are
// absent they give what they give with zeros.

#include <array>
#include <cmath>
#include <type_traits>
#include <vector>

#include <lockstep/author/jet.h>
#include <lockstep/detail/kernel.h>
#include "tests/support/catch.h"
#include "tests/support/lock_inputs.h"
#include "tests/support/worst.h"

namespace kernel_packs_test {

using namespace lockstep;
using lockstep::inputs::KernelInputs;

namespace {

constexpr int kLanes = 8;
using Pack8 = Pack<kLanes>;
using Lanes = std::array<double, kLanes>;

/// A number of each of eight configurations, as a pack, or that of one of them.
struct AsPack {
  const std::vector<KernelInputs>& in;
  template <class F>
  auto operator()(F f) const {
    Pack8 p{};
    for (int l = 0; l < kLanes; ++l) p[l] = f(in[l]);
    return p;
  }
};
struct AsDouble {
  const std::vector<KernelInputs>& in;
  int lane;
  template <class F>
  double operator()(F f) const {
    return f(in[lane]);
  }
};

template <class Of, class F>
auto vector(const Of& of, F f) {
  const auto k = [&](int i) { return of([&](const KernelInputs& in) { return f(in)[i]; }); };
  return vec::Vector{k(0), k(1), k(2)};
}
template <class Of, class F>
auto matrix(const Of& of, F f) {
  const auto row = [&](int i) { return vector(of, [&](const KernelInputs& in) { return Vec3(f(in).row(i)); }); };
  return vec::Matrix{row(0), row(1), row(2)};
}
template <class Of, class F>
auto quaternion(const Of& of, F f) {
  return vec::Quaternion{of([&](const KernelInputs& in) { return f(in).w; }),
                         vector(of, [&](const KernelInputs& in) { return f(in).vec(); })};
}
template <class Of, class F>
auto body(const Of& of, F O) {
  using K = KernelInputs;
  return kernel::Body{
      vector(of, [=](const K& in) { return O(in).x; }), matrix(of, [=](const K& in) { return O(in).A; }),
      quaternion(of, [=](const K& in) { return O(in).e; }), vector(of, [=](const K& in) { return O(in).v; }),
      vector(of, [=](const K& in) { return O(in).w; })};
}
template <class Of, class F>
auto still_marker(const Of& of, F m) {
  using K = KernelInputs;
  return kernel::Marker{vector(of, [=](const K& in) { return m(in).u; }),
                        matrix(of, [=](const K& in) { return m(in).A; }),
                        quaternion(of, [=](const K& in) { return m(in).q; })};
}
template <class Of, class F>
auto moving_marker(const Of& of, F m) {
  using K = KernelInputs;
  return kernel::Marker{
      vector(of, [=](const K& in) { return m(in).u; }),     matrix(of, [=](const K& in) { return m(in).A; }),
      quaternion(of, [=](const K& in) { return m(in).q; }), vector(of, [=](const K& in) { return m(in).ud; }),
      vector(of, [=](const K& in) { return m(in).udd; }),   vector(of, [=](const K& in) { return m(in).w; }),
      vector(of, [=](const K& in) { return m(in).a; })};
}
template <class Of>
auto shift(const Of& of) {
  using K = KernelInputs;
  return kernel::Shift{vector(of, [](const K& in) { return in.p.p; }), vector(of, [](const K& in) { return in.p.pd; }),
                       vector(of, [](const K& in) { return in.p.pdd; })};
}
template <class Of>
auto turn(const Of& of) {
  using K = KernelInputs;
  return kernel::Turn{quaternion(of, [](const K& in) { return in.D.q; }),
                      matrix(of, [](const K& in) { return in.D.A; }), vector(of, [](const K& in) { return in.D.w; }),
                      vector(of, [](const K& in) { return in.D.a; })};
}

/// What is known from its type counts as the number that it is.
struct Numbers {
  std::vector<Lanes> all;
  void put(vec::Zero) { all.push_back({}); }
  void put(vec::One) {
    Lanes one;
    one.fill(1);
    all.push_back(one);
  }
  void put(double a) {
    Lanes same;
    same.fill(a);
    all.push_back(same);
  }
  void put(const Pack8& a) {
    Lanes lanes;
    for (int l = 0; l < kLanes; ++l) lanes[l] = a[l];
    all.push_back(lanes);
  }
  template <class X, class Y, class Z>
  void put(const vec::Vector<X, Y, Z>& a) {
    put(a.x), put(a.y), put(a.z);
  }
  template <class W, class V>
  void put(const vec::Quaternion<W, V>& a) {
    put(a.w), put(a.v);
  }
  template <class V, class W1, class W2>
  void put(const kernel::Row<V, W1, W2>& a) {
    put(a.v), put(a.w1), put(a.w2);
  }
};

/// Everything that the equations give: both halves with their rates and all seven rows.
template <class B1, class B2, class P, class S, class D, class T>
Numbers all_of(const B1& O1, const B2& O2, const P& p, const S& s, const D& d, const T& t) {
  Numbers out;
  const auto at = kernel::position(O1, O2, p, s);
  const auto moving = kernel::velocity(O1, O2, p, at);
  out.put(at.rho - d.p), out.put(kernel::position_rate(s, at, moving));
  out.put(kernel::translation_Ct(O1, O2, p, s, d, at)), out.put(kernel::translation_Qhat(O1, O2, p, s, d, at, moving));
  const auto translation_row = [&](auto axis) {
    const auto n2 = s.A * axis;
    out.put(kernel::translation_row(O1.A, p.u, at.s, O2.A * n2, n2));
  };
  translation_row(vec::Unit<0>{}), translation_row(vec::Unit<1>{}), translation_row(vec::Unit<2>{});

  const auto e = kernel::rotation_error(O1, O2, p, s, t);
  const auto w = kernel::angular_velocities(O1, O2, p, s, t);
  const auto ed = kernel::rotation_rate(e, w);
  out.put(e), out.put(ed), out.put(kernel::rotation_Ct(e, p, s, t)), out.put(kernel::rotation_Qhat(e, ed, w));
  const auto h = 0.5 * e;
  const auto A_SD = s.A * t.A;
  out.put(kernel::rotation_row(h, p.A, A_SD, vec::Quaternion{vec::One{}, vec::None{}}));
  const auto rotation_row = [&](auto axis) {
    out.put(kernel::rotation_row(h, p.A, A_SD, vec::Quaternion{vec::Zero{}, axis}));
  };
  rotation_row(vec::Unit<0>{}), rotation_row(vec::Unit<1>{}), rotation_row(vec::Unit<2>{});
  return out;
}

/// 0: markers that move, imposed laws; 1: markers at rest, imposed laws; 2: no law; 3: parallel axes as well.
template <int kLaws, class Of>
Numbers all_of(const Of& of) {
  using K = KernelInputs;
  const auto O1 = body(of, [](const K&in) { return in.O1; }), O2 = body(of, [](const K&in) { return in.O2; });
  const auto P = [](const K& in) { return in.P; };
  const auto S = [](const K& in) { return in.S; };
  if constexpr (kLaws == 0) return all_of(O1, O2, moving_marker(of, P), moving_marker(of, S), shift(of), turn(of));
  if constexpr (kLaws == 1) return all_of(O1, O2, still_marker(of, P), still_marker(of, S), shift(of), turn(of));
  if constexpr (kLaws == 2)
    return all_of(O1, O2, still_marker(of, P), still_marker(of, S), kernel::NoShift{}, kernel::NoTurn{});
  if constexpr (kLaws == 3) {
    const auto parallel = [&](auto m) {
      return kernel::Marker{vector(of, [=](const K& in) { return m(in).u; }), vec::Identity{}, vec::NoTurn{}};
    };
    return all_of(O1, O2, parallel(P), parallel(S), kernel::NoShift{}, kernel::NoTurn{});
  }
}

std::vector<KernelInputs> eight(unsigned laws, bool parallel) {
  std::vector<KernelInputs> in;
  for (std::uint64_t seed = 1; seed <= kLanes; ++seed)
    in.emplace_back(oracle::random_configuration(700 + seed, {laws, parallel}));
  return in;
}

template <int kLaws>
void check_lanes(unsigned laws, bool parallel = false) {
  CAPTURE(kLaws);
  const std::vector<KernelInputs> in = eight(laws, parallel);
  const Numbers packs = all_of<kLaws>(AsPack{in});
  for (int lane = 0; lane < kLanes; ++lane) {
    CAPTURE(lane);
    const Numbers one = all_of<kLaws>(AsDouble{in, lane});
    REQUIRE(one.all.size() == packs.all.size());
    double worst = 0;
    for (std::size_t i = 0; i < one.all.size(); ++i) {
      const double a = packs.all[i][lane], b = one.all[i][0];
      keep_worst(worst, std::abs(a - b) / std::max(1.0, std::abs(b)));
      CHECK(std::isfinite(a));
    }
    CHECK(worst <= 2e-15);
  }
}

// A motion of the x-y plane on numbers (z zero) and with z absent.
constexpr double kC = 0.8, kS = 0.6;  // a turn
template <class Z, class O>
auto flat_body(double x, double y, double c, double s, double half_c, double half_s, double v, double w, Z z, O one) {
  return kernel::Body{
      vec::Vector{x, y, z}, vec::Matrix{vec::Vector{c, -s, z}, vec::Vector{s, c, z}, vec::Vector{z, z, one}},
      vec::Quaternion{half_c, vec::Vector{z, z, half_s}}, vec::Vector{v, -0.3 * v, z}, vec::Vector{z, z, w}};
}
template <class Z, class O>
Numbers in_plane(Z z, O one) {
  const double c = std::sqrt(0.5 * (1 + kC)), s = 0.5 * kS / c;  // of half the turn
  const auto O1 = flat_body(0.3, -0.7, kC, kS, c, s, 1.3, 2.1, z, one);
  const auto O2 =
      flat_body(-0.2, 0.4, kS, kC, std::sqrt(0.5 * (1 + kS)), 0.5 * kC / std::sqrt(0.5 * (1 + kS)), -0.9, 0.7, z, one);
  const auto marker = [&](double x, double y, double c1, double s1) {
    return kernel::Marker{vec::Vector{x, y, z},
                          vec::Matrix{vec::Vector{kC, -kS, z}, vec::Vector{kS, kC, z}, vec::Vector{z, z, one}},
                          vec::Quaternion{c1, vec::Vector{z, z, s1}}};
  };
  const kernel::Turn D{vec::Quaternion{c, vec::Vector{z, z, s}},
                       vec::Matrix{vec::Vector{kC, -kS, z}, vec::Vector{kS, kC, z}, vec::Vector{z, z, one}},
                       vec::Vector{z, z, 1.7}, vec::Vector{z, z, -0.4}};
  const kernel::Shift p{vec::Vector{0.1, 0.2, z}, vec::Vector{-0.3, 0.5, z}, vec::Vector{0.7, -1.1, z}};
  return all_of(O1, O2, marker(0.4, 0.2, c, s), marker(-0.6, 0.1, c, s), p, D);
}

}  // namespace

TEST_CASE("every element of the vectorised kernel gives the result of a double", "[unit][lock]") {
  check_lanes<0>(oracle::kAllLaws);
  check_lanes<1>(oracle::kAllLaws);
  check_lanes<2>(0);
  check_lanes<3>(0, true);
}

TEST_CASE("components that are absent are zeros", "[unit][lock]") {
  const Numbers zeros = in_plane(0.0, 1.0), absent = in_plane(vec::Zero{}, vec::One{});
  REQUIRE(zeros.all.size() == absent.all.size());
  for (std::size_t i = 0; i < zeros.all.size(); ++i) {
    CAPTURE(i);
    CHECK(std::abs(zeros.all[i][0] - absent.all[i][0]) <= 1e-15);
  }
  // and they are absent in the results: what lies in the plane has no third component
  const auto a = vec::Vector{1.0, 2.0, vec::Zero{}};
  static_assert(std::is_same_v<decltype(cross(a, a)), vec::Vector<vec::Zero, vec::Zero, double>>);
  static_assert(std::is_same_v<decltype(vec::Identity{} * a), std::remove_const_t<decltype(a)>>);
}

}  // namespace kernel_packs_test
