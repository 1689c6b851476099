#include "framework/tools/check/lock_bench.h"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <limits>

namespace lockstep {

std::vector<MatX> LockBench::gather(const TestState& at, Group links, double before) const {
  const RowShape s = link_.shape();
  const std::size_t stride = RowSpan::stride(s), ld = std::max(s.ld(), 1);
  const std::size_t n_turned_columns = n_turned(s.layout);
  // The rows, padded with zeros, between two fences.
  Aligned<double> numbers((links.size() + 2) * stride, std::numeric_limits<double>::max());
  std::fill(numbers.begin() + stride, numbers.end() - stride, 0.0);
  const auto fill_rows = [&](double x) {
    for (std::size_t lane = 1; lane <= links.size(); ++lane)
      for (std::size_t c = 0; c < s.size() / ld; ++c) {
        const bool turned = c >= 3 && c < 3 + n_turned_columns;  // the columns of R have three rows
        std::fill_n(numbers.data() + lane * stride + c * ld, turned ? std::min(s.m, 3) : s.m, x);
      }
  };
  const Aligned<double> empty = numbers;
  fill_rows(before);
  const RowSpan out(numbers.data() + stride, s);
  link_.gather(links, at.in(), out);
  std::vector<MatX> all(links.size(), MatX::Zero(s.m, 3 + 6 * system_.n_slots()));
  for (std::size_t lane = 0; lane < links.size(); ++lane)
    for (int k = 0; k < s.m; ++k) {
      const RowView block = out.lane(lane);
      auto row = all[lane].row(k);
      row.head<3>() << block.C(k), block.Ct(k), block.Qhat(k);
      for (int i = 0; i < s.n; ++i)
        row.segment<6>(3 + 6 * links[lane]->slots()[i]) =
            Eigen::Map<const Eigen::RowVector<double, 6>>(block.J(i, k).data());
    }
  fill_rows(0);
  wrote_outside_ = numbers != empty;
  return all;
}

MatX LockBench::rows(const TestState& at, double before) const {
  const Lock* self = &link_;
  return gather(at, Group(&self, 1), before)[0];
}

std::pair<MatX, MatX> LockBench::rows_of_group(const TestState& at, const Lock& other) const {
  const Lock* both[2] = {&link_, &other};
  const std::vector<MatX> rows = gather(at, Group(both, 2), 0);
  return {rows[0], rows[1]};
}

// By Gauss's rule over the rates along the motion; at each point s itself is extrapolated linearly.
void LockBench::move_states(const TestState& from, TestState& to) const {
  const int n = link_.n_own_states(), first = link_.first_state();
  const auto rates = [&](const TestState& at) {
    VecX rate(n);
    link_.stateful()->state_rates(at.in(), {rate.data(), static_cast<std::size_t>(n)});
    return rate;
  };
  for (int i = 0; i < n; ++i) {
    const auto rate = [&](double x) {
      TestState on = coasted(from, x);
      on.s.segment(first, n) += x * rates(from);
      return rates(on)[i];
    };
    to.s[first + i] += boost::math::quadrature::gauss<double, 5>::integrate(rate, 0.0, to.t - from.t);
  }
}

Curve LockBench::C_along(TestState from, double sign) const {
  return [this, sign, from = std::move(from)](double x) -> VecX {
    TestState on = coasted(from, x);
    move_states(from, on);
    return sign * rows(on).col(0);
  };
}

}  // namespace lockstep
