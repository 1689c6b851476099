#include "framework/dynamics/tree/closure_cost.h"

#include <fmt/format.h>

#include <algorithm>

#include "framework/dynamics/tree/closure_fronts.h"
#include "framework/dynamics/tree/joint_tree.h"

namespace lockstep {

namespace {

constexpr double kLeastShare = 0.5;  // of all rows, held by the tree
constexpr double kMostSquares = 15;  // of the numbers of rows at a node, for each row of all
constexpr int kOthers = 2;           // joints that leave no rows, for each that does

// Rows of all links in force, as omega has them; where a tree was found none are left out.
int count_rows_of(const System& system, const std::vector<bool>& modes) {
  if (system.plane()) {  // of a link those in the plane
    RowTable all;
    system.lay_out(modes, all);
    return all.n_rows;
  }
  int n = 0;
  for (const auto& link : system.links())
    if (modes[static_cast<std::size_t>(link->number())] && !system.merged(*link)) n += link->row_count();
  return n;
}

}  // namespace

double squares_of(const ClosureFronts& fronts) {
  double squares = 0;
  for (const ClosureFront& front : fronts.all) squares += double(front.n) * front.n;
  return squares;
}

std::string why_dearer(const JointTree& tree, const ClosureFronts& fronts, const System& system,
                       const std::vector<bool>& modes) {
  for (const auto& own : system.auxiliaries())
    if (tree.may_be_redundant() && own->reads_solution() && !own->vanishes_without_laws())
      return "the states of '" + own->name() +
             "' read accelerations or reactions, which omega gives at every evaluation";
  const int n_rows = count_rows_of(system, modes);
  const auto n_closing = static_cast<int>(fronts.sources.size());
  if (n_rows - n_closing < kLeastShare * n_rows)
    return fmt::format("the rows of what closes loops, {} of {}, cost more along joints than in omega", n_closing,
                       n_rows);
  const auto joints = [&](bool leaving) {
    return std::ranges::count_if(tree.nodes(),
                                 [&](const TreeNode& n) { return n.link >= 0 && (n.left != 0) == leaving; });
  };
  const auto leaving = joints(true), others = joints(false);
  if (others < kOthers * leaving)
    return fmt::format("joints that leave rows, {} beside {} others, cost more along joints than in omega", leaving,
                       others);
  if (const double squares = squares_of(fronts); squares > kMostSquares * n_rows)
    return fmt::format("many loops pass through one body: {:.0f} products of rows along joints for {} rows in omega",
                       squares, n_rows);
  return "";
}

}  // namespace lockstep
