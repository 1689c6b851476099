// SPDX-License-Identifier: BSD-3-Clause
// All passes for one instruction set: included once by lane_avx512.cpp, lane_fma.cpp and lane_plain.cpp, which define
// LOCKSTEP_SET, LOCKSTEP_WIDE and, except for those that every machine has, LOCKSTEP_INSTRUCTIONS. Private to the room.
//
// Numbers are packs of LOCKSTEP_WIDE lanes, one value per copy, as many as a register holds. Everything is always
// inlined, so that it is compiled for the instruction set of the calling pass. In memory there are always eight lanes
// side by side; narrower packs make several rounds.
#pragma once

#include "framework/foundation/math/sin_cos.h"
#include "framework/tools/batch/lane_closures.h"
#include "framework/tools/batch/lane_passes.h"

#if defined(LOCKSTEP_INSTRUCTIONS) && defined(__x86_64__)
#define LOCKSTEP_TARGET __attribute__((target(LOCKSTEP_INSTRUCTIONS)))
#else
#define LOCKSTEP_TARGET
#endif

namespace lockstep::lanes::LOCKSTEP_SET {

inline constexpr int kWide = LOCKSTEP_WIDE;  ///< lanes in one register
using V = Pack<kWide>;                       ///< of the eight that are stored side by side

/// An array of eight lanes: [i] is its pack i, + i what begins there.
struct LaneArray {
  double* p = nullptr;
  LOCKSTEP_LANE LaneArray() = default;
  LOCKSTEP_LANE LaneArray(const double* numbers) : p(const_cast<double*>(numbers)) {}
  LOCKSTEP_LANE explicit operator bool() const { return p != nullptr; }
  template <class I>
  LOCKSTEP_LANE V& operator[](I i) const {
    return *reinterpret_cast<V*>(p + kLanes * static_cast<std::ptrdiff_t>(i));
  }
  template <class I>
  LOCKSTEP_LANE LaneArray operator+(I n) const {
    return {p + kLanes * static_cast<std::ptrdiff_t>(n)};
  }
};

LOCKSTEP_LANE void combine(std::size_t n, const double* y, const double* h, std::size_t n_k, const double* const* k,
                           const double* w, double* out, int lane) {
  const V step = LaneArray(h + lane)[0];
  const LaneArray from = y ? y + lane : nullptr, to = out + lane;
  for (std::size_t i = 0; i < n; ++i) {
    V sum{};
    for (std::size_t j = 0; j < n_k; ++j) sum += w[j] * LaneArray(k[j] + lane)[i];
    to[i] = from ? from[i] + step * sum : step * sum;
  }
}

/// Of all eight lanes.
LOCKSTEP_LANE void half_turns(const LaneData& d, double* half) {
  for (std::size_t k = 0; k < d.plan.nodes.size(); ++k) {
    const LaneNode& n = d.plan.nodes[k];
    if (n.turn != TreeTurn::hinge) continue;
    const double* q = d.z.y.data() + kL * (n.q + static_cast<std::size_t>(n.n_slides));
    for (std::size_t l = 0; l < kL; ++l) half[kL * k + l] = 0.5 * q[l];
  }
  sin_cos(half, kL * d.plan.nodes.size(), d.z.sine.data(), d.z.cosine.data());
}

LOCKSTEP_LANE auto at_lane(int lane) {
  return [lane](std::span<double> p) __attribute__((always_inline))->LaneArray {
    return p.empty() ? nullptr : p.data() + lane;
  };
}
/// Structs of packs, of the round that begins at this lane.
template <class S>
LOCKSTEP_LANE S* round_at(int lane, std::span<double> p) {
  return reinterpret_cast<S*>(p.data() + p.size() / kL * static_cast<std::size_t>(lane));
}
template <class G>
LOCKSTEP_LANE LaneTree<G> tree(const LaneData& d, int lane) {
  using Space = typename G::Space;
  using Inertia = typename Space::Inertia;
  using Coordinate = bodies::Coordinate<Space>;
  static_assert(sizeof(Coordinate) <= struct_size::coordinate * sizeof(V) &&
                sizeof(Travel<Space>) <= struct_size::travel * sizeof(V) &&
                sizeof(Inertia) <= struct_size::inertia * sizeof(V));
  return {d.plan,
          {d.z.each(at_lane(lane)), round_at<Travel<Space>>(lane, d.z.travel), round_at<Coordinate>(lane, d.z.dof),
           round_at<Inertia>(lane, d.z.waiting)}};
}
template <class G>
LOCKSTEP_LANE LaneClosures<G> closed(const LaneData& d, int lane) {
  using Wrench = typename G::Space::Wrench;
  using Twist = typename G::Space::Twist;
  static_assert(sizeof(Wrench) <= struct_size::wrench * sizeof(V) && sizeof(Twist) == sizeof(Wrench));
  return {tree<G>(d, lane),
          d.loops,
          {d.c.each(at_lane(lane)), round_at<Wrench>(lane, d.c.K), round_at<Wrench>(lane, d.c.wrench),
           round_at<Twist>(lane, d.c.change)}};
}
/// f(G), Spatial or Planar, as that of the plan.
template <class F>
LOCKSTEP_LANE void in_its_space(const LaneData& d, F&& f) {
  d.plan.normal < 0 ? f(Spatial<LaneArray>{}) : f(Planar<LaneArray>{});
}

// A pass over all eight lanes, in as many rounds as the packs need.
#define LOCKSTEP_PASS(name, parameters, act)                \
  all.name = [] parameters LOCKSTEP_TARGET {                \
    for (int lane = 0; lane < kLanes; lane += kWide) (act); \
  };

#define LOCKSTEP_TREE_PASS(name, parameters, act) \
  LOCKSTEP_PASS(name, parameters,                 \
                in_its_space(                     \
                    d, [&](auto g) __attribute__((always_inline)) { tree<decltype(g)>(d, lane).act; }))
#define LOCKSTEP_CLOSED_PASS(name, parameters, act) \
  LOCKSTEP_PASS(name, parameters,                   \
                in_its_space(                       \
                    d, [&](auto g) __attribute__((always_inline)) { closed<decltype(g)>(d, lane).act; }))

Passes all_passes() {
  Passes all;
  LOCKSTEP_PASS(combine,
                (std::size_t n, const double* y, const double* h, std::size_t n_k, const double* const* k,
                 const double* w, double* out),
                combine(n, y, h, n_k, k, w, out, lane))
  all.half_turns = [](const LaneData& d, double* half) LOCKSTEP_TARGET { half_turns(d, half); };
  LOCKSTEP_TREE_PASS(outward, (const LaneData& d), outward())
  LOCKSTEP_TREE_PASS(accelerate_tree, (const LaneData& d, double* rate), accelerate(rate + lane))
  LOCKSTEP_TREE_PASS(change, (const LaneData& d, const double* before, const double* h, double* now, double* out),
                     change(before + lane, h + lane, now + lane, out + lane))
  LOCKSTEP_TREE_PASS(vary, (const LaneData& d, const double* dy, double* out), vary(dy + lane, out + lane))
  LOCKSTEP_CLOSED_PASS(accelerate_closed, (const LaneData& d, double* rate), accelerate(rate + lane))
  LOCKSTEP_CLOSED_PASS(factor_closures, (const LaneData& d), factor())
  LOCKSTEP_CLOSED_PASS(correct_closures, (const LaneData& d, const double* r, double* dv), correct(r + lane, dv + lane))
  LOCKSTEP_CLOSED_PASS(add_correction, (const LaneData& d, const double* dv, double* rate),
                       add_correction(dv + lane, rate + lane))
  LOCKSTEP_CLOSED_PASS(closure_errors, (const LaneData& d), errors())
  LOCKSTEP_CLOSED_PASS(closure_rates, (const LaneData& d), rates())
  LOCKSTEP_CLOSED_PASS(closure_residuals, (const LaneData& d, bool raised, double* out), residuals(raised, out + lane))
  return all;
}

}  // namespace lockstep::lanes::LOCKSTEP_SET
