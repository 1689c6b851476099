#include "framework/kkt/schur_passes.h"

#include "framework/support/clones.h"

namespace lockstep::schur {
namespace {

// Calls f with the number of rows and the layout as constants.
template <class F>
[[gnu::always_inline]] inline void with_shape(int m, bool triple, F&& f) {
  if (triple) {
    switch (m) {
      case 3:
        f.template operator()<3, true>();
        break;
      case 4:
        f.template operator()<4, true>();
        break;
      case 5:
        f.template operator()<5, true>();
        break;
      case 6:
        f.template operator()<6, true>();
        break;
      default:
        f.template operator()<7, true>();
    }
    return;
  }
  switch (m) {
    case 1:
      f.template operator()<1, false>();
      break;
    case 2:
      f.template operator()<2, false>();
      break;
    case 3:
      f.template operator()<3, false>();
      break;
    case 4:
      f.template operator()<4, false>();
      break;
    case 5:
      f.template operator()<5, false>();
      break;
    case 6:
      f.template operator()<6, false>();
      break;
    case 7:
      f.template operator()<7, false>();
      break;
    default:
      f.template operator()<8, false>();
  }
}

// The mass of a hub, negative, and zero below it.
void fill_hub(const Node& node, const double* mass, const Numbers& z) {
  double* d = z.A + node.D;
  for (int i = 0; i < 6 * node.ld(); ++i) d[i] = 0;
  for (int i = 0; i < 3; ++i) d[i * 8 + i] = -mass[0];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) d[(3 + i) * 8 + 3 + k] = -mass[1 + 3 * i + k];
  for (int i = 0; i < 6; ++i) {
    z.diagonal[node.x + static_cast<std::size_t>(i)] = -d[i * 8 + i];
    z.E[node.x + static_cast<std::size_t>(i)] = 0;
  }
}

// Row i of a link on one of its sides: v then w.
double jacobian(const Node& node, const Side& side, int i, int c, const Numbers& z) {
  const int ld = node.ld();
  const double* J = z.rows + side.J;
  if (node.layout == RowLayout::dense) return J[c * ld + i];
  if (c < 3) return i == c ? side.sign : 0.0;
  return J[(c - 3) * ld + i];
}

void fill_hub_term(const Plan& plan, const Node& pivot, const Later& later, const Term& term, const Numbers& z) {
  double* block = z.A + later.block;
  const Node& other = plan.nodes[static_cast<std::size_t>(later.node)];
  const int lq = other.ld();
  for (int i = 0; i < pivot.m; ++i)
    for (int j = 0; j < other.m; ++j)
      block[i * lq + j] -= term.pivot_side < 0
                               ? jacobian(other, plan.sides[static_cast<std::size_t>(term.later_side)], j, i, z)
                               : jacobian(pivot, plan.sides[static_cast<std::size_t>(term.pivot_side)], i, j, z);
}

}  // namespace

LOCKSTEP_CLONES void fill_links(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes)
    if (node.link >= 0)
      with_shape(
          node.m, node.layout == RowLayout::triple, [&]<int M, bool T>() __attribute__((always_inline)) {
            fill_own<M, T>(plan, node, z);
          });
}

LOCKSTEP_CLONES void fill_blocks(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes) {
    const bool triple = node.layout == RowLayout::triple;
    for (int s = 0; s < node.n_later; ++s) {
      const Later& later = plan.later[static_cast<std::size_t>(node.first_later + s)];
      const Node& other = plan.nodes[static_cast<std::size_t>(later.node)];
      const bool later_triple = other.layout == RowLayout::triple;
      double* block = z.A + later.block;
      std::memset(block, 0, sizeof(double) * static_cast<std::size_t>(pack_size(later.m) * node.m));
      for (int k = later.first_term; k < later.first_term + later.n_terms; ++k) {
        const Term& term = plan.terms[static_cast<std::size_t>(k)];
        if (term.pivot_side < 0 || term.later_side < 0) {
          fill_hub_term(plan, node, later, term, z);
          continue;
        }
        const Side &p = plan.sides[static_cast<std::size_t>(term.pivot_side)],
                   &q = plan.sides[static_cast<std::size_t>(term.later_side)];
        if (node.m == 5 && later.m == 5 && triple && later_triple) {  // two revolutes
          fill_term<5, true, 5, true>(p, q, z, block);
          continue;
        }
        with_shape(
            node.m, triple, [&]<int M, bool T>() __attribute__((always_inline)) {
              if (later_triple) {
                if (later.m <= 4)
                  fill_term<M, T, 4, true>(p, q, z, block);
                else
                  fill_term<M, T, 8, true>(p, q, z, block);
              } else if (later.m <= 2) {
                fill_term<M, T, 2, false>(p, q, z, block);
              } else if (later.m <= 4) {
                fill_term<M, T, 4, false>(p, q, z, block);
              } else {
                fill_term<M, T, 8, false>(p, q, z, block);
              }
            });
      }
    }
  }
}

