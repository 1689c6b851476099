// SPDX-License-Identifier: BSD-3-Clause
// Functions of std on jets: one error for all of them, in each of the three places where authors write formulas (-DPLACE),
// which names lockstep's functions. Without -DPLACE: what compiles, as it does on numbers.
#include <algorithm>
#include <cmath>

#include <lockstep/author/formula.h>
#include <lockstep/author/phi_links.h>
#include <lockstep/function_laws.h>

namespace lockstep {

#ifdef PLACE
template <class T>
T of_std(const T& a, const T& b) {
  return std::sin(a) + std::cos(a) * std::tan(a) - std::exp(a) / std::log(a) + std::pow(a, 2) + std::pow(a, 0.5) +
         std::pow(a, b) + std::pow(2.0, a) + std::sinh(a) + std::cosh(a) + std::tanh(a) + std::abs(a) + std::fabs(a) +
         std::sqrt(a) + std::atan(a) + std::atan2(a, b) + std::asin(a) + std::acos(a) + std::hypot(a, b) +
         std::fmax(a, b) + std::fmin(a, 0.0) + std::floor(a) + (std::isfinite(a) ? 1.0 : 0.0);
}
#else
template <class T>
T of_std(const T& a, const T& b) {
  using std::sin, std::pow, std::max, std::min;
  enum { kTeeth = 20 };
  const long n = 3;
  const T c = a > 0 ? a : 0.0, d = a <= 1 ? 0 : 2 * a, e = std::max(a, b) - std::min(a, b);
  const bool all = 0.5 < a && b <= a && a >= b && 1 >= a && a == b && a != 0 && 2 > b;
  return (all ? 1 : 0) + sin(a) + pow(b, 2) + max(a, 0.0) - min(1, b) + kTeeth * c / 2 + n * d * 2.0F - e + max(a, b) -
         (1 - a) + 1 / b;
}
#endif

#if !defined(PLACE) || PLACE == 1
struct Phi {
  static constexpr PhiSpec spec{};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return of_std<T>(y.x, y.e3);
  }
};
template class PhiLock<Phi>;
#endif

#if !defined(PLACE) || PLACE == 2
const auto kLaw = laws::law([](auto t) { return of_std(t, t + 1); });
#endif

#if !defined(PLACE) || PLACE == 3
template Jet<6> of_std(const Jet<6>&, const Jet<6>&);
template Jet<6, double, NoMotion> of_std(const Jet<6, double, NoMotion>&, const Jet<6, double, NoMotion>&);
#endif

}  // namespace lockstep
