// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/detail/rows.h>

#include <algorithm>

namespace lockstep {

Motion Differences::moved(const Motion& O, int k, double h) {
  Motion r = O;
  if (k < 3) r.x[k] += h;
  if (k >= 6 && k < 9) r.v[k - 6] += h;
  if (k >= 9) r.w[k - 9] += h;
  if (k < 3 || k >= 6) return r;
  r.e = O.e * exponential(h * Vec3::Unit(k - 3));
  r.A = rotation(r.e);
  return r;
}

double Differences::distance(std::span<const int> slots, const Inputs& in) {
  double d = 0;
  for (const int slot : slots) d += (in.slot(slot).x - in.slot(slots.front()).x).norm();
  if (d == 0) d = in.slot(slots.front()).x.norm();
  return d > 0 ? std::max(d, 1e-3) : 1.0;  // a single slot near the origin is no sign of a small mechanism
}

struct TangentSum::Block {
  Mat6 K = Mat6::Zero(), D = Mat6::Zero();
};

TangentSum::TangentSum() = default;

TangentSum::~TangentSum() = default;

void TangentSum::lay_out(int n_slots) {
  neighbours_.assign(n_slots, {});
  pairs_.clear();
  blocks_.clear();
  ++revision_;
  differences_.fresh = false;
}

void TangentSum::clear() {
  for (Block& b : blocks_) b = {};
  differences_.fresh = false;
}

TangentSum::Block& TangentSum::block(int row, int column) {
  auto& list = neighbours_[row];
  const auto at = std::ranges::lower_bound(list, column, {}, &Neighbour::column);
  if (at != list.end() && at->column == column) return blocks_[at->block];
  const std::size_t made = blocks_.size();
  insert(row, column);
  if (row != column) insert(column, row);
  ++revision_;
  return blocks_[made];
}

void TangentSum::insert(int row, int column) {
  auto& list = neighbours_[row];
  list.insert(std::ranges::lower_bound(list, column, {}, &Neighbour::column), {column, blocks_.size()});
  pairs_.push_back({row, column});
  blocks_.emplace_back();
}

void TangentSum::add_K(int row, int column, const Mat6& K) {
  if (row != kGround && column != kGround) block(row, column).K += K;
}

void TangentSum::add_D(int row, int column, const Mat6& D) {
  if (row != kGround && column != kGround) block(row, column).D += D;
}

void TangentSum::add_K(int row, Half r, int column, Half c, const Mat3& K) {
  if (row != kGround && column != kGround)
    block(row, column).K.block<3, 3>(static_cast<int>(r), static_cast<int>(c)) += K;
}

void TangentSum::add_D(int row, Half r, int column, Half c, const Mat3& D) {
  if (row != kGround && column != kGround)
    block(row, column).D.block<3, 3>(static_cast<int>(r), static_cast<int>(c)) += D;
}

const Mat6& TangentSum::K(std::size_t pair) const { return blocks_[pair].K; }

const Mat6& TangentSum::D(std::size_t pair) const { return blocks_[pair].D; }

Differences& TangentSum::differences(const Inputs& in) {
  if (!differences_.fresh) {
    differences_.motions.assign(in.motions.begin(), in.motions.end());
    differences_.f.setZero(6 * n_slots());
    differences_.fresh = true;
  }
  return differences_;
}

}  // namespace lockstep
