// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/rank/left_out_rows.h"

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include "framework/dynamics/evaluate/row_space.h"
#include "framework/foundation/math/limits.h"
#include "framework/foundation/support/at_end.h"
#include "framework/tools/rank/motion_words.h"

namespace lockstep {
namespace {

constexpr double kStep = 0.05;  // rad, or of the length: as far as a projection follows from one pose to the next
constexpr int kSteps = 6;  // 0.3 rad: what depends in one position only is violated by a hundredth of the length there

/// A row by itself, in lengths: C, and its Jacobian in these unknowns.
struct OneRow {
  double C = 0;
  VecX J;
};

OneRow one_row(const NamedRow& row, const Inputs& in, const Unknowns& at) {
  RowTable room;
  const RowBlock block = gather_alone(*row.link, in, room);
  OneRow out{block.C(row.own), VecX::Zero(at.n())};
  const SlotList& on = row.link->slots();
  for (int i = 0; i < on.n; ++i)
    for (int j = 0; j < 6; ++j)
      if (const int u = at.column(on[i], j); u >= 0) out.J[u] += block.J(i, row.own)[j];
  out.J = out.J.cwiseQuotient(at.lengths());
  if (const double length = out.J.norm(); length > 0) out.C /= length, out.J /= length;
  return out;
}

/// The motion that these rows leave free nearest to u; zero if they hold u.
VecX nearest_free(const RowTable& rows, const Unknowns& at, const VecX& u) {
  const VecX free = RowSpace(at.rows_in_lengths(rows)).free_part(u);
  return free.norm() > kNegligible * u.norm() ? free : VecX(VecX::Zero(u.size()));
}

}  // namespace

bool are_few_rows(const System& system, const std::vector<bool>& modes) {
  RowTable table;
  passes::lay_out(system, modes, table, true);
  return table.n_rows <= kDenseRows;
}

void leave_out(System& system, const std::vector<NamedRow>& rows) {
  system.setup();
  for (const NamedRow& row : rows) system.leave_out(*row.link, system.left_out(*row.link) | 1U << row.own);
}

void release_drives(System& system) {
  for (const auto& link : system.links()) {
    unsigned drives = 0;
    for (int k = 0; k < link->row_count(); ++k)
      if (link->row(k).drive >= 0) drives |= 1U << k;
    if (drives != 0) system.leave_out(*link, system.left_out(*link) | drives);
  }
  system.setup();
}

void take_back(System& system) {
  system.setup();
  for (const auto& link : system.links())
    if (system.left_out(*link) != 0) system.leave_out(*link, 0);
  if (system.held_down_to() > 0) system.hold_down_to(0);
  system.setup();
}

std::optional<Violation> violation_without(System& system, Dynamics& dynamics, const State& start,
                                           const std::vector<NamedRow>& rows,
                                           const std::vector<NamedRow>& all_left_out) {
  leave_out(system, all_left_out), release_drives(system);
  const AtEnd back([&] { take_back(system); });  // it was set up before with all rows: that does not throw
  const Unknowns at(system);
  std::optional<Violation> found;
  for (const NamedRow& row : rows) {
    State state = start;
    const auto now = [&](const NamedRow& r) { return one_row(r, dynamics.gather_rows(state).inputs(), at); };
    const auto nearest = [&](const VecX& to) { return nearest_free(dynamics.gather_rows(state).rows(), at, to); };
    VecX u = nearest(now(row).J);
    if (!u.isZero(0) && !found) found.emplace();
    for (int k = 0; k < kSteps && !u.isZero(0); ++k) {
      try {
        const VecX motion = at.motion_of(u);
        dynamics.advance(state, kStep * system.length() / motion_size(system, motion), motion);
        dynamics.project(state);
        for (const NamedRow& r : rows) {
          const double C = std::abs(now(r).C);
          found->most = std::max(found->most, C);
          if (r.link->row_kind(r.own) == RowKind::translation) found->gap = std::max(found->gap, C);
        }
        u = nearest(u);
      } catch (const Error&) {
        if (k <= 1) return Violation{HUGE_VAL, HUGE_VAL};
        break;  // it comes to an end of its way
      }
    }
  }
  return found;
}

}  // namespace lockstep
