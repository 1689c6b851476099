// SPDX-License-Identifier: BSD-3-Clause
// The passes over the mechanism: slots -> links -> forces. Each reads the arrays filled by the pass before.
#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include <lockstep/system.h>
#include <lockstep/text.h>
#include "framework/foundation/math/limits.h"
#include "framework/mechanism/model/read_motion.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {
namespace {

// A particle takes no moment: whoever exerts one on it is refused. `f`: the sums of all forces.
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
  VecX one(f.size());
  for (const auto& force : system.forces()) {
    if (!force->acts(in)) continue;
    one.setZero();
    WrenchSum sum(in.motions, one);
    named(*force, in.t, [&] { force->apply(in, sum); });
    const int k = turned(one);
    if (k < 0) continue;
    throw ModelError(at_time(in.t) + "force '" + force->name() + "' exerts a moment of " +
                         text::brief(one.segment<3>(6 * k + 3).norm()) + " N m on body '" +
                         system.body_of_slot(k).name +
                         "', which is a particle and cannot turn; give it an inertia, or push at its point",
                     {.thing = thing_of(*force), .t = in.t});
  }
}

// Takes rows out of an entry; what is left is stored row by row.
void keep_rows(unsigned absent, RowEntry& e) {
  int kept = 0;
  for (int k = 0; k < e.m; ++k) {
    const int own = e.own[k];
    if ((absent >> own & 1U) == 0) e.own[kept++] = own;
  }
  e.m = kept;
  e.layout = e.plane ? RowLayout::planar : RowLayout::dense;
}

std::span<double> part(VecX& x, int first, int size) { return {x.data() + first, static_cast<std::size_t>(size)}; }

// Numbers of another count would be written past.
void check_count(const char* what, Eigen::Index found, Eigen::Index needed) {
  if (found == needed) return;
  throw ModelError(std::string("System::") + what + ": " + std::to_string(found) + " numbers where " +
                   std::to_string(needed) + " are needed; size them by System::start()");
}

}  // namespace

void System::lay_out(const std::vector<bool>& modes, RowTable& table, bool all) const {
  check_count("lay_out, one per link", static_cast<Eigen::Index>(modes.size()),
              static_cast<Eigen::Index>(links_.size()));
  table.entries.clear();
  table.runs.clear();
  table.entry_of_link.assign(links_.size(), -1);
  table.entries.reserve(std::ranges::count(modes, true));
  int last = -2;
  for (int i = 0; i < static_cast<int>(ordered_.size()); ++i) {
    const Lock& link = *ordered_[i];
    if (!modes[link.number()]) continue;
    const int entry = static_cast<int>(table.entries.size());
    RowEntry e;
    e.link = link.number();
    e.m = link.row_count();
    e.slots = link.slots();
    e.layout = link.layout();
    e.sign = link.shape().sign;
    bool in_plane = false;
    if (plane_) {
      const PlanarRows& rows = planar_rows_[link.number()];
      if (rows.m == 0) continue;  // all its rows lie outside the plane
      e.m = rows.m, e.plane = plane_, std::ranges::copy(rows.own, e.own.begin());
      in_plane = rows.by_link;
      e.layout = in_plane ? link.planar()->planar_layout() : RowLayout::planar;
    }
    const unsigned absent = all ? 0U : left_out(link);
    if (absent != 0) {
      keep_rows(absent, e);
      if (e.m == 0) continue;
      in_plane = false;
    }
    for (int k = 0; k < e.m; ++k) e.kind[k] = link.row_kind(e.own[k]);
    const bool same_group = last == i - 1 && i > 0 && group_[i] == group_[i - 1];
    if (!same_group || table.entries.back().m != e.m || table.entries.back().layout != e.layout ||
        table.runs.back().in_plane != in_plane || table.runs.back().in_parts != (absent != 0))
      table.runs.push_back({entry, 0, i, in_plane, absent != 0});
    ++table.runs.back().n;
    last = i;
    table.entry_of_link[e.link] = entry;
    table.entries.push_back(e);
  }
  table.held = held_;
  table.lay_out();
}

void System::leave_out(const Lock& link, unsigned rows) {
  const auto k = static_cast<std::size_t>(link.number());
  if (link.number() < 0 || k >= links_.size() || links_[k].get() != &link || rows >> link.row_count() != 0)
    throw ModelError("link '" + link.name() + "': rows to be left out are not its own, or the system is not set up",
                     {.thing = thing_of(link)});
  left_out_.resize(links_.size(), 0U);
  left_out_[k] = rows;
  ready_ = false;
}

