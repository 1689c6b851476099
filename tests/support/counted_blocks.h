// SPDX-License-Identifier: BSD-3-Clause
#pragma once
/// @file What the block elimination and the recursion along joints do, counted: of the first one by one from its equations, of
/// the second by columns and numbers that count. A pack that one instruction takes counts as a number.

#include <array>
#include <vector>

#include "framework/dynamics/solvers/schur_plan.h"
#include "framework/dynamics/tree/recursion_in.h"
#include "tests/support/counted.h"

namespace lockstep::oracle {

/// A column of a block.
template <int n>
struct CountedPack {
  std::array<double, n> v{};
  double& operator[](int i) { return v[i]; }
  double operator[](int i) const { return v[i]; }
  CountedPack& operator+=(const CountedPack& b) { return ++Counted::done().add, each(b, 1, 1); }
  CountedPack& operator-=(const CountedPack& b) { return ++Counted::done().add, each(b, 1, -1); }
  CountedPack& operator*=(const Counted& x) { return ++Counted::done().mul, each({}, x.value(), 0); }
  CountedPack& operator*=(const CountedPack& b) {
    for (int i = 0; i < n; ++i) (*this)[i] *= b[i];
    return ++Counted::done().mul, *this;
  }
  friend CountedPack operator+(CountedPack a, const CountedPack& b) { return a += b; }
  friend CountedPack operator-(CountedPack a, const CountedPack& b) { return a -= b; }
  friend CountedPack operator*(CountedPack a, const Counted& x) { return a *= x; }
  friend CountedPack operator*(CountedPack a, double sign) { return a.each({}, sign, 0); }
  friend CountedPack operator-(CountedPack a) { return a * -1.0; }
  friend bool operator<(const CountedPack& a, double b) { return a[0] < b; }

