// Turns that closures count (gears, belts), in steps that make many of them.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <lockstep/lock.h>
#include "framework/dynamics/tree/joint_tree.h"

namespace lockstep {

// Long steps outrun what closures remember from step to step, but for turns whose ways are known (miscounts): of hinges in
// the tree, and in a plane of any two bodies. Returns what is remembered besides, by name; "" for nothing.
std::string JointTree::follow_turns(const System& system) {
  const auto node_of_pair = [&](const auto& pair) {
    return std::ranges::find_if(nodes_, [&](const TreeNode& n) {
      return n.link >= 0 && system.links()[static_cast<std::size_t>(n.link)]->pairs().front() == pair;
    });
  };
  std::vector<int> with_rows = closures_;
  for (const TreeNode& n : nodes_)
    if (n.left != 0) with_rows.push_back(n.link);
  for (const int number : with_rows) {
    const Lock& link = *system.links()[static_cast<std::size_t>(number)];
    if (link.remembering() == nullptr) continue;
    const std::string who = "link '" + link.name() + "' ";
    if (!link.remembering()->counts_turns_alone())
      return who + "keeps a memory from step to step (ways), which long steps outrun";
    for (const auto& pair : link.pairs()) {
      CountedTurn turn{number, {}};
      if (const auto node = node_of_pair(pair); node != nodes_.end() && !node->moving && !node->imposed) {
        if (node->turn == TreeTurn::none && includes(node->rows, Mask::e123)) continue;  // it slides
        if (node->turn == TreeTurn::hinge && are_parallel(node->hinge, Vec3(Vec3::UnitZ())))
          turn.parts.push_back({node->first_q + node->n_slides, node->first_v + node->n_slides, 1.0});
      } else if (planar_ && turns_about_normal(*pair.first) && turns_about_normal(*pair.second)) {
        for (const auto& [marker, sign] : {std::pair(pair.first, 1.0), std::pair(pair.second, -1.0)})
          if (std::string law = add_parts(system, marker->body->slot, sign, turn); !law.empty())
            return who + "counts turns that link '" + law + "' imposes by a law, which long steps outrun";
        if (turn.parts.empty()) continue;  // it does not turn
      }
      if (turn.parts.empty())
        return who + "counts turns of a pair that is no hinge about z of the tree, which long steps outrun";
      counted_.push_back(std::move(turn));
    }
  }
  return "";
}

// Whether z of a marker is the normal of the plane.
bool JointTree::turns_about_normal(const Marker& marker) const {
  const MarkerFrame frame(marker);
  Vec3 normal = Vec3::Unit(planar_->plane().n);
  if (frame.slot >= 0)
    if (const Posture* posture = planar_->posture(
            planar_->nodes()[static_cast<std::size_t>(node_of_[static_cast<std::size_t>(frame.slot)])]))
      normal = posture->normal;
  return are_parallel(Vec3(frame.A0.col(2)), normal);
}

// The angle of a slot in the plane: of all joints that carry it. Returns the name of a link among them with laws; "" for
// none.
std::string JointTree::add_parts(const System& system, int slot, double sign, CountedTurn& turn) const {
  for (int k = slot < 0 ? -1 : node_of_[static_cast<std::size_t>(slot)]; k >= 0;) {
    const TreeNode& n = nodes_[static_cast<std::size_t>(k)];
    const PlanarNode& flat = planar_->nodes()[static_cast<std::size_t>(k)];
    if (n.has_laws()) return system.links()[static_cast<std::size_t>(n.link)]->name();
    if (flat.turns) turn.parts.push_back({n.first_q + n.n_slides, n.first_v + n.n_slides, sign * flat.sign});
    k = n.parent;
  }
  return "";
}

// Inside the step the angle is that of Hermite's cubic.
int JointTree::miscounts(const State& from, const State& to, double most) const {
  const double h = to.t - from.t;
  for (const CountedTurn& turn : counted_) {
    double way = 0, v0 = 0, v1 = 0;
    for (const auto& [q, v, sign] : turn.parts)
      way += sign * (to.q[q] - from.q[q]), v0 += sign * from.v[v], v1 += sign * to.v[v];
    for (const double s : {0.25, 0.5, 0.75, 1.0}) {
      const double there = s * s * (3 - 2 * s) * way + h * s * (1 - s) * ((1 - s) * v0 - s * v1),
                   rate = 6 * s * (1 - s) * (h > 0 ? way / h : 0.0) + (1 - s) * (1 - 3 * s) * v0 + s * (3 * s - 2) * v1;
      if (!(std::abs(there - 0.5 * s * h * (v0 + rate)) <= most)) return turn.link;
    }
  }
  return -1;
}

}  // namespace lockstep