void System::motions(const State& state, std::vector<Motion>& out) const {
  if (state.coordinates) {
    check_count("motions, coordinates", state.q.size(), state.coordinates->n_q());
    check_count("motions, velocities", state.v.size(), state.coordinates->n_v());
    check_count("motions, bodies of the coordinates", state.coordinates->n_slots(), n_slots());
  } else {
    check_count("motions, coordinates", state.q.size(), 7 * n_slots());
    check_count("motions, velocities", state.v.size(), 6 * n_slots());
  }
  out.resize(n_slots() + 1);  // the first is the ground, at rest
  if (state.coordinates) return state.coordinates->motions(state, out);
  for (int k = 0; k < n_slots(); ++k) read_motion(state, k, out[k + 1]);
}

void System::gather_rows(const Inputs& in, RowTable& table) const {
  const RowRun* now = nullptr;
  table.renew();
  try {
    for (const RowRun& run : table.runs) {
      now = &run;
      const Group links(ordered_.data() + run.first_link, static_cast<std::size_t>(run.n));
      const RowEntry& first = table.entries[run.first_entry];
      if (!plane_ && !run.in_parts)
        links.front()->gather(links, in, table.span(first));
      else if (run.in_plane)
        links.front()->planar()->gather_plane(links, in, table.span(first));
      else
        for (int k = 0; k < run.n; ++k) gather_from_space(in, table, run.first_entry + k);
    }
  } catch (...) {
    rethrow_from_group(*this, in, table, *now);
  }
}

// A row that is left out must demand nothing: of a motion out of the plane, or of one that rows on which it depends hold.
void System::check_absent_row(const Inputs& in, const Lock& link, int k, const RowView& all) const {
  if ((left_out(link) >> k & 1U) != 0) {
    constexpr double kMost = 1e-2;
    const double x = std::abs(all.C(k)), limit = kMost * (link.row_kind(k) == RowKind::translation ? length_ : 1.0);
    if (x <= limit) return;
    throw ModelError(
        "link '" + link.name() + "', row " + link.row_name(k) +
            ": was left out at the start, since it depended on others, exactly or nearly, and is violated by " +
            text::brief(x) + " (limit " + text::brief(limit) + ") at t = " + text::number(in.t) +
            " s; set \"nearly_redundant\" of \"run\" to \"held\" or \"told\", or build it otherwise",
        {.thing = thing_of(link), .t = in.t});
  }
  const double x = std::max({std::abs(all.C(k)), std::abs(all.Ct(k)), std::abs(all.Qhat(k))});
  if (plane_ && x > 1e-8 * std::max(1.0, length_))
    throw ModelError("link '" + link.name() + "', row " + link.row_name(k) + ": asks for a motion out of the plane (" +
                         text::brief(x) + ") at t = " + text::number(in.t) +
                         " s, and the scene is planar; set \"planar\" to \"off\"",
                     {.thing = thing_of(link), .t = in.t});
}

// For a link without planar rows, or some of whose rows are left out: gathers in space and copies what holds.
void System::gather_from_space(const Inputs& in, RowTable& table, int entry) const {
  const RowEntry& e = table.entries[entry];
  const Lock* link = links_[e.link].get();
  const RowShape shape = link->shape();
  link->gather(Group(&link, 1), in, table.spatial_span(shape));
  const RowBlock all = table.spatial(shape), block = table.block(e);
  for (int k = 0, next = 0; k < all.rows(); ++k)
    if (next < e.m && e.own[next] == k)
      ++next;
    else
      check_absent_row(in, *link, k, all);
  for (int k = 0; k < e.m; ++k) {
    const int own = e.own[k];
    block.C(k) = all.C(own), block.Ct(k) = all.Ct(own), block.Qhat(k) = all.Qhat(own);
    for (int i = 0; i < e.slots.n; ++i) {
      const auto r = all.J(i, own);
      block.set(i, k, std::array{r[0], r[1], r[2]}, std::array{r[3], r[4], r[5]});
    }
  }
}

void System::gather_forces(const Inputs& in, VecX& f) const {
  check_count("gather_forces, 6 per slot", f.size(), 6 * n_slots());
  for (int k = 0; k < n_slots(); ++k) {
    const Slot& b = slot(k);
    f.segment<3>(6 * k) = b.mass * options_.gravity;
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
    for (const auto& force : forces_)
      if (now = force.get(); now->acts(in)) now->apply(in, sum);
  } catch (...) {
    rethrow_in(context_of(*now, in.t));
  }
  if (!forces_.empty()) check_forces(in, f);
}

