// Channels of links: coordinates of P seen from S (no imposed law taken off), rows, a link's own quantities.
#include <spdlog/fmt/fmt.h>

#include <memory>

#include "framework/tools/record/channel_entry.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep::channels {
namespace {

// theta = 2 atan2(e_k, e0) with its rates; not finite where both are 0, where the angle has no meaning.
struct Turn {
  double angle, d, dd;
};
Turn turn(int k, const Relative& r) {
  const double c = r.y[3], s = r.y[4 + k], cd = r.yd[3], sd = r.yd[4 + k], cdd = r.ydd[3], sdd = r.ydd[4 + k];
  const double n = c * c + s * s, d = 2.0 * (c * sd - s * cd) / n;
  return {2.0 * std::atan2(s, c), d, (2.0 * (c * sdd - s * cdd) - 2.0 * d * (c * cd + s * sd)) / n};
}

void add_coordinates(const Frame& p, const Frame& s, Entries& out) {
  const auto y = [p, s](const Sample& x) { return relative(p, s, x.state); };
  const auto y2 = [p, s](const Sample& x) { return relative_with_second(p, s, x); };
  add_vector(out, "", "m", "origin of P, S axes", [y](const Sample& x) { return Vec3(y(x).y.head<3>()); });
  add_vector(out, "v", "m/s", "rate of that", [y](const Sample& x) { return Vec3(y(x).yd.head<3>()); });
  add_vector(out, "a", "m/s^2", "second rate of that", [y2](const Sample& x) { return Vec3(y2(x).ydd.head<3>()); });
  add_vector(out, "omega_", "rad/s", "angular velocity of P against S, S axes",
             [y](const Sample& x) { return y(x).w; });
  for (int k = 0; k < 3; ++k) {
    const std::string axis = kAxisName[k];
    add(out, axis + "_d", "m/s", "rate of " + axis, [y, k](const Sample& x) { return y(x).yd[k]; });
    add(out, axis + "_dd", "m/s^2", "second rate of " + axis, [y2, k](const Sample& x) { return y2(x).ydd[k]; });
    add_angle(out, "angle_" + axis, "turn of P about S's " + axis + ", counted past full turns",
              [y, k](const Sample& x) {
                const Turn t = turn(k, y(x));
                return RawAngle{t.angle, t.d};
              });
    add(out, "angle_" + axis + "_d", "rad/s", "rate of angle_" + axis,
        [y, k](const Sample& x) { return turn(k, y(x)).d; });
    add(out, "angle_" + axis + "_dd", "rad/s^2", "second rate of angle_" + axis,
        [y2, k](const Sample& x) { return turn(k, y2(x)).dd; });
  }
}

const RowEntry* entry_of(const Lock& link, const RowTable& rows) {
  const int k = rows.entry_of_link[static_cast<std::size_t>(link.number())];
  return k < 0 ? nullptr : &rows.entries[static_cast<std::size_t>(k)];
}

// Which of the entry's rows is the link's own row k; -1: it is not in force, or out of the plane.
int row_of(const RowEntry* e, int k) {
  for (int i = 0; e && i < e->m; ++i)
    if (e->own[static_cast<std::size_t>(i)] == k) return i;
  return -1;
}

void add_rows(const Lock& link, Entries& out) {
  const Lock* const l = &link;
  for (int k = 0; k < link.row_count(); ++k) {
    const RowKind kind = link.row_kind(k);
    const std::string row = link.row_name(k);
    add(out, "C_" + row, kind == RowKind::translation ? "m" : "",
        "residual of row " + row + "; 0 while the link is not active", [l, k](const Sample& s) {
          const Evaluated& v = s.values();
          const RowEntry* e = entry_of(*l, v.rows);
          const int i = row_of(e, k);
          return i >= 0 ? v.rows.block(*e).C(i) : 0.0;
        });
    add(out, "lambda_" + row,
        kind == RowKind::translation ? "N"
        : kind == RowKind::rotation  ? "N m"
                                     : "",
        "multiplier of row " + row + "; 0 while the link is not active", [l, k](const Sample& s) {
          const Evaluated& v = s.values();
          const RowEntry* e = entry_of(*l, v.rows);
          const int i = row_of(e, k);
          return i >= 0 ? v.lambda[e->first_row + i] : 0.0;
        });
  }
}

// The row's own value, whether or not it is in force.
double row_value(const Lock& link, const Inputs& in, RowTable& room) {
  const RowShape shape = link.shape();
  const Lock* const one = &link;
  link.gather(Group(&one, 1), in, room.spatial_span(shape));
  return room.spatial(shape).C(0);
}

void add_contact(const Lock& link, Entries& out) {
  const Lock* const l = &link;
  const auto room = std::make_shared<RowTable>();
  add(out, "gap", link.row_kind(0) == RowKind::translation ? "m" : "",
      "how far the one-sided link is from holding; below zero is forbidden", [l, room](const Sample& s) {
        return l->unilateral()->sign() * row_value(*l, s.dynamics().inputs(s.state), *room);
      });
  add(out, "in_contact", "", "1 while the one-sided link holds, 0 while it is free",
      [l](const Sample& s) { return s.state.modes[static_cast<std::size_t>(l->number())] ? 1.0 : 0.0; });
  add(out, "impact_loss", "J", "energy lost in its impacts since the start",
      [l](const Sample& s) { return s.state.z[l->impact_memory()]; });
}

}  // namespace

void of_link(const System& system, const Lock& link, Entries& out) {
  const Lock* const l = &link;
  const auto pairs = link.pairs();
  if (!pairs.empty())
    add_coordinates({pairs.front().first->body, pairs.front().first},
                    {pairs.front().second->body, pairs.front().second}, out);
  if (system.ready()) add_rows(link, out);
  const auto scratch = std::make_shared<VecX>();
  add(out, "violation", "m", "largest residual of the link, turns as lengths; 0 while it is not active",
      [l, scratch](const Sample& s) {
        const Evaluation& at = s.values().evaluation;
        const RowTable& rows = at.rows();
        const RowEntry* e = entry_of(*l, rows);
        if (!e) return 0.0;
        scratch->setZero(rows.n_rows);
        for (int k = 0; k < e->m; ++k) (*scratch)[e->first_row + k] = rows.block(*e).C(k);
        return at.norm(*scratch);
      });
  if (link.unilateral()) add_contact(link, out);
  const Observable* const observable = link.observable();
  if (observable == nullptr) return;
  const std::vector<Quantity> own = observable->quantities();
  for (int k = 0; k < static_cast<int>(own.size()); ++k)
    add(out, own[static_cast<std::size_t>(k)].name, own[static_cast<std::size_t>(k)].unit,
        fmt::format("quantity of a {} link", link.type()), [l, observable, k](const Sample& s) {
          return named(*l, s.state.t, [&] { return observable->quantity(k, s.values().in); });
        });
}

}  // namespace lockstep::channels
