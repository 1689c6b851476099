// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/detail/newton.h>

#include <algorithm>
#include <array>

#include "framework/dynamics/evaluate/newton_factor.h"
#include "framework/dynamics/evaluate/slot_coordinates.h"
#include "framework/dynamics/solvers/scales.h"
#include "framework/mechanism/rows/loads.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

struct NewtonMatrix::Work : NewtonNumbers {
  const System* system = nullptr;
  long description = -1, pattern = -1;  // revisions of the system and tangents that are laid out
  NewtonFactor<double> real;
  NewtonFactor<Complex> complex;

  bool same_links(const RowTable& rows) const {
    return std::equal(entries.begin(), entries.end(), rows.entries.begin(), rows.entries.end(),
                      [](const RowEntry& a, const RowEntry& b) { return a.link == b.link && a.m == b.m; });
  }

  void lay_out(const RowTable& rows) {
    width.clear(), first.clear(), mass.clear();
    n = 0;
    const Plane plane = system->plane();
    velocity = unknown_velocities(plane);
    for (int k = 0; k < system->n_slots(); ++k) {
      mass.emplace_back(system->slot(k), plane);
      width.push_back(mass.back().width());
      first.push_back(n);
      n += width.back();
    }
    entries = rows.entries;
    m = rows.n_rows;
    std::size_t size = 0;
    for (const RowEntry& e : entries) size += static_cast<std::size_t>(6 * e.m * e.slots.n);
    J.assign(size, 0.0);
    s.setZero(m);
    pattern = -1;
  }

  // Once the pairs of the tangents are known: the order of elimination and the place of every number.
  void lay_out_plan() {
    pattern = tangents.revision();
    BlockGraph graph{width, first, static_cast<int>(width.size()), {}};
    for (const auto& [row, column] : tangents.pairs())
      if (row < column) graph.edges.emplace_back(row, column);
    for (const RowEntry& e : entries) {
      const int node = static_cast<int>(graph.width.size());
      graph.width.push_back(e.m);
      graph.first.push_back(n + e.first_row);
      for (int i = 0; i < e.slots.n; ++i) graph.edges.emplace_back(e.slots[i], node);
    }
    plan.lay_out(graph, false);

    pairs.clear(), row_places.clear(), proximal.clear();
    for (const auto& [row, column] : tangents.pairs()) pairs.push_back(plan.find(row, column));
    int node = graph.n_slots;
    for (const RowEntry& e : entries) {
      for (int i = 0; i < e.slots.n; ++i) row_places.push_back(plan.find_above(node, e.slots[i]));
      proximal.push_back(plan.find(node, node));
      ++node;
    }
    real.lay_out(*this);
    complex.lay_out(*this);
  }

  void copy_rows(const RowTable& rows) {
    double* out = J.data();
    for_each_jacobian(rows, [&](int, int, const auto& r) { out = std::copy_n(r.data(), 6, out); });
  }

  // (9.16) d(w x J w)/dw = w~ J - (J w)~
  void add_inertia(const Inputs& in) {
    for (int k = 0; k < system->n_slots(); ++k) {
      const Mat3& moment = mass[k].J();
      const Vec3& w = in.slot(k).w;
      tangents.add_D(k, Half::turn, k, Half::turn, skew(w) * moment - skew(Vec3(moment * w)));
    }
  }

  void update_scales() {
    s.setZero();
    for_each_row(J, [&](int row, int slot, const double* r) {
      const Eigen::Map<const Vec3> v(r), w(r + 3);
      s[row] += v.squaredNorm() / mass[slot].m() + w.dot(mass[slot].inverse_J() * w);
    });
    for (const RowEntry& e : entries) average_scales(s.data() + e.first_row, e.m, KindBits(e.kind, e.m));
  }

  /// Throw ModelError for a vector of another size.
  void check_slots(Eigen::Index size) const {
    check_size("NewtonMatrix: a vector of the bodies", size, 6 * std::ssize(mass));
  }

