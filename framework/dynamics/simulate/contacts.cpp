// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/simulate/contacts.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include "framework/dynamics/evaluate/projection_rule.h"
#include "framework/dynamics/solvers/scales.h"

namespace lockstep {

void Contacts::lay_out(const System& system, const Stabilization& stabilization) {
  all_.clear();
  // Ten times the residual of a projection.
  const double length = system.length(),
               margin = 10 * std::max(0.01 * stabilization.tolerance, position_rounding(length, 0));
  for (const auto& link : system.links()) {
    if (!link->unilateral()) continue;
    Contact c;
    c.link = link.get();
    c.sign = link->unilateral()->sign();
    c.margin = margin / length_per_unit(link->row_kind(0), length);
    all_.push_back(c);
  }
}

Gap Contacts::gap(std::size_t i, const Inputs& in) {
  const Contact& contact = all_[i];
  const RowView block = gather_alone(*contact.link, in, room_);
  const SlotList slots = contact.link->slots();
  double cd = block.Ct(0);
  for (int k = 0; k < slots.n; ++k) {
    const auto r = block.J(k, 0);
    const Motion& O = in.slot(slots[k]);
    cd += r[0] * O.v[0] + r[1] * O.v[1] + r[2] * O.v[2] + r[3] * O.w[0] + r[4] * O.w[1] + r[5] * O.w[2];
  }
  if (!std::isfinite(block.C(0) + cd))
    throw NonFiniteError(
        fmt::format("the gap of one-sided joint '{}' is not finite at t = {:.9g} s; check its markers and laws",
                    contact.link->name(), in.t),
        in.t);
  return {contact.sign * block.C(0), contact.sign * cd};
}

// C'' = Jh a - Qhat
double Contacts::gap_dd(std::size_t i, const Evaluated& v) {
  const Contact& contact = all_[i];
  const RowView block = gather_alone(*contact.link, v.in, room_);
  const SlotList slots = contact.link->slots();
  double cdd = -block.Qhat(0);
  for (int k = 0; k < slots.n; ++k) {
    const auto r = block.J(k, 0);
    for (int j = 0; j < 6; ++j) cdd += r[j] * v.a[6 * slots[k] + j];
  }
  return contact.sign * cdd;
}

int Contacts::row(std::size_t i, const RowTable& rows) const {
  const int entry = rows.entry_of_link[number(i)];
  return entry < 0 ? -1 : rows.entries[entry].first_row;
}

}  // namespace lockstep
