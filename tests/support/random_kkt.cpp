// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/random_kkt.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/dense.h"

namespace lockstep::test {

namespace {

/// visit(row, unknown, number) for all that a link touches.
template <class Numbers, class Visit>
void for_each_number_of_J(const KktPattern& pattern, Numbers& numbers, Visit visit) {
  for (const KktLink& link : pattern.links) {
    std::size_t at = link.J;
    for (int i = 0; i < link.n_slots; ++i) {
      const auto s = static_cast<std::size_t>(link.slot[i]);
      for (int j = 0; j < link.m; ++j)
        for (int k = 0; k < pattern.width[s]; ++k) visit(link.first_row + j, pattern.first[s] + k, numbers[at++]);
    }
  }
}

}  // namespace

MatX KktSystem::M() const {
  MatX out = MatX::Zero(kkt.pattern.n, kkt.pattern.n);
  for (std::size_t s = 0; s < kkt.pattern.width.size(); ++s)
    for (int i = 0; i < kkt.pattern.width[s]; ++i)
      for (int k = 0; k < kkt.pattern.width[s]; ++k)
        out(kkt.pattern.first[s] + i, kkt.pattern.first[s] + k) =
            kkt.M[kkt.pattern.M[s] + (i * kkt.pattern.width[s] + k)];
  return out;
}

MatX KktSystem::J() const {
  MatX out = MatX::Zero(kkt.pattern.m, kkt.pattern.n);
  for_each_number_of_J(kkt.pattern, kkt.J, [&](int j, int k, double v) { out(j, k) = v; });
  return out;
}

void KktSystem::write_J(const MatX& J) {
  for_each_number_of_J(kkt.pattern, kkt.J, [&](int j, int k, double& v) { v = J(j, k); });
}

RowKinds rows_of(int n_translation, int n_rotation, int n_function) {
  RowKinds kinds(static_cast<std::size_t>(n_translation), RowKind::translation);
  kinds.insert(kinds.end(), static_cast<std::size_t>(n_rotation), RowKind::rotation);
  kinds.insert(kinds.end(), static_cast<std::size_t>(n_function), RowKind::function);
  return kinds;
}

int KktBuilder::slot(int width) {
  KktPattern& p = out_.kkt.pattern;
  p.width.push_back(width);
  p.first.push_back(p.n);
  p.M.push_back(p.size_M);
  p.n += width;
  p.size_M += width * width;
  return static_cast<int>(p.width.size()) - 1;
}

std::size_t KktBuilder::link(const std::vector<int>& slots, const RowKinds& kinds) {
  KktPattern& p = out_.kkt.pattern;
  KktLink link;
  link.link = static_cast<int>(p.links.size());
  link.first_row = p.m;
  link.m = static_cast<int>(kinds.size());
  link.n_slots = static_cast<int>(slots.size());
  link.J = p.size_J;
  std::copy(slots.begin(), slots.end(), link.slot.begin());
  std::copy(kinds.begin(), kinds.end(), link.kind.begin());
  for (const int s : slots) p.size_J += static_cast<std::size_t>(link.m * p.width[s]);
  p.m += link.m;
  p.links.push_back(link);
  return p.links.size() - 1;
}

void KktBuilder::doubled(std::size_t original) {
  const KktLink first = out_.kkt.pattern.links[original];
  const std::vector<int> slots(first.slot.begin(), first.slot.begin() + first.n_slots);
  twins_.emplace_back(original, link(slots, RowKinds(first.kind.begin(), first.kind.begin() + first.m)));
}

MatX KktBuilder::numbers(int n_rows, int n_columns) {
  return MatX::NullaryExpr(n_rows, n_columns, [&] { return number(); });
}

void KktBuilder::fill_masses() {
  Kkt& kkt = out_.kkt;
  kkt.M.resize(kkt.pattern.size_M), kkt.Minv.resize(kkt.pattern.size_M);
  for (std::size_t s = 0; s < kkt.pattern.width.size(); ++s) {
    const int width = kkt.pattern.width[s];
    const MatX A = numbers(width, width);
    const MatX M = std::pow(10.0, 0.5 * number()) * (MatX::Identity(width, width) + A * A.transpose() / width);
    const MatX inverse = dense::inverse(M);
    for (int i = 0; i < width; ++i)
      for (int k = 0; k < width; ++k) {
        const std::size_t at = kkt.pattern.M[s] + static_cast<std::size_t>(i * width + k);
        kkt.M[at] = M(std::max(i, k), std::min(i, k));
        kkt.Minv[at] = inverse(std::max(i, k), std::min(i, k));
      }
  }
}

KktSystem KktBuilder::finish() {
  fill_masses();
  Kkt& kkt = out_.kkt;
  kkt.J.resize(kkt.pattern.size_J);
  for (double& v : kkt.J) v = number();
  MatX J = out_.J();
  for (const auto& [original, twin] : twins_) {
    const KktLink &a = kkt.pattern.links[original], &b = kkt.pattern.links[twin];
    J.middleRows(b.first_row, b.m) = numbers(b.m, a.m) * J.middleRows(a.first_row, a.m);
  }
  out_.write_J(J);
  out_.f = numbers(kkt.pattern.n, 1);
  out_.c = out_.J() * numbers(kkt.pattern.n, 1);
  kkt.update_scales();
  return std::move(out_);
}

KktSystem random_system(int shape, unsigned seed, bool redundant) {
  KktBuilder b(seed);
  std::size_t twin = 0;
  const RowKinds revolute = rows_of(3, 2);
  switch (shape) {
    case 0:  // chain from the ground
      for (int i = 0; i < 6; ++i) b.slot(), twin = b.link(i == 0 ? std::vector{0} : std::vector{i - 1, i}, revolute);
      break;
    case 1:  // closed loop, both ends on the ground
      for (int i = 0; i < 7; ++i)
        b.slot(), twin = b.link(i == 0 ? std::vector{0} : std::vector{i - 1, i}, rows_of(3, 1));
      b.link({6}, rows_of(3, 2));
      break;
    case 2:  // star: one hub
      b.slot();
      for (int i = 1; i < 8; ++i) b.slot(), twin = b.link({0, i}, rows_of(3, 0));
      break;
    case 3:  // particles and bodies in a string
      for (int i = 0; i < 8; ++i)
        b.slot(i % 2 == 0 ? 3 : 6), twin = b.link(i == 0 ? std::vector{0} : std::vector{i, i - 1}, rows_of(0, 0, 1));
      break;
    case 4:  // slots of the paper's form
      for (int i = 0; i < 4; ++i)
        b.slot(7), twin = b.link(i == 0 ? std::vector{0} : std::vector{i - 1, i}, revolute), b.unit_length_row(i);
      break;
    case 5:  // a coupling of four slots, and a slot without links
      for (int i = 0; i < 5; ++i) b.slot();
      twin = b.link({3, 1}, revolute);
      b.link({0, 1, 2, 3}, rows_of(1, 1, 2));
      break;
    case 6:  // no rows at all
      b.slot(), b.slot(3);
      return b.finish();
    default:  // more rows than unknowns, all of them on one particle
      b.slot(3);
      twin = b.link({0}, rows_of(2, 0));
      if (redundant) b.link({0}, rows_of(3, 0, 1));
  }
  if (redundant) b.doubled(twin);
  return b.finish();
}

KktSolution solve_exactly(const KktSystem& system) {
  const MatX M = system.M(), J = system.J();
  KktSolution out;
  if (system.kkt.pattern.m == 0) return {dense::solve(M, system.f), VecX(0), 0};
  out.rank = dense::rank(J, 1e-10);
  out.a = dense::least_squares(J, system.c, 1e-10);
  if (const MatX N = dense::null_space(J, 1e-10); N.cols() > 0)
    out.a += N * dense::solve(N.transpose() * M * N, N.transpose() * (system.f - M * out.a));
  const VecX root_E = system.kkt.E.cwiseSqrt();
  const MatX columns = J.transpose() * root_E.cwiseInverse().asDiagonal();
  out.lambda = dense::least_squares(columns, system.f - M * out.a, 1e-10).cwiseQuotient(root_E);
  return out;
}

double difference(const VecX& x, const VecX& y) {
  if (x.size() != y.size()) return std::numeric_limits<double>::infinity();
  if (y.size() == 0) return 0.0;
  return (x - y).lpNorm<Eigen::Infinity>() / y.lpNorm<Eigen::Infinity>();
}

}  // namespace lockstep::test