  void add_times(const Mat6& (TangentSum::*block)(std::size_t) const, const VecX& x, VecX& y) const {
    check_slots(x.size()), check_slots(y.size());
    for (std::size_t p = 0; p < tangents.pairs().size(); ++p)
      y.segment<6>(6 * tangents.pairs()[p].row) += (tangents.*block)(p)*x.segment<6>(6 * tangents.pairs()[p].column);
  }

  void check_rows(Eigen::Index size) const { check_size("NewtonMatrix: a vector of the constraints", size, m); }
};

NewtonMatrix::NewtonMatrix() : work_(std::make_unique<Work>()) {}
NewtonMatrix::~NewtonMatrix() = default;

void NewtonMatrix::gather(const Evaluation& e, const VecX& lambda) {
  Work& w = *work_;
  const System& system = e.system();
  const RowTable& rows = e.rows();
  check_size("NewtonMatrix: lambda", lambda.size(), rows.n_rows);
  if (w.system != &system || w.description != system.revision() || !w.same_links(rows)) {
    w.system = &system;
    w.description = system.revision();
    w.tangents.lay_out(system.n_slots()), w.length = system.length();
    w.lay_out(rows);
  }
  w.copy_rows(rows);
  w.update_scales();
  w.tangents.clear();
  const Inputs& in = e.inputs();
  w.add_inertia(in);
  for (const RowEntry& entry : rows.entries) {
    std::array<double, kMaxRows> own{};  // all rows of the link; zero for those that a plane leaves out
    for (int k = 0; k < entry.m; ++k) own[entry.own[k]] = lambda[entry.first_row + k];
    const Lock& link = *system.links()[entry.link];
    named(link, in.t, [&] {
      add_tangent(link, in, {own.data(), static_cast<std::size_t>(link.row_count())}, w.tangents);
    });
  }
  for (const auto& force : system.forces())
    if (force->acts(in)) named(*force, in.t, [&] { force->tangent(in, w.tangents); });
  const Reactions reactions(rows, {lambda.data(), static_cast<std::size_t>(lambda.size())});
  for (const Force* force : e.reacting())
    if (force->acts(in)) named(*force, in.t, [&] { force->reacting()->react_tangent(in, reactions, w.tangents); });
  if (w.pattern != w.tangents.revision()) w.lay_out_plan();
}

void NewtonMatrix::factor(double a, double b, double c) { work_->real.factor(*work_, a, b, c); }
void NewtonMatrix::factor(Complex a, Complex b, Complex c) { work_->complex.factor(*work_, a, b, c); }
void NewtonMatrix::set_residual(double enough) { work_->enough = enough; }
SolveReport NewtonMatrix::solve(const VecX& f, const VecX& r, VecX& x, VecX& l) {
  work_->check_slots(f.size()), work_->check_rows(r.size());
  return work_->real.solve(*work_, f, r, x, l);
}
SolveReport NewtonMatrix::solve(const VecXc& f, const VecXc& r, VecXc& x, VecXc& l) {
  work_->check_slots(f.size()), work_->check_rows(r.size());
  return work_->complex.solve(*work_, f, r, x, l);
}

void NewtonMatrix::add_M_times(const VecX& x, VecX& y) const {
  work_->check_slots(x.size()), work_->check_slots(y.size());
  for (std::size_t k = 0; k < work_->mass.size(); ++k)
    work_->mass[k].add_times(x.segment<6>(6 * k), y.segment<6>(6 * k));
}
void NewtonMatrix::add_D_times(const VecX& x, VecX& y) const { work_->add_times(&TangentSum::D, x, y); }
void NewtonMatrix::add_K_times(const VecX& x, VecX& y) const { work_->add_times(&TangentSum::K, x, y); }
const TangentSum& NewtonMatrix::tangents() const { return work_->tangents; }

}  // namespace lockstep