 private:
  CountedPack& each(const CountedPack& b, double x, double y) {
    for (int i = 0; i < n; ++i) (*this)[i] = x * (*this)[i] + y * b[i];
    return *this;
  }
};

/// Multiply-adds of the factorisation of a plan, its solutions and residuals, one by one as the equations of elimination.h
/// have them: a column of a block counts as a number. Without hubs.
inline double elimination(const schur::Plan& plan) {
  const int nv = plan.planar ? 2 : 3, nw = plan.planar ? 1 : 3;
  double n = 0;
  const auto times = [&](int i, int j = 1) {  // so many columns, or numbers
    for (int k = 0; k < i * j; ++k) ++n;
  };
  for (int k = 0; k < plan.n_slots; ++k) {  // accelerations without rows: J w, w x J w, J^-1, 1/m
    times(nv);
    if (!plan.planar) times(nw, nw), times(2 * nw);
    times(nw, nw);
  }
  for (const schur::Node& node : plan.nodes) {
    const int m = node.m;
    for (const schur::Side& side : plan.sides_of(node)) {
      const int columns = side.turned ? nw : nv + nw;
      times(columns), times(nw, nw);  // J a of the start; Y = J M^-1
      if (!side.turned) times(nv);
      times(columns, m);                                                                     // J Y^T
      for (int solution = 0; solution < (plan.tree ? 1 : 2); ++solution) times(columns, m);  // Y^T x
      times(columns);                                                                        // J a - c
    }
    times(2);                              // of the rows: c of the start, its scale |J a| + |c|, and c of the residual
    for (int k = 0; k < m; ++k) times(m);  // T
    for (int solution = 0; solution < (plan.tree ? 1 : 2); ++solution) times(m), times(m);  // T^T p T x
    int s = 0;
    for (const schur::Later& later : plan.later_of(node)) {
      for (const schur::Term& term : plan.terms_of(later)) {
        const schur::Side &p = plan.sides[term.pivot_side], &q = plan.sides[term.later_side];
        const int columns = p.turned && q.turned ? nw : p.turned || q.turned ? nw + 1 : nv + nw;
        times(m * columns, p.turned && q.turned && later.m == m ? 1 : later.m);  // J_later Y^T
      }
      times(m, m);  // L_s
      const schur::Later* const first = plan.later_of(node).data();
      for (int t = 0; t <= s; ++t) times(m, first[t].m);  // A_st
      for (int solution = 0; solution < (plan.tree ? 1 : 2); ++solution) times(m), times(m, later.m);
      ++s;
    }
  }
  return n;
}

using CountedColumn = CountedPack<4>;
inline CountedColumn operator*(const Counted& x, const CountedColumn& a) { return a * x; }
inline Counted dot(const CountedColumn& a, const CountedColumn& b) {  // a product, and its numbers one after another
  ++Counted::done().mul, Counted::done().add += 3;
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline CountedColumn cross(const CountedColumn& a, const CountedColumn& b) {
  return a * Counted(b[0]) + a * Counted(b[1]) + a * Counted(b[2]);
}

/// InColumns, whose columns and numbers count.
struct CountedSpace {
  using Number = Counted;
  using Linear = CountedColumn;
  using Wrench = bodies::Wrench<CountedColumn>;
  using Twist = bodies::Twist<CountedColumn>;
  struct Inertia {
    std::array<CountedColumn, 3> M{}, H{}, H_t{}, I{};
    Wrench p;
    Wrench operator*(const Twist& s) const {
      Wrench out;
      for (int k = 0; k < 3; ++k) {
        const auto c = static_cast<std::size_t>(k);
        out.f += M[c] * Counted(s.a[k]), out.f += H[c] * Counted(s.al[k]);
        out.t += H_t[c] * Counted(s.a[k]), out.t += I[c] * Counted(s.al[k]);
      }
      return out;
    }
    void subtract(const Wrench& V, const Wrench& U) {
      for (int k = 0; k < 3; ++k) {
        const auto c = static_cast<std::size_t>(k);
        M[c] -= V.f * Counted(U.f[k]), H[c] -= V.f * Counted(U.t[k]);
        H_t[c] -= V.t * Counted(U.f[k]), I[c] -= V.t * Counted(U.t[k]);
      }
    }
    void add(const Inertia&) {}
    void move(const CountedColumn&) {}
  };
};

/// The nodes of a tree in space, standing still; without what a node passes on itself.
struct CountedSlots {
  using Space = CountedSpace;
  using Twist = Space::Twist;
  struct Largest {
    void add(const Counted&, const Counted&) {}
  };
  explicit CountedSlots(const JointTree& t)
      : tree(t),
        places(inward_places(t.nodes(), n_waiting)),
        dofs(static_cast<std::size_t>(t.n_v())),
        all(t.nodes().size()) {}

  std::size_t size() const { return all.size(); }
  int parent(std::size_t k) const { return tree.nodes()[k].parent; }
  int first_v(std::size_t k) const { return tree.nodes()[k].first_v; }
  const InwardPlace& place(std::size_t k) const { return places[k]; }
  template <class F>
  void with_joint(std::size_t k, F&& f) {
    f(bodies::JointPasses<Space>{dofs.data() + first_v(k), tree.nodes()[k].n_v(), r, c});
  }
  const Twist& put(std::size_t k, const Twist& found) { return all[k] = found; }
  const Twist& found(std::size_t k) const { return all[k]; }

  const JointTree& tree;
  std::size_t n_waiting = 0;
  std::vector<InwardPlace> places;
  std::vector<bodies::Coordinate<Space>> dofs;
  std::vector<Twist> all;
  Space::Linear r{};
  Twist c{};
};

/// The recursion in space, with the elimination of the rows: what these take is the difference to one without.
inline Operations recursion(const JointTree& tree, const ClosureFronts& fronts) {
  using Space = CountedSlots::Space;
  CountedSlots slots(tree);
  std::vector<Space::Inertia> waiting(slots.n_waiting);
  std::vector<Space::Wrench> K(fronts.rows.size()), wrenches(fronts.n_nodes);
  std::vector<CountedSlots::Twist> changes(fronts.n_nodes);
  const auto numbers = [](std::size_t n) { return std::vector<Counted>(n + 1); };
  auto l = numbers(fronts.rows.size()), Lambda = numbers(static_cast<std::size_t>(fronts.n_Lambda)),
       V = numbers(static_cast<std::size_t>(fronts.n_V)), vd = numbers(slots.dofs.size());
  std::array<std::vector<Counted>, 5> by_row;
  for (auto& v : by_row) v = numbers(fronts.sources.size() + slots.dofs.size());
  OpenRows<Space> rows{fronts,           K.data(),         l.data(),         Lambda.data(),
                       V.data(),         by_row[0].data(), by_row[1].data(), by_row[2].data(),
                       by_row[3].data(), by_row[4].data(), wrenches.data(),  changes.data()};
  return operations_of([&] {
    inward(slots, rows, waiting, [](std::size_t, Space::Inertia&) {});
    outward(slots, rows, vd.data());
  });
}

}  // namespace lockstep::oracle
