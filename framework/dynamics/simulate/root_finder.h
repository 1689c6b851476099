// Finds where a quantity falls to zero inside a step. Internal to the step loop.
#pragma once

#include <boost/math/tools/toms748_solve.hpp>
#include <cstdint>

namespace lockstep {

/// For g > 0 at a and g <= 0 at b: the far end of a bracket no longer than `tolerance`, or an instant with
/// 0 >= g >= -enough. There g <= 0, so the same root is not found again at once. By TOMS 748 (Alefeld, Potra & Shi, ACM
/// Trans. Math. Softw. 21 (1995) 327), which needs some 8 evaluations where a guarded false position needs 30; each may
/// cost a step.
template <class G>
double falling_root(double a, double ga, double b, double gb, double tolerance, double enough, const G& g) {
  if (!(ga > 0)) return a;
  double below = gb;  // g at the far end
  const auto value = [&](double t) {
    const double now = g(t);
    if (!(now > 0)) below = now;
    return now;
  };
  const auto close = [&](double left, double right) { return right - left <= tolerance || below >= -enough; };
  std::uintmax_t most = 200;
  return close(a, b) ? b : boost::math::tools::toms748_solve(value, a, b, ga, gb, close, most).second;
}

}  // namespace lockstep
