// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/rank/unknowns.h"

#include <array>
#include <numeric>

#include "framework/dynamics/evaluate/row_space.h"

namespace lockstep {

std::vector<int> up_to(std::size_t n) {
  std::vector<int> all(n);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

Unknowns::Unknowns(const System& system) : Unknowns(system, up_to(static_cast<std::size_t>(system.n_slots()))) {}

Unknowns::Unknowns(const System& system, const std::vector<int>& slots) : system_(&system) {
  const std::array<int, 6> velocity = unknown_velocities(system.plane());
  for (const int slot : slots)
    for (int j = 0; j < BodyMass(system.slot(slot), system.plane()).width(); ++j)
      if (const int place = 6 * slot + velocity[j]; column_.try_emplace(place, n()).second) places_.push_back(place);
  lengths_.resize(n());
  for (Eigen::Index i = 0; i < lengths_.size(); ++i) lengths_[i] = places_[i] % 6 < 3 ? 1.0 : system.length();
}

VecX Unknowns::of_slots(const VecX& six) const { return six(places_); }

VecX Unknowns::to_slots(const VecX& unknowns) const {
  VecX out = VecX::Zero(6 * system_->n_slots());
  out(places_) = unknowns;
  return out;
}

void Unknowns::add(int row_slot, int column_slot, const Mat6& block, Triplets& to) const {
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      if (block(i, j) == 0) continue;
      const int row = column(row_slot, i), col = column(column_slot, j);
      if (row >= 0 && col >= 0) to.emplace_back(row, col, block(i, j));
    }
}

void Unknowns::add(int slot, const Mat3& moves, const Mat3& turns, Triplets& to) const {
  Mat6 block = Mat6::Zero();
  block.topLeftCorner<3, 3>() = moves, block.bottomRightCorner<3, 3>() = turns;
  add(slot, slot, block, to);
}

SparseMat Unknowns::rows(const RowTable& table, const std::vector<int>& entries) const {
  Triplets Jt;
  int row = 0;
  for (const int at : entries) {
    const RowEntry& e = table.entries[at];
    for (int k = 0; k < e.m; ++k, ++row)
      for (int i = 0; i < e.slots.n; ++i) {
        const std::array<double, 6> J = table.block(e).J(i, k);
        for (int j = 0; j < 6; ++j)
          if (const double x = J[j]; x != 0)
            if (const int u = column(e.slots[i], j); u >= 0) Jt.emplace_back(u, row, x);
      }
  }
  SparseMat out(n(), row);
  out.setFromTriplets(Jt.begin(), Jt.end());
  return out;
}

SparseMat Unknowns::rows_in_lengths(const RowTable& table, const std::vector<int>& entries) const {
  return scaled(lengths_.cwiseInverse(), rows(table, entries));
}

SparseMat Unknowns::square(const Triplets& entries) const {
  SparseMat out(n(), n());
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

MatX free_motions(const Evaluation& e) { return RowSpace(Unknowns(e.system()).rows_in_lengths(e.rows())).free(); }

}  // namespace lockstep
