// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/passes.h>

#include <algorithm>
#include <cmath>

#include <lockstep/author/force.h>
#include <lockstep/author/lock.h>
#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/foundation/math/limits.h"
#include "framework/mechanism/model/read_motion.h"
#include "framework/mechanism/system/diagnose.h"
#include "framework/mechanism/system/lay_out.h"

namespace lockstep::passes {
namespace {

// A particle takes no moment: a force that exerts one on it is an error. `f`: the sums of all forces.
void check_particles(const System& system, const Inputs& in, const VecX& f) {
  const auto turned = [&](const VecX& sum) {
    for (int k = 0; k < system.n_slots(); ++k)
      if (system.slot(k).freedoms == Freedoms::particle &&
          sum.segment<3>(6 * k + 3).norm() > kNegligible * sum.segment<3>(6 * k).norm() * system.length())
        return k;
    return -1;
  };
  const bool particles = system.n_velocities() < (system.plane() ? 3 : 6) * system.n_slots();
  if (!particles || turned(f) < 0) return;
  for (const auto& force : system.forces()) {
    const VecX one = wrench_of(system, in, *force);
    const int k = turned(one);
    if (k < 0) continue;
    throw ModelError(
        at_time(in.t) + "force '" + force->name() + "' exerts a moment of " +
            text::brief(one.segment<3>(6 * k + 3).norm()) + " N m on body '" + system.body_of_slot(k).name +
            "', which is a particle and cannot rotate; give it an inertia, or apply the force at its point",
        {.thing = thing_of(*force), .t = in.t});
  }
}

std::span<double> part(VecX& x, int first, int size) { return {x.data() + first, static_cast<std::size_t>(size)}; }

// Numbers of another count would be written past.
void check_count(const char* what, Eigen::Index found, Eigen::Index needed) {
  if (found == needed) return;
  throw ModelError(std::string("passes::") + what + ": " + std::to_string(found) + " numbers, but " +
                   std::to_string(needed) + " are needed; size them by System::start()");
}

// A row that is left out must demand nothing: of a motion out of the plane, or of one that rows on which it depends hold.
void check_absent_row(const System& system, const Inputs& in, const Lock& link, int k, const RowView& all) {
  if ((system.left_out(link) >> k & 1U) != 0) {
    if (link.row(k).drive >= 0) return;  // the drive is released
    constexpr double kMost = 1e-2;
    const double x = std::abs(all.C(k)),
                 limit = kMost * (link.row_kind(k) == RowKind::translation ? system.length() : 1.0);
    if (x <= limit) return;
    throw ModelError("joint '" + link.name() + "', constraint " + link.row_name(k) +
                         ": left out at the start as redundant or nearly redundant, but violated by " + text::brief(x) +
                         " (limit " + text::brief(limit) + ") at t = " + text::number(in.t) +
                         " s; set \"nearly_redundant\" of \"run\" to \"held\" or \"report\", or correct the geometry",
                     {.thing = thing_of(link), .t = in.t});
  }
  const double x = std::max(std::abs(all.C(k)), std::abs(all.Ct(k)));
  if (system.plane() && x > 1e-8 * std::max(1.0, system.length()))
    throw ModelError("joint '" + link.name() + "', constraint " + link.row_name(k) +
                         ": prescribes a motion out of the plane (" + text::brief(x) +
                         ") at t = " + text::number(in.t) + " s, and the scene is planar; set \"planar\" to \"off\"",
                     {.thing = thing_of(link), .t = in.t});
}

// For a joint without planar rows, or some of whose rows are left out: gathers in space and copies what holds.
void gather_from_space(const System& system, const Inputs& in, RowTable& table, const RowEntry& e) {
  const Lock& link = *system.links()[e.link];
  const RowBlock all = gather_alone(link, in, table), block = table.block(e);
  for (int k = 0, next = 0; k < all.rows(); ++k)
    if (next < e.m && e.own[next] == k)
      ++next;
    else
      check_absent_row(system, in, link, k, all);
  for (int k = 0; k < e.m; ++k) {
    const int own = e.own[k];
    block.C(k) = all.C(own), block.Ct(k) = all.Ct(own), block.Qhat(k) = all.Qhat(own);
    for (int i = 0; i < e.slots.n; ++i) {
      const auto r = all.J(i, own);
      block.set(i, k, std::array{r[0], r[1], r[2]}, std::array{r[3], r[4], r[5]});
    }
  }
}

// Throws if a force has left the plane since setup. Below the limit it is round-off of forces and weights in the plane.
void check_plane(const System& system, const Inputs& in, const VecX& f) {
  const Plane plane = system.plane();
  double inside = 0, outside = 0;
  for (int k = 0; k < system.n_slots(); ++k) {
    inside = std::max({inside, std::abs(f[6 * k + plane.i()]), std::abs(f[6 * k + plane.j()]),
                       system.slot(k).mass * system.gravity().norm()});
    outside = std::max(outside, std::abs(f[6 * k + plane.n]));
  }
  if (!(outside > kNegligible * inside)) return;
  for (const auto& force : system.forces()) {
    const VecX one = wrench_of(system, in, *force);
    for (int k = 0; k < system.n_slots(); ++k)
      if (const double out = std::abs(one[6 * k + plane.n]); out > 0.5 * kNegligible * inside)
        throw ModelError("force '" + force->name() + "' acts out of the plane with " + text::brief(out) + " N at t = " +
                             text::number(in.t) + " s, and the scene is planar; set \"planar\" to \"off\"",
                         {.thing = thing_of(*force), .t = in.t});
  }
}

// absent(link): which of its rows are left out, a bit for each.
template <class Absent>
void lay_out_rows(const System& system, const std::vector<bool>& modes, RowTable& table, const Absent& absent_of) {
  const std::size_t n_links = system.links().size();
  check_count("lay_out, one per link", static_cast<Eigen::Index>(modes.size()), static_cast<Eigen::Index>(n_links));
  const System::Found& found = system.found();
  table.entries.clear();
  table.runs.clear();
  table.entry_of_link.assign(n_links, -1);
  table.entries.reserve(std::ranges::count(modes, true));
  int last = -2;
  for (int i = 0; i < static_cast<int>(found.ordered.size()); ++i) {
    const Lock& link = *found.ordered[i];
    if (!modes[link.number()]) continue;
    const int entry = static_cast<int>(table.entries.size());
    RowEntry e;
    e.link = link.number();
    e.slots = link.slots();
    e.layout = link.layout();
    e.sign = link.shape().sign;
    e.plane = system.plane();
    unsigned held = ~0U;  // a bit for each row
    bool in_plane = false;
    if (e.plane) {
      held = found.planar_rows[link.number()].held, in_plane = found.planar_rows[link.number()].by_link;
      e.layout = in_plane ? link.planar()->planar_layout() : RowLayout::planar;
    }
    const unsigned absent = absent_of(link);
    if (absent != 0) {  // what is left is stored row by row
      held &= ~absent, in_plane = false;
      e.layout = e.plane ? RowLayout::planar : RowLayout::dense;
    }
    for (int k = 0; k < link.row_count(); ++k)
      if ((held >> k & 1U) != 0) e.kind[e.m] = link.row_kind(k), e.own[e.m++] = k;
    if (e.m == 0) continue;
    const bool same_group = last == i - 1 && i > 0 && found.group[i] == found.group[i - 1];
    if (!same_group || table.entries.back().m != e.m || table.entries.back().layout != e.layout ||
        table.runs.back().in_plane != in_plane || table.runs.back().in_parts != (absent != 0))
      table.runs.push_back({entry, 0, i, in_plane, absent != 0});
    ++table.runs.back().n;
    last = i;
    table.entry_of_link[e.link] = entry;
    table.entries.push_back(e);
  }
  table.held = system.held_down_to();
  table.lay_out();
}

}  // namespace

void lay_out(const System& system, const std::vector<bool>& modes, RowTable& table, bool all) {
  lay_out_rows(system, modes, table, [&](const Lock& link) { return all ? 0U : system.left_out(link); });
}

void motions(const System& system, const State& state, std::vector<Motion>& out) {
  const int n = system.n_slots();
  if (state.coordinates) {
    check_count("motions, coordinates", state.q.size(), state.coordinates->n_q());
    check_count("motions, velocities", state.v.size(), state.coordinates->n_v());
    check_count("motions, bodies of the coordinates", state.coordinates->n_slots(), n);
  } else {
    check_count("motions, coordinates", state.q.size(), 7 * n);
    check_count("motions, velocities", state.v.size(), 6 * n);
  }
  out.resize(n + 1);  // the first is the ground, at rest
  if (state.coordinates) return state.coordinates->motions(state, out);
  for (int k = 0; k < n; ++k) read_motion(state, k, out[k + 1]);
}

void gather_rows(const System& system, const Inputs& in, RowTable& table) {
  const RowRun* now = nullptr;
  table.renew();
  try {
    for (const RowRun& run : table.runs) {
      now = &run;
      const Group links(system.found().ordered.data() + run.first_link, static_cast<std::size_t>(run.n));
      const RowEntry& first = table.entries[run.first_entry];
      if (!first.plane && !run.in_parts)
        links.front()->gather(links, in, table.span(first));
      else if (run.in_plane)
        links.front()->planar()->gather_plane(links, in, table.span(first));
      else
        for (int k = 0; k < run.n; ++k) gather_from_space(system, in, table, table.entries[run.first_entry + k]);
    }
  } catch (...) {
    rethrow_from_group(system, in, table, *now);
  }
}

void gather_forces(const System& system, const Inputs& in, VecX& f) {
  check_count("gather_forces, 6 per slot", f.size(), 6 * system.n_slots());
  for (int k = 0; k < system.n_slots(); ++k) {
    const Slot& b = system.slot(k);
    f.segment<3>(6 * k) = b.mass * system.gravity();
    if (b.freedoms == Freedoms::particle) {
      f.segment<3>(6 * k + 3).setZero();
    } else {
      const Vec3& w = in.slot(k).w;
      f.segment<3>(6 * k + 3) = cross(Vec3(b.J * w), w);  // (2.8): -w x J w
    }
  }
  WrenchSum sum(in.motions, f);
  const Force* now = nullptr;
  try {
    for (const auto& force : system.forces())
      if (now = force.get(); now->acts(in)) now->apply(in, sum);
  } catch (...) {
    rethrow_in(context_of(*now, in.t));
  }
  if (!system.forces().empty()) check_forces(system, in, f);
}

void check_forces(const System& system, const Inputs& in, const VecX& f) {
  check_count("check_forces, 6 per slot", f.size(), 6 * system.n_slots());
  check_particles(system, in, f);
  if (system.plane()) check_plane(system, in, f);
}

void state_rates(const System& system, const Evaluated& values, VecX& sd) {
  check_count("state_rates", sd.size(), system.n_states());
  int of_links = system.n_states() - CountedAngle::kStates * static_cast<int>(system.counted_angles().size());
  for (const auto& auxiliary : system.auxiliaries()) {
    named(*auxiliary, values.in.t, [&] { auxiliary->rates(values, part(sd, auxiliary->first(), auxiliary->size())); });
    of_links -= auxiliary->size();
  }
  for (const auto& link : system.links()) {
    if (of_links == 0) break;
    const int n = link->n_own_states();
    of_links -= n;
    if (n == 0) continue;
    const bool active = values.rows.entry_of_link[link->number()] >= 0;
    const std::span<double> rates = part(sd, link->first_state(), n);
    if (active)
      named(*link, values.in.t, [&] { link->stateful()->state_rates(values.in, rates); });
    else
      std::fill(rates.begin(), rates.end(), 0.0);  // restarted when the joint is activated
  }
  angle_rates(system, values.in, sd);
}

void angle_rates(const System& system, const Inputs& in, VecX& sd) {
  const auto& angles = system.counted_angles();
  if (angles.empty()) return;
  double* rate = sd.data() + angles.front()->first();
  for (std::size_t k = 0; k < angles.size(); ++k, rate += CountedAngle::kStates) {
    rate[1] = rate[2] = 0;
    if (k < in.angle_rates.size() && !std::isnan(in.angle_rates[k]))
      rate[0] = in.angle_rates[k];
    else
      named(*angles[k], in.t, [&] { rate[0] = angles[k]->rate(in); });
  }
}

void accept(const System& system, const Inputs& in, State& state) {
  check_count("accept, remembered", state.z.size(), system.n_memory());
  for (const auto& angle : system.counted_angles()) named(*angle, in.t, [&] { angle->accept(in, state.s); });
  for (const auto& link : system.links())
    if (const int n = link->n_own_memory(); n > 0)
      named(*link, in.t, [&] { link->remembering()->accept_step(in, part(state.z, link->first_memory(), n)); });
  for (const auto& force : system.forces())
    if (const Remembering* own = force->remembering())
      named(*force, in.t, [&] { own->accept_step(in, part(state.z, force->first_memory(), own->n_memory())); });
}

std::vector<double> breakpoints(const System& system, double t0, double t1) {
  std::vector<double> times;
  breakpoints(system, t0, t1, times);
  return times;
}

void breakpoints(const System& system, double t0, double t1, std::vector<double>& times) {
  times.clear();
  for (const auto& link : system.links())
    if (const Driven* driven = link->driven()) named(*link, t0, [&] { driven->breakpoints(t0, t1, times); });
  for (const auto& force : system.forces()) named(*force, t0, [&] { force->breakpoints(t0, t1, times); });
  std::erase_if(times, [&](double t) { return !(t > t0 && t < t1); });
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
}

std::string row_name(const System& system, const RowTable& table, int row) {
  for (const RowEntry& e : table.entries)
    if (row >= e.first_row && row < e.first_row + e.m) {
      const Lock& link = *system.links()[e.link];
      return "constraint " + link.row_name(e.own[row - e.first_row]) + " of joint '" + link.name() + "'";
    }
  return "constraint " + std::to_string(row);
}

}  // namespace lockstep::passes

void lockstep::lay_out_without(std::span<const unsigned> absent, const System& system, const std::vector<bool>& modes,
                               RowTable& table) {
  passes::lay_out_rows(system, modes, table,
                       [&](const Lock& link) { return absent[static_cast<std::size_t>(link.number())]; });
}
