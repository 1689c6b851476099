#include "framework/dynamics/solvers/schur_passes.h"

#include "framework/foundation/support/clones.h"

namespace lockstep::schur {
namespace {

// Calls f with the number of rows, and whether the first of them are turned into the world's axes, as constants.
template <class X, class F>
[[gnu::always_inline]] inline void with_shape(int m, bool turned, F&& f) {
  if (turned) {
    switch (m) {
      case 2:
        if constexpr (X::nv == 2) f.template operator()<2, true>();
        break;
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
      case 7:
        f.template operator()<7, true>();
        break;
      default:
        f.template operator()<8, true>();
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

bool turned(const Node& node) { return n_turned(node.layout) > 0; }

// The mass of a hub, negative, and zero below it. mass: m, then J, nw x nw.
template <class X>
void fill_hub(const Node& node, const double* mass, const Numbers& z) {
  const int ld = node.ld();
  double* d = z.A + node.D;
  for (int i = 0; i < node.m * ld; ++i) d[i] = 0;
  for (int i = 0; i < X::nv; ++i) d[i * ld + i] = -mass[0];
  for (int i = 0; i < X::nw; ++i)
    for (int k = 0; k < X::nw; ++k) d[(X::nv + i) * ld + X::nv + k] = -mass[1 + X::nw * i + k];
  for (int i = 0; i < node.m; ++i) {
    z.diagonal[node.x + static_cast<std::size_t>(i)] = -d[i * ld + i];
    z.E[node.x + static_cast<std::size_t>(i)] = 0;
  }
}

// Row i of a link on one of its sides: v then w.
double jacobian(const Node& node, const Side& side, int i, int c, int nv, const Numbers& z) {
  const int ld = node.ld();
  const double* J = z.rows + side.J;
  if (!turned(node)) return J[c * ld + i];
  if (c < nv) return i == c ? side.sign : 0.0;
  return J[(c - nv) * ld + i];
}

template <class X>
void fill_hub_term(const Plan& plan, const Node& pivot, const Later& later, const Term& term, const Numbers& z) {
  double* block = z.A + later.block;
  const Node& other = plan.nodes[static_cast<std::size_t>(later.node)];
  const int lq = other.ld();
  for (int i = 0; i < pivot.m; ++i)
    for (int j = 0; j < other.m; ++j)
      block[i * lq + j] -= term.pivot_side < 0
                               ? jacobian(other, plan.sides[static_cast<std::size_t>(term.later_side)], j, i, X::nv, z)
                               : jacobian(pivot, plan.sides[static_cast<std::size_t>(term.pivot_side)], i, j, X::nv, z);
}

template <class X>
[[gnu::always_inline]] inline void fill_links(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes)
    if (node.link >= 0)
      with_shape<X>(
          node.m,
          turned(node), [&]<int M, bool T>() __attribute__((always_inline)) { fill_own<X, M, T>(plan, node, z); });
}

template <class X>
[[gnu::always_inline]] inline void fill_block(const Plan& plan, const Node& node, const Later& later,
                                              const Numbers& z) {
  const Node& other = plan.nodes[static_cast<std::size_t>(later.node)];
  double* block = z.A + later.block;
  std::memset(block, 0, sizeof(double) * static_cast<std::size_t>(pack_size(later.m) * node.m));
  for (int k = later.first_term; k < later.first_term + later.n_terms; ++k) {
    const Term& term = plan.terms[static_cast<std::size_t>(k)];
    if (term.pivot_side < 0 || term.later_side < 0) {
      fill_hub_term<X>(plan, node, later, term, z);
      continue;
    }
    const Side &p = plan.sides[static_cast<std::size_t>(term.pivot_side)],
               &q = plan.sides[static_cast<std::size_t>(term.later_side)];
    const bool alike = node.m == later.m && turned(node) && turned(other);  // of one kind: the sizes are known
    if (alike && node.m == (X::nv == 3 ? 5 : 2))
      fill_term<X, X::nv == 3 ? 5 : 2>(p, q, z, block);
    else if (alike && node.m == 3)
      fill_term<X, 3>(p, q, z, block);
    else if (alike && X::nv == 3 && node.m == 6)
      fill_term<X, 6>(p, q, z, block);
    else
      fill_any_term<X>(node, p, turned(node), other, q, turned(other), z, block);
  }
}

template <class X>
[[gnu::always_inline]] inline void fill_blocks(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes)
    for (int s = 0; s < node.n_later; ++s)
      fill_block<X>(plan, node, plan.later[static_cast<std::size_t>(node.first_later + s)], z);
}

template <class X>
void fill_hubs(const Plan& plan, const Numbers& z) {
  for (const int h : plan.hubs) {
    const Node& node = plan.nodes[static_cast<std::size_t>(h)];
    fill_hub<X>(node, z.mass + 10 * node.hub_slot, z);
  }
}

template <class X>
[[gnu::always_inline]] inline void start_links(const Plan& plan, const double* c, const Numbers& z) {
  for (const Node& node : plan.nodes)
    if (node.link >= 0)
      with_shape<X>(
          node.m, turned(node), [&]<int M, bool T>() __attribute__((always_inline)) {
            start_link<X, M, T>(plan, node, c + node.first_row, z);
          });
}

template <class X>
[[gnu::always_inline]] inline void apply_links(const Plan& plan, const double* x, const Numbers& z) {
  for (const Node& node : plan.nodes) {
    if (node.link < 0) continue;
    with_shape<X>(
        node.m, turned(node), [&]<int M, bool T>() __attribute__((always_inline)) {
          apply_link<X, M, T>(plan, node, x + node.x, z);
        });
  }
}

template <class X>
[[gnu::always_inline]] inline void residuals(const Plan& plan, const Numbers& z) {
  for (const Node& node : plan.nodes)
    if (node.link >= 0)
      with_shape<X>(
          node.m,
          turned(node), [&]<int M, bool T>() __attribute__((always_inline)) { residual_link<X, M, T>(plan, node, z); });
}

LOCKSTEP_CLONES void fill_links_spatial(const Plan& plan, const Numbers& z) { fill_links<Spatial>(plan, z); }
LOCKSTEP_CLONES void fill_links_planar(const Plan& plan, const Numbers& z) { fill_links<Planar>(plan, z); }
LOCKSTEP_CLONES void fill_blocks_spatial(const Plan& plan, const Numbers& z) { fill_blocks<Spatial>(plan, z); }
LOCKSTEP_CLONES void fill_blocks_planar(const Plan& plan, const Numbers& z) { fill_blocks<Planar>(plan, z); }
LOCKSTEP_CLONES void start_spatial(const Plan& p, const double* c, const Numbers& z) { start_links<Spatial>(p, c, z); }
LOCKSTEP_CLONES void start_planar(const Plan& p, const double* c, const Numbers& z) { start_links<Planar>(p, c, z); }
LOCKSTEP_CLONES void apply_spatial(const Plan& p, const double* x, const Numbers& z) { apply_links<Spatial>(p, x, z); }
LOCKSTEP_CLONES void apply_planar(const Plan& p, const double* x, const Numbers& z) { apply_links<Planar>(p, x, z); }
LOCKSTEP_CLONES void residual_spatial(const Plan& plan, const Numbers& z) { residuals<Spatial>(plan, z); }
LOCKSTEP_CLONES void residual_planar(const Plan& plan, const Numbers& z) { residuals<Planar>(plan, z); }

}  // namespace

void fill(const Plan& plan, const Numbers& z) {
  if (plan.planar) {
    fill_links_planar(plan, z);
    fill_hubs<Planar>(plan, z);
    fill_blocks_planar(plan, z);
  } else {
    fill_links_spatial(plan, z);
    fill_hubs<Spatial>(plan, z);
    fill_blocks_spatial(plan, z);
  }
}

void start(const Plan& plan, const double* c, const Numbers& z) {
  plan.planar ? start_planar(plan, c, z) : start_spatial(plan, c, z);
}
void apply(const Plan& plan, const double* x, const Numbers& z) {
  plan.planar ? apply_planar(plan, x, z) : apply_spatial(plan, x, z);
}
void residual(const Plan& plan, const Numbers& z) {
  plan.planar ? residual_planar(plan, z) : residual_spatial(plan, z);
}

LOCKSTEP_CLONES bool within(const Plan& plan, double tolerance, const Numbers& z) {
  for (const Node& node : plan.nodes) {
    if (node.link < 0) continue;
    const int ld = node.ld();
    const bool good = ld == 8   ? within_link<8>(node, tolerance, z)
                      : ld == 4 ? within_link<4>(node, tolerance, z)
                                : within_link<2>(node, tolerance, z);
    if (!good) return false;
  }
  return true;
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

}  // namespace lockstep::schur
