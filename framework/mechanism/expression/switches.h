// Where the comparisons of a formula switch.
#pragma once

#include <vector>

#include "framework/mechanism/expression/function.h"

namespace lockstep::expression {

/// Whether it decides by the sign of a number: a comparison, a choice, |a|, min, floor, ...
bool switches(const Term&);

/// Writes the numbers of the terms that a term is made of; how many they are.
int parts_of(const Term&, int (&parts)[3]);

/// Appends the instants in (t0, t1), in any order, from which on the decisions within term `root` are others than just
/// before. `time`: the variable that is the time; the term reads no other.
void find_switches(const std::vector<Term>&, int root, int time, double t0, double t1, std::vector<double>& out);

}  // namespace lockstep::expression
