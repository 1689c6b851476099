// Jumps of a function of time, found without knowing anything of it.
#pragma once

#include <functional>
#include <vector>

#include <lockstep/math.h>
#include <lockstep/export.h>

namespace lockstep {

/// Component `component` changes by `size` at the instant t (known to some 1e-9 of the time looked at).
struct Jump {
  double t = 0;
  int component = 0;
  double size = 0;
};

/// Jumps of f inside (t0, t1), more than 1e-9 of the time away from the instants `known`. Every one of `cells` cells
/// is halved, always into the half in which f departs most from the mean of its ends: what does not vanish is a jump.
/// Found are jumps of more than 1e-6 of the component's size (at least 1e-10 of the largest component's); of several in
/// one cell, the largest.
LOCKSTEP_API std::vector<Jump> find_jumps(const std::function<void(double t, VecX& out)>& f, double t0, double t1,
                                          std::vector<double> known, int cells = 400);

}  // namespace lockstep
