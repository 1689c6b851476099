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

// Rates of theta = 2 atan2(e_k, e0); not finite if both are 0, where the angle is undefined.
struct Turn {
  double d, dd;
};
Turn turn(int k, const Relative& r) {
  const double c = r.e.w, s = r.e.vec()[k], cd = r.ed.w, sd = r.ed.vec()[k], cdd = r.edd.w, sdd = r.edd.vec()[k];
  const double n = c * c + s * s, d = 2.0 * (c * sd - s * cd) / n;
  return {d, (2.0 * (c * sdd - s * cdd) - 2.0 * d * (c * cd + s * sd)) / n};
}

// "rz" of the one rotation that a joint leaves free; all others are "angle_x", ...
std::string angle_name(const Lock& link, int k) {
  const Jointed* joint = link.jointed();
  const Mask turns = joint == nullptr ? Mask::none : joint->mask() & Mask::e123;
  const bool only = count_rows(turns) == 2 && !overlaps(turns, row_of(static_cast<Axis>(3 + k)));
  return (only ? "r" : "angle_") + std::string(kAxisName[k]);
}

void add_coordinates(const Lock& link, const Frame& p, const Frame& s, Entries& out) {
  const auto y = [p, s](const Sample& x) { return relative(p, s, x); };
  const auto y2 = [p, s](const Sample& x) { return relative_with_second(p, s, x); };
  add_origin(out, p, s, {"position of P relative to S, S axes", "rate of the position", "second rate of the position"});
  add_vector(out, "omega_", "rad/s", "angular velocity of P relative to S, S axes",
             [y](const Sample& x) { return y(x).w(); });
  for (int k = 0; k < 3; ++k) {
    const std::string axis = kAxisName[k];
    add(out, axis + "_d", "m/s", "rate of " + axis, [y, k](const Sample& x) { return y(x).v[k]; });
    add(out, axis + "_dd", "m/s^2", "second rate of " + axis, [y2, k](const Sample& x) { return y2(x).a[k]; });
    const std::string angle = angle_name(link, k);
    add_angle(out, angle, "rotation of P about S's " + axis + ", with its revolutions",
              [p, s, k](System& system) -> const CountedAngle& { return system.count(*p.marker, *s.marker, k); });
    add(out, angle + "_d", "rad/s", "rate of " + angle, [y, k](const Sample& x) { return turn(k, y(x)).d; });
    add(out, angle + "_dd", "rad/s^2", "second rate of " + angle,
        [y2, k](const Sample& x) { return turn(k, y2(x)).dd; });
  }
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
  const auto pairs = link.pairs();
  if (!pairs.empty())
    add_coordinates(link, {pairs.front().first->body, pairs.front().first},
                    {pairs.front().second->body, pairs.front().second}, out);
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
