// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/detail/rows.h>

#include <algorithm>

namespace lockstep {

Auxiliary::~Auxiliary() = default;

void Auxiliary::start(std::span<double> s) const { std::fill(s.begin(), s.end(), 0.0); }

double power_of_laws(const RowTable& rows, const VecX& lambda) {
  if (lambda.size() != rows.n_rows) return NAN;  // they are not solved for
  double power = 0;
  for (const RowEntry& e : rows.entries) {
    const RowView block = rows.block(e);
    for (int k = 0; k < e.m; ++k) power += lambda[e.first_row + k] * block.Ct(k);
  }
  return power;
}

}  // namespace lockstep
