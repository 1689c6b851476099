// Whether the closures of a tree cost less along it than the rows of all links do in omega: a rule on counts.
#pragma once

#include <string>
#include <vector>

namespace lockstep {

struct ClosureFronts;
class JointTree;
class System;

/// The squares of the numbers of rows that are open or end at a node, summed over the nodes and the ground's links.
double squares_of(const ClosureFronts&);

/// What makes joint coordinates the dearer ones, with these links in force; "" where they are not. They are where
///
///     the links of the tree hold less than half of all rows,
///     squares_of() is more than 15 for each row of all,
///     more than half as many joints leave rows (of one turn alone, of functions) as leave none, or
///     rows may be redundant and integrated states read accelerations or reactions, which omega gives at every evaluation.
///
/// Found by measuring fifty mechanisms (framework/docs/solvers.md, section 9).
std::string why_dearer(const JointTree&, const ClosureFronts&, const System&, const std::vector<bool>& modes);

}  // namespace lockstep
