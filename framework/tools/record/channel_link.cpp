// SPDX-License-Identifier: BSD-3-Clause
// Channels of links: coordinates of P relative to S (imposed motion included), rows, a link's own quantities.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include <lockstep/joints.h>
#include "framework/dynamics/solvers/scales.h"
#include "framework/mechanism/system/diagnose.h"
#include "framework/tools/record/channel_entry.h"

namespace lockstep::channels {
namespace {

// Of the two names of a rotation the joint's own: "rz" of the one rotation that it leaves free; all others are
// "angle_x", ...
bool is_own_name(const Lock& link, const NamedCoordinate& c) {
  if (c.of.kind != Coordinate::Kind::turn) return true;
  const Jointed* joint = link.jointed();
  const Mask turns = joint == nullptr ? Mask::none : joint->mask() & Mask::e123;
  const bool only = count_rows(turns) == 2 && !overlaps(turns, row_of(static_cast<Axis>(3 + c.of.axis)));
  return c.name.starts_with('r') == only;
}

void add_rows(const Lock& link, Entries& out) {
  constexpr const char* kUnits[] = {"N", "N m", ""};  // of multipliers, by RowKind
  const Lock* const l = &link;
  const auto room = std::make_shared<RowTable>();
  for (int k = 0; k < link.row_count(); ++k) {
    const RowKind kind = link.row_kind(k);
    const std::string& row = link.row_name(k);
    add(out, "C_" + row, kind == RowKind::translation ? "m" : "",
        "violation of constraint " + row + "; 0 while the joint is inactive", [l, k, room](const Sample& s) {
          const bool holds = s.state.modes[l->number()] && !s.dynamics().system().merged(*l);
          return holds ? gather_alone(*l, s.dynamics().inputs(s.state), *room).C(k) : 0.0;
        });
    add(out, "lambda_" + row, kUnits[static_cast<std::size_t>(kind)],
        "multiplier of constraint " + row + "; 0 while the joint is inactive", [l, k](const Sample& s) {
          const RowEntry* e = entry_of(*l, s.values().rows);
          for (int i = 0; e && i < e->m; ++i)
            if (e->own[i] == k) return s.values().lambda[e->first_row + i];
          return 0.0;
        });
  }
}

void add_contact(const Lock& link, Entries& out) {
  const Lock* const l = &link;
  const auto room = std::make_shared<RowTable>();
  const bool turns = dynamic_cast<const TurnStop*>(l) != nullptr;  // of a stop, whose row is a function
  const bool slides = link.row_kind(0) == RowKind::translation || (link.type() == "stop" && !turns);
  add(out, "gap", std::string(slides ? "m" : "") + (turns ? "rad" : ""),
      "gap of the one-sided joint; negative is penetration", [l, room](const Sample& s) {
        return l->unilateral()->sign() * gather_alone(*l, s.dynamics().inputs(s.state), *room).C(0);
      });
  add(out, "in_contact", "", "1 in contact, 0 otherwise",
      [l](const Sample& s) { return s.state.modes[l->number()] ? 1.0 : 0.0; });
  add(out, "impact_loss", "J", "energy lost in its impacts since the start",
      [l](const Sample& s) { return s.state.z[l->impact_memory()]; });
}

}  // namespace

const RowEntry* entry_of(const Lock& link, const RowTable& rows) {
  const int k = rows.entry_of_link[link.number()];
  return k < 0 ? nullptr : &rows.entries[k];
}

double left_out_violation(const Lock& link, const Sample& s, RowTable& room) {
  const System& system = s.dynamics().system();
  const unsigned rows = s.state.modes[link.number()] ? system.left_out(link) : 0;
  double most = 0;
  for (int k = 0; k < link.row_count() && rows != 0; ++k)
    if ((rows >> k & 1U) != 0)
      most = std::max(most, length_per_unit(link.row_kind(k), system.length()) *
                                std::abs(gather_alone(link, s.dynamics().inputs(s.state), room).C(k)));
  return most;
}

double violation(const Evaluation& at, std::span<const RowEntry> entries, VecX& scratch) {
  scratch.setZero(at.rows().n_rows);
  for (const RowEntry& e : entries)
    for (int k = 0; k < e.m; ++k) scratch[e.first_row + k] = at.rows().block(e).C(k);
  return at.norm(scratch);
}

void of_link(const System& system, const Lock& link, Entries& out) {
  const Lock* const l = &link;
  if (const auto pairs = link.pairs(); !pairs.empty()) {
    const auto [p, s] = pairs.front();
    for (const NamedCoordinate& c : coordinates_of(CoordinateOwner::joint))
      if (is_own_name(link, c)) add_coordinate(out, c, {{p->body, p}}, {{s->body, s}});
  }
  if (system.ready()) add_rows(link, out);
  const auto scratch = std::make_shared<VecX>();
  const auto room = std::make_shared<RowTable>();
  add(out, "violation", "m", "largest constraint violation of the joint, rotations as lengths; 0 while it is inactive",
      [l, scratch, room](const Sample& s) {
        const Evaluation& at = s.values().evaluation;
        const RowEntry* e = entry_of(*l, at.rows());
        return std::max(e ? violation(at, {e, 1}, *scratch) : 0.0, left_out_violation(*l, s, *room));
      });
  if (link.unilateral()) add_contact(link, out);
  if (const Observable* const own = link.observable())
    add_own(out, own->quantities(), fmt::format("{} joint", link.type()), [l, own](int k, const Sample& s) {
      return named(*l, s.state.t, [&] { return own->quantity(k, s.values().in); });
    });
}

}  // namespace lockstep::channels