void System::check_forces(const Inputs& in, const VecX& f) const {
  check_count("check_forces, 6 per slot", f.size(), 6 * n_slots());
  check_particles(*this, in, f);
  if (plane_) check_plane(in, f);
}

// Throws if a force has left the plane since setup. What leaves it is round-off beside forces and weights in it.
void System::check_plane(const Inputs& in, const VecX& f) const {
  double inside = 0, outside = 0;
  for (int k = 0; k < n_slots(); ++k) {
    inside = std::max({inside, std::abs(f[6 * k + plane_.i()]), std::abs(f[6 * k + plane_.j()]),
                       slot(k).mass * options_.gravity.norm()});
    outside = std::max(outside, std::abs(f[6 * k + plane_.n]));
  }
  if (!(outside > kNegligible * inside)) return;
  VecX one(f.size());
  for (const auto& force : forces_) {
    if (!force->acts(in)) continue;
    one.setZero();
    WrenchSum sum(in.motions, one);
    named(*force, in.t, [&] { force->apply(in, sum); });
    for (int k = 0; k < n_slots(); ++k)
      if (const double out = std::abs(one[6 * k + plane_.n]); out > 0.5 * kNegligible * inside)
        throw ModelError("force '" + force->name() + "' pushes out of the plane with " + text::brief(out) +
                             " N at t = " + text::number(in.t) +
                             " s, and the scene is planar; set \"planar\" to \"off\"",
                         {.thing = thing_of(*force), .t = in.t});
  }
}

void System::state_rates(const Evaluated& values, VecX& sd) const {
  check_count("state_rates", sd.size(), n_states_);
  int of_links = n_states_ - CountedAngle::kStates * static_cast<int>(angles_.size());
  for (const auto& auxiliary : auxiliaries_) {
    named(*auxiliary, values.in.t, [&] { auxiliary->rates(values, part(sd, auxiliary->first(), auxiliary->size())); });
    of_links -= auxiliary->size();
  }
  for (const auto& link : links_) {
    if (of_links == 0) break;
    const int n = link->n_own_states();
    of_links -= n;
    if (n == 0) continue;
    const bool active = values.rows.entry_of_link[link->number()] >= 0;
    const std::span<double> rates = part(sd, link->first_state(), n);
    if (active)
      named(*link, values.in.t, [&] { link->stateful()->state_rates(values.in, rates); });
    else
      std::fill(rates.begin(), rates.end(), 0.0);  // restarted when the link is activated
  }
  angle_rates(values.in, sd);
}

void System::angle_rates(const Inputs& in, VecX& sd) const {
  if (angles_.empty()) return;
  double* rate = sd.data() + angles_.front()->first();
  for (std::size_t k = 0; k < angles_.size(); ++k, rate += CountedAngle::kStates) {
    rate[1] = rate[2] = 0;
    if (k < in.angle_rates.size() && !std::isnan(in.angle_rates[k]))
      rate[0] = in.angle_rates[k];
    else
      named(*angles_[k], in.t, [&] { rate[0] = angles_[k]->rate(in); });
  }
}

void System::accept(const Inputs& in, State& state) const {
  check_count("accept, remembered", state.z.size(), n_memory_);
  for (const auto& angle : angles_) named(*angle, in.t, [&] { angle->accept(in, state.s); });
  for (const auto& link : links_)
    if (const int n = link->n_own_memory(); n > 0)
      named(*link, in.t, [&] { link->remembering()->accept_step(in, part(state.z, link->first_memory(), n)); });
  for (const auto& force : forces_)
    if (const Remembering* own = force->remembering())
      named(*force, in.t, [&] { own->accept_step(in, part(state.z, force->first_memory(), own->n_memory())); });
}

std::vector<double> System::breakpoints(double t0, double t1) const {
  std::vector<double> times;
  breakpoints(t0, t1, times);
  return times;
}

void System::breakpoints(double t0, double t1, std::vector<double>& times) const {
  times.clear();
  for (const auto& link : links_)
    if (const Driven* driven = link->driven()) named(*link, t0, [&] { driven->breakpoints(t0, t1, times); });
  for (const auto& force : forces_) named(*force, t0, [&] { force->breakpoints(t0, t1, times); });
  std::erase_if(times, [&](double t) { return !(t > t0 && t < t1); });
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
}

std::string System::row_name(const RowTable& table, int row) const {
  for (const RowEntry& e : table.entries)
    if (row >= e.first_row && row < e.first_row + e.m) {
      const Lock& link = *links_[e.link];
      return "row " + link.row_name(e.own[row - e.first_row]) + " of link '" + link.name() + "'";
    }
  return "row " + std::to_string(row);
}

}  // namespace lockstep
