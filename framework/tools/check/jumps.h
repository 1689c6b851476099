// Jumps of a function of time about which nothing is known.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include <lockstep/detail/export.h>
#include <lockstep/math.h>

namespace lockstep {

/// A component changes by `size` at the instant t, which is known to about 1e-9 of the interval.
struct Jump {
  double t = 0;
  double size = 0;
};

/// Jumps of each component of f inside (t0, t1), in order of time, more than 1e-9 of the interval away from the
/// instants `known`. Each of `cells` cells is bisected, always into the half in which f departs most from the mean of
/// its ends: what does not vanish is a jump. Finds jumps of more than 1e-6 of the component's size (which counts as at
/// least 1e-10 of the largest component's); of several in one cell, the largest.
LOCKSTEP_API std::map<int, std::vector<Jump>> find_jumps(const std::function<void(double t, VecX& out)>& f, double t0,
                                                         double t1, std::vector<double> known, int cells = 400);

}  // namespace lockstep