void fill(const Plan& plan, const Numbers& z) {
  fill_links(plan, z);
  for (const int h : plan.hubs) {
    const Node& node = plan.nodes[static_cast<std::size_t>(h)];
    fill_hub(node, z.mass + 10 * node.hub_slot, z);
  }
  fill_blocks(plan, z);
}

LOCKSTEP_CLONES void factor(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes) {
    switch (node.m) {
      case 1:
        eliminate<1>(plan, node, z);
        break;
      case 2:
        eliminate<2>(plan, node, z);
        break;
      case 3:
        eliminate<3>(plan, node, z);
        break;
      case 4:
        eliminate<4>(plan, node, z);
        break;
      case 5:
        eliminate<5>(plan, node, z);
        break;
      case 6:
        eliminate<6>(plan, node, z);
        break;
      case 7:
        eliminate<7>(plan, node, z);
        break;
      default:
        eliminate<8>(plan, node, z);
    }
  }
}

LOCKSTEP_CLONES void solve(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes) {
    switch (node.m) {
      case 1:
        forward<1>(plan, node, z);
        break;
      case 2:
        forward<2>(plan, node, z);
        break;
      case 3:
        forward<3>(plan, node, z);
        break;
      case 4:
        forward<4>(plan, node, z);
        break;
      case 5:
        forward<5>(plan, node, z);
        break;
      case 6:
        forward<6>(plan, node, z);
        break;
      case 7:
        forward<7>(plan, node, z);
        break;
      default:
        forward<8>(plan, node, z);
    }
  }
  for (std::size_t k = plan.nodes.size(); k-- > 0;) {
    const Node& node = plan.nodes[k];
    switch (node.m) {
      case 1:
        backward<1>(plan, node, z);
        break;
      case 2:
        backward<2>(plan, node, z);
        break;
      case 3:
        backward<3>(plan, node, z);
        break;
      case 4:
        backward<4>(plan, node, z);
        break;
      case 5:
        backward<5>(plan, node, z);
        break;
      case 6:
        backward<6>(plan, node, z);
        break;
      case 7:
        backward<7>(plan, node, z);
        break;
      default:
        backward<8>(plan, node, z);
    }
  }
}

LOCKSTEP_CLONES void start(const Plan& plan, const double* c, const Numbers& z) {
  for (const Node& node : plan.nodes)
    if (node.link >= 0)
      with_shape(
          node.m, node.layout == RowLayout::triple, [&]<int M, bool T>() __attribute__((always_inline)) {
            start_link<M, T>(plan, node, c + node.first_row, z);
          });
}

LOCKSTEP_CLONES void apply(const Plan& plan, const double* x, const Numbers& z) {
  for (const Node& node : plan.nodes) {
    if (node.link < 0) continue;
    with_shape(
        node.m, node.layout == RowLayout::triple, [&]<int M, bool T>() __attribute__((always_inline)) {
          apply_link<M, T>(plan, node, x + node.x, z);
        });
  }
  for (const int h : plan.hubs) {
    const Node& node = plan.nodes[static_cast<std::size_t>(h)];
    for (int i = 0; i < 6; ++i) z.a[6 * node.hub_slot + i] += x[node.x + static_cast<std::size_t>(i)];
  }
}

LOCKSTEP_CLONES void residual(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes)
    if (node.link >= 0)
      with_shape(
          node.m, node.layout == RowLayout::triple, [&]<int M, bool T>() __attribute__((always_inline)) {
            residual_link<M, T>(plan, node, z);
          });
}

}  // namespace lockstep::schur
