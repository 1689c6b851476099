// The passes over the mechanism: slots -> links -> forces. Each reads the arrays that the pass before it filled.
#include <algorithm>

#include "framework/support/error.h"
#include "framework/system/system.h"

namespace lockstep {
namespace {

std::span<double> part(VecX& x, int first, int size) { return {x.data() + first, static_cast<std::size_t>(size)}; }

}  // namespace

void System::lay_out(const std::vector<bool>& modes, RowTable& table) const {
  table.entries.clear();
  table.runs.clear();
  table.entry_of_link.assign(links_.size(), -1);
  int last = -2;
  for (int i = 0; i < static_cast<int>(ordered_.size()); ++i) {
    const Lock& link = *ordered_[static_cast<std::size_t>(i)];
    if (!modes[static_cast<std::size_t>(link.number())]) continue;
    const int entry = static_cast<int>(table.entries.size());
    const bool same_run =
        last == i - 1 && i > 0 && group_[static_cast<std::size_t>(i)] == group_[static_cast<std::size_t>(i - 1)];
    if (!same_run) table.runs.push_back({entry, 0, i});
    ++table.runs.back().n;
    last = i;
    RowEntry e;
    e.link = link.number();
    e.m = link.row_count();
    e.slots = link.slots();
    e.layout = link.layout();
    e.sign = link.row_sign();
    for (int k = 0; k < e.m; ++k) e.kind[static_cast<std::size_t>(k)] = link.row_kind(k);
    table.entry_of_link[static_cast<std::size_t>(e.link)] = entry;
    table.entries.push_back(e);
  }
  table.lay_out();
}

void System::motions(const State& state, std::vector<Motion>& out) const {
  out.resize(static_cast<std::size_t>(n_slots() + 1));  // the first is the ground, at rest
  for (int k = 0; k < n_slots(); ++k) {
    Motion& O = out[static_cast<std::size_t>(k + 1)];
    O.x = state.q.segment<3>(7 * k);
    O.e = normalized(Quat::from(state.q.segment<4>(7 * k + 3)));
    O.A = rotation(O.e);
    O.v = state.v.segment<3>(6 * k);
    O.w = state.v.segment<3>(6 * k + 3);
  }
}

void System::gather_rows(const Inputs& in, RowTable& table) const {
  for (const RowRun& run : table.runs) {
    const Group links(ordered_.data() + run.first_link, static_cast<std::size_t>(run.n));
    links.front()->gather(links, in, table.span(table.entries[static_cast<std::size_t>(run.first_entry)]));
  }
}

void System::gather_forces(const Inputs& in, VecX& f) const {
  for (int k = 0; k < n_slots(); ++k) {
    const Body& b = body_of_slot(k);
    f.segment<3>(6 * k) = b.mass.mass * options_.gravity;
    if (b.freedoms == Freedoms::particle) {
      f.segment<3>(6 * k + 3).setZero();
    } else {
      const Vec3& w = in.slot(k).w;
      f.segment<3>(6 * k + 3) = cross(Vec3(b.mass.J * w), w);  // (2.8): -w x J w
    }
  }
  WrenchSum sum(in.motions, f);
  for (const auto& force : forces_) force->apply(in, sum);
}

void System::state_rates(const Evaluated& values, VecX& sd) const {
  for (const auto& link : links_) {
    if (link->n_states() == 0) continue;
    const bool active = values.rows.entry_of_link[static_cast<std::size_t>(link->number())] >= 0;
    const std::span<double> rates = part(sd, link->first_state(), link->n_states());
    if (active)
      link->state_rates(values.in, rates);
    else
      std::fill(rates.begin(), rates.end(), 0.0);  // begun anew when the link comes into force
  }
  for (const auto& auxiliary : auxiliaries_) auxiliary->rates(values, part(sd, auxiliary->first(), auxiliary->size()));
}

void System::accept(const Inputs& in, State& state) const {
  for (const auto& link : links_)
    if (link->n_memory() > 0) link->accept(in, part(state.z, link->first_memory(), link->n_memory()));
  for (const auto& force : forces_)
    if (force->n_memory() > 0) force->accept(in, part(state.z, force->first_memory(), force->n_memory()));
}

std::vector<double> System::breakpoints(double t0, double t1) const {
  std::vector<double> times;
  for (const auto& link : links_) link->breakpoints(t0, t1, times);
  for (const auto& force : forces_) force->breakpoints(t0, t1, times);
  std::erase_if(times, [&](double t) { return !(t > t0 && t < t1); });
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

std::string System::row_name(const RowTable& table, int row) const {
  for (const RowEntry& e : table.entries)
    if (row >= e.first_row && row < e.first_row + e.m) {
      const Lock& link = *links_[static_cast<std::size_t>(e.link)];
      return "row " + link.row_name(row - e.first_row) + " of link '" + link.name() + "'";
    }
  return "row " + std::to_string(row);
}

}  // namespace lockstep
