// The rule by which rows of closures are eliminated and corrected along a tree: one mechanism or several in lanes
// (framework/docs/solvers.md, section 9).
#pragma once

namespace lockstep {

inline constexpr double kStalledRows = 0.3;  ///< of a residual: a correction that leaves more is the last one

}  // namespace lockstep
