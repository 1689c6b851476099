// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/check/lock_bench.h"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <limits>

namespace lockstep {

std::vector<MatX> gathered(const System& system, Group links, const TestState& at, double before, bool* outside) {
  const RowShape s = links.front()->shape();
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
  links.front()->gather(links, at.in(), out);
  std::vector<MatX> all(links.size(), MatX::Zero(s.m, 3 + 6 * system.n_slots()));
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
  if (outside != nullptr) *outside = numbers != empty;
  return all;
}

MatX rows_of(const System& system, const Lock& link, const TestState& at) {
  const Lock* self = &link;
  return gathered(system, Group(&self, 1), at)[0];
}

// The states by Gauss's rule over the rates along the motion; at each point s itself is extrapolated linearly.
Curve C_along(const System& system, const Lock& link, TestState from, double sign) {
  return [&system, &link, sign, from = std::move(from)](double end) -> VecX {
    const int n = link.n_own_states(), first = link.first_state();
    const auto rates = [&](const TestState& at) {
      VecX rate(n);
      link.stateful()->state_rates(at.in(), {rate.data(), static_cast<std::size_t>(n)});
      return rate;
    };
    TestState to = coasted(from, end);
    for (int i = 0; i < n; ++i) {
      const auto rate = [&](double x) {
        TestState on = coasted(from, x);
        on.s.segment(first, n) += x * rates(from);
        return rates(on)[i];
      };
      to.s[first + i] += boost::math::quadrature::gauss<double, 5>::integrate(rate, 0.0, end);
    }
    return sign * rows_of(system, link, to).col(0);
  };
}

}  // namespace lockstep
