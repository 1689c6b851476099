// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/analysis.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "framework/dynamics/evaluate/row_space.h"
#include "framework/foundation/support/thrown.h"
#include "framework/mechanism/system/diagnose.h"
#include "framework/tools/rank/loop_rows.h"
#include "framework/tools/record/channel_entry.h"

namespace lockstep {
namespace {

// Numbers that do not cancel one another.
VecX some_numbers(Eigen::Index n) { return VecX::LinSpaced(n, 1, kPi); }

/// Vectors of multipliers that change no motion, loop by loop; of unit size where rows have length 1.
class Undetermined {
 public:
  Undetermined(const System& system, const RowTable& table)
      : share(VecX::Zero(table.n_rows)), numbers_(static_cast<std::size_t>(table.n_rows)) {
    for (const std::vector<int>& entries : loops_of(system, table)) {
      const LoopRows rows(system, table, entries);
      const Dependencies found(rows.Jt, leaves_near_rows_out(system, table, entries) ? kNearlyDependent : kDependent);
      if (found.circuits.cols() == 0) continue;
      n += rows.n() - found.rank;
      round_off = std::max(round_off, found.round_off);
      for (int k = 0; k < rows.n(); ++k) numbers_[rows.numbers[k]] = found.circuits.row(k);
      const MatX parts = (found.circuits.array().abs() > found.round_off).select(found.circuits, 0);
      share(rows.numbers) = parts * some_numbers(parts.cols());
    }
  }

  int n = 0;             ///< how many there are
  double round_off = 0;  ///< numbers up to this are zero
  VecX share;            ///< one vector that has a part of each

  /// The numbers of a row, one for each vector of its loop.
  const VecX& numbers(int row) const { return numbers_[row]; }

 private:
  // Whether rows of it were left out that depend on others nearly: how those that stay and those that went would share a
  // load is not known.
  static bool leaves_near_rows_out(const System& system, const RowTable& table, const std::vector<int>& entries) {
    if (system.held_down_to() > 0) return false;  // those hold
    return std::ranges::any_of(entries,
                               [&](int k) { return system.left_out(*system.links()[table.entries[k].link]) != 0; });
  }

  std::vector<VecX> numbers_;
};

/// Adds the channels of a link that some vector of multipliers changes.
void add_channels_of(const Lock& link, const System& system, const Inputs& in, const RowTable& table,
                     const Undetermined& u, std::vector<std::string>& names) {
  const auto& vectors = channels::kReactionVectors;
  const auto [p, s] = link.pairs().front();
  const RowEntry& e = *channels::entry_of(link, table);
  VecX lambda = VecX::Zero(table.n_rows);
  const Reactions reactions(table, {lambda.data(), static_cast<std::size_t>(lambda.size())});
  for (const auto& [prefix, by, part] : channels::parts_of(link)) {
    const std::string start = link.name() + "." + prefix;
    std::array<Vec3, std::size(channels::kReactionVectors)> largest;
    largest.fill(Vec3::Zero());
    double power = 0;
    for (Eigen::Index column = 0; column < u.numbers(e.first_row).size(); ++column) {
      for (int k = 0; k < e.m; ++k)
        lambda[e.first_row + k] = u.numbers(e.first_row + k)[column];  // others are not read
      for (std::size_t i = 0; i < largest.size(); ++i) {
        const LinkWrench wrench = reactions.on_body_of(MarkerFrame(vectors[i].on_p ? *p : *s), link, in, part);
        largest[i] = largest[i].cwiseMax(vectors[i].of(wrench, *s, in).cwiseAbs());
      }
      power = std::max(power, std::abs(channels::power_of_part(link, part, table, lambda)));
    }
    for (std::size_t i = 0; i < largest.size(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        if (largest[i][axis] > u.round_off * (vectors[i].force ? 1 : system.length()))
          names.push_back(start + vectors[i].name + channels::kAxisName[axis]);
    if (part != Reactions::kJoint && power > u.round_off)
      for (const char* name : {"power", "work"}) names.push_back(start + name);
  }
}

// Adds the forces whose load by some multipliers is another with a share on top of them.
void add_readers(const System& system, const Inputs& in, const RowTable& t, const VecX& share, UniquenessReport& out) {
  const auto load = [&](const Force& force, const VecX& lambda) {
    const Reactions reactions(t, {lambda.data(), static_cast<std::size_t>(lambda.size())});
    return wrench_of(system, in, force, &reactions);
  };
  const VecX one = VecX::Ones(share.size()), other = one + share;
  for (const auto& force : system.forces())
    for (const Lock* read : force->reacting() ? force->reacting()->reads() : std::vector<const Lock*>())
      if (const RowEntry* e = channels::entry_of(*read, t); e && !share.segment(e->first_row, e->m).isZero(0))
        if (VecX a, b; succeeds([&] { a = load(*force, one), b = load(*force, other); }) &&
                       (b - a).norm() > kNegligible * b.norm())
          out.readers.push_back("force '" + force->name() + "' (joint " + read->name() + ")");
}

}  // namespace

bool UniquenessReport::unique(const std::string& channel) const {
  return std::ranges::find(channels, channel) == channels.end();
}

UniquenessReport uniqueness(Dynamics& dynamics, const State& state) {
  const System& system = dynamics.system();
  State moving = dynamics.in_slots(state);  // no row depends on velocities, but friction does
  moving.v = some_numbers(moving.v.size());
  for (const auto& force : system.forces())
    if (force->switch_memory() >= 0) moving.z[force->switch_memory()] = 1;  // an event may do so later
  const Evaluation& e = dynamics.gather_rows(moving);
  RowTable room;
  const RowTable& table = all_rows(e, moving, room);  // those that were left out would take a share
  const Undetermined u(system, table);
  UniquenessReport report;
  report.undetermined = u.n;
  if (u.n == 0) return report;
  for (const auto& link : system.links()) {
    if (table.entry_of_link[link->number()] < 0 || link->pairs().empty()) continue;
    add_channels_of(*link, system, e.inputs(), table, u, report.channels);
  }
  for (int row = 0; row < table.n_rows; ++row) {
    if (u.numbers(row).size() == 0 || u.numbers(row).lpNorm<Eigen::Infinity>() <= u.round_off) continue;
    const NamedRow named(system, table, row);
    report.rows.push_back(named.name());
    report.channels.push_back(named.link->name() + ".lambda_" + std::string(named.link->row_name(named.own)));
  }
  add_readers(system, e.inputs(), table, u.share, report);
  return report;
}

}  // namespace lockstep
