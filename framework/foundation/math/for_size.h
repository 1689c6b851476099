// SPDX-License-Identifier: BSD-3-Clause
// for_size: turns a run-time size 1 .. 8 into a compile-time constant, so that loops over it are unrolled;
// unrolled: a loop whose index is a constant.
#pragma once

#include <type_traits>
#include <utility>

namespace lockstep {

/// Calls f(std::integral_constant<int, n>{}); n must be in kFirst .. kLast, a range within 1 .. 8. f returns void.
template <int kFirst = 1, int kLast = 8, class F>
[[gnu::always_inline]] inline void for_size(int n, F&& f) {
  static_assert(1 <= kFirst && kFirst <= kLast && kLast <= 8);
  const auto call = [&]<int k>() __attribute__((always_inline)) {
    if constexpr (k < kFirst || k > kLast)
      __builtin_unreachable();
    else
      f(std::integral_constant<int, k>{});
  };
  switch (n) {
    case 1:
      return call.template operator()<1>();
    case 2:
      return call.template operator()<2>();
    case 3:
      return call.template operator()<3>();
    case 4:
      return call.template operator()<4>();
    case 5:
      return call.template operator()<5>();
    case 6:
      return call.template operator()<6>();
    case 7:
      return call.template operator()<7>();
    default:
      return call.template operator()<8>();
  }
}

/// f(i) for i = 0 ... n - 1, each of them a constant: what a loop's arrays hold stays in registers.
template <int n, class F>
[[gnu::always_inline]] inline void unrolled(F&& f) {
  [&]<int... i>(std::integer_sequence<int, i...>) __attribute__((always_inline)) {
    (f(std::integral_constant<int, i>{}), ...);
  }
  (std::make_integer_sequence<int, n>{});
}

}  // namespace lockstep
