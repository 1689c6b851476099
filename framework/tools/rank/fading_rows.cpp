// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/rank/fading_rows.h"

#include "framework/dynamics/evaluate/row_space.h"
#include "framework/tools/rank/loop_rows.h"

namespace lockstep {

namespace {

// Of a pivot, what is left of it beside a singular configuration; and of the combination of rows that fades there, the
// share below which a row takes no part, since what is left of the pivot is spread over others.
constexpr double kFaded = 0.05;

}  // namespace

std::vector<std::string> fading_links(System& system, const State& regular, const State& singular) {
  const Evaluation before(system, regular), there(system, singular);
  std::vector<std::string> names;
  for (const std::vector<int>& entries : loops_of(system, there.rows())) {
    const LoopRows rows(system, there.rows(), entries), usual(system, before.rows(), entries);
    if (rows.n() > kDenseRows || rows.n() != usual.n()) continue;
    const RowSpace was(usual.Jt), now(rows.Jt);
    const int rank = was.rank();
    if (rank == 0 || !(now.pivot(rank - 1) < kFaded * was.pivot(rank - 1))) continue;
    const VecX shares = now.circuit(rank - 1, rank - 1).cwiseAbs();
    for (int k = 0; k < rows.n(); ++k)
      if (shares[k] >= kFaded) add_name(NamedRow(system, there.rows(), rows.numbers[k]).link->name(), names);
  }
  return names;
}

}  // namespace lockstep
