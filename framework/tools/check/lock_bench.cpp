#include "framework/tools/check/lock_bench.h"

#include <algorithm>

namespace lockstep {
namespace {

constexpr std::size_t kGuard = 64;  // numbers in front of and behind the rows
constexpr double kMark = -7.25e77;  // their value

}  // namespace

void LockBench::gather(const TestState& at, Group links, double before) {
  const RowShape s = link_.shape();
  const std::size_t stride = RowSpan::stride(s), ld = std::max(s.ld(), 1);
  const std::size_t n_turned_columns = n_turned(s.layout);
  n_lanes_ = links.size();
  numbers_.assign(2 * kGuard + n_lanes_ * stride, kMark);
  for (std::size_t lane = 0; lane < n_lanes_; ++lane) {
    double* block = numbers_.data() + kGuard + lane * stride;
    std::fill(block, block + stride, 0.0);
    for (std::size_t c = 0; c < s.size() / ld; ++c) {
      const bool turned = c >= 3 && c < 3 + n_turned_columns;  // the columns of R have three rows
      std::fill_n(block + c * ld, turned ? std::min(s.m, 3) : s.m, before);
    }
  }
  link_.gather(links, at.in(), RowSpan(numbers_.data() + kGuard, s));
  check_bounds();
}

void LockBench::check_bounds() {
  const RowShape s = link_.shape();
  const std::size_t stride = RowSpan::stride(s), end = kGuard + n_lanes_ * stride, ld = s.ld(), m = s.m;
  wrote_padding_ = wrote_outside_ = false;
  for (std::size_t i = 0; i < numbers_.size(); ++i)
    if (i < kGuard || i >= end) {
      wrote_outside_ = wrote_outside_ || numbers_[i] != kMark;
    } else {
      const std::size_t k = (i - kGuard) % stride;
      wrote_padding_ = wrote_padding_ || ((k >= s.size() || k % ld >= m) && numbers_[i] != 0);
    }
}

LockRows LockBench::read(std::size_t lane) const {
  const RowShape s = link_.shape();
  const RowView block(numbers_.data() + kGuard + lane * RowSpan::stride(s), s);
  const SlotList slots = link_.slots();
  LockRows out{Eigen::MatrixX3d(s.m, 3), MatX::Zero(s.m, 6 * system_.n_slots())};
  for (int k = 0; k < s.m; ++k) {
    out.parts.row(k) << block.C(k), block.Ct(k), block.Qhat(k);
    for (int i = 0; i < slots.n; ++i) {
      const auto r = block.J(i, k);
      for (int j = 0; j < 6; ++j) out.J(k, 6 * slots[i] + j) = r[j];
    }
  }
  return out;
}

LockRows LockBench::rows(const TestState& at, double before) {
  const Lock* self = &link_;
  gather(at, Group(&self, 1), before);
  return read(0);
}

std::pair<LockRows, LockRows> LockBench::rows_of_group(const TestState& at, const Lock& other) {
  const Lock* both[2] = {&link_, &other};
  gather(at, Group(both, 2), 0);
  return {read(0), read(1)};
}

// Gauss's rule with 5 points over the rates along the motion; at each point s itself is extrapolated linearly.
void LockBench::move_states(const TestState& from, TestState& to) const {
  const int n = link_.n_own_states();
  if (n == 0) return;
  const auto rates = [&](const TestState& at) {
    VecX rate(n);
    link_.stateful()->state_rates(at.in(), {rate.data(), static_cast<std::size_t>(n)});
    return rate;
  };
  constexpr double x[5] = {0.04691007703066800, 0.2307653449471585, 0.5, 0.7692346550528415, 0.9530899229693320};
  constexpr double w[5] = {0.1184634425280945, 0.2393143352496832, 0.2844444444444444, 0.2393143352496832,
                           0.1184634425280945};
  const double h = to.t - from.t;
  const VecX start = rates(from);
  VecX sum = VecX::Zero(n);
  for (int i = 0; i < 5; ++i) {
    TestState on = coasted(from, x[i] * h);
    on.s.segment(link_.first_state(), n) += x[i] * h * start;
    sum += w[i] * rates(on);
  }
  to.s.segment(link_.first_state(), n) += h * sum;
}

}  // namespace lockstep
