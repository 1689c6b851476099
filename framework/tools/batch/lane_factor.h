// S + E -> L, D, and its solutions, over all nodes. Private to the room.
#pragma once

#include "framework/tools/batch/lane_shapes.h"

namespace lockstep::lanes::LOCKSTEP_SET {

template <bool kSolve>
LOCKSTEP_LANE void eliminate_all(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes)
    with_size(
        node, [&]<int M>() __attribute__((always_inline)) { below<M>(plan, node, z); });
  for (const Node& node : plan.nodes)
    with_size(
        node, [&]<int M>() __attribute__((always_inline)) { eliminate<M, kSolve>(plan, node, z); });
}
LOCKSTEP_LANE void all_backward(const Plan& plan, const Numbers& z) {
  for (std::size_t k = plan.nodes.size(); k-- > 0;)
    with_size(
        plan.nodes[k], [&]<int M>() __attribute__((always_inline)) { backward<M>(plan, plan.nodes[k], z); });
}

LOCKSTEP_LANE void factor_and_solve(const Plan& plan, const Numbers& z) {
  eliminate_all<true>(plan, z);
  all_backward(plan, z);
}
LOCKSTEP_LANE void solve(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes)
    with_size(
        node, [&]<int M>() __attribute__((always_inline)) { forward<M>(plan, node, z); });
  all_backward(plan, z);
}

LOCKSTEP_LANE void apply(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes)
    with_shape(
        node, [&]<int M, bool T>() __attribute__((always_inline)) { apply_node<M, T>(plan, node, z); });
}

}  // namespace lockstep::lanes::LOCKSTEP_SET
