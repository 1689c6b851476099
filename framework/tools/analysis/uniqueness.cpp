#include <lockstep/uniqueness.h>

#include <algorithm>
#include <span>
#include <utility>

#include "framework/dynamics/evaluate/row_space.h"
#include "framework/tools/analysis/loop_rows.h"

namespace lockstep {
namespace {

/// Vectors of multipliers that change no motion, loop by loop; of unit size where rows have length 1.
class Undetermined {
 public:
  Undetermined(const System& system, const RowTable& table) : numbers_(static_cast<std::size_t>(table.n_rows)) {
    for (const std::vector<int>& entries : loops_of(system, table)) {
      const LoopRows rows(system, table, entries);
      const double limit = leaves_near_rows_out(system, table, entries) ? kNearlyDependent : kDependent;
      const Dependencies found(rows.Jt, limit);
      if (found.circuits.cols() == 0) continue;
      n += rows.n() - found.rank;
      round_off = std::max(round_off, found.round_off);
      for (int k = 0; k < rows.n(); ++k)
        numbers_[static_cast<std::size_t>(rows.numbers[static_cast<std::size_t>(k)])] = found.circuits.row(k);
    }
  }

  int n = 0;             ///< how many there are
  double round_off = 0;  ///< numbers up to this are zero

  /// The numbers of a row, one for each vector of its loop.
  const VecX& numbers(int row) const { return numbers_[static_cast<std::size_t>(row)]; }

 private:
  // Whether rows of it were left out that depend on others nearly: how those that stay and those that went would share a
  // load is not known.
  static bool leaves_near_rows_out(const System& system, const RowTable& table, const std::vector<int>& entries) {
    if (system.held_down_to() > 0) return false;  // those hold
    return std::ranges::any_of(entries, [&](int k) {
      const RowEntry& e = table.entries[static_cast<std::size_t>(k)];
      return system.left_out(*system.links()[static_cast<std::size_t>(e.link)]) != 0;
    });
  }

  std::vector<VecX> numbers_;
};

/// Largest absolute value of each component over the vectors.
struct Largest {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  void take(const Vec3& f, const Vec3& m) {
    force = force.cwiseMax(f.cwiseAbs()), moment = moment.cwiseMax(m.cwiseAbs());
  }
};

class Components {
 public:
  Components(const System& system, const Inputs& in, const RowTable& table, const Undetermined& u,
             std::vector<std::string>& channels)
      : system_(system), in_(in), table_(table), u_(u), channels_(channels), lambda_(VecX::Zero(table.n_rows)) {}

  void of(const Lock& link) {
    add(link, "", Reactions::kJoint);
    const Driven* driven = link.driven();
    const int n = driven != nullptr ? driven->n_drives() : 0;
    if (n == 0) return;
    add(link, "drive.", Reactions::kDrives);
    for (int d = 0; d < n; ++d) add(link, "drive_" + driven->drive(d).name + ".", d);
  }

 private:
  void add(const Lock& link, const std::string& part_name, int part) {
    const auto [p, s] = link.pairs().front();
    const Mat3 to_link = in_world(MarkerFrame(*s), in_).A.transpose();
    Largest world, local, other;
    double power = 0;
    const RowEntry& e = entry(link);
    const Reactions reactions(table_, {lambda_.data(), static_cast<std::size_t>(lambda_.size())});
    for (Eigen::Index column = 0; column < u_.numbers(e.first_row).size(); ++column) {
      for (int k = 0; k < e.m; ++k)
        lambda_[e.first_row + k] = u_.numbers(e.first_row + k)[column];  // others are not read
      const LinkWrench on_p = reactions.on_body_of(MarkerFrame(*p), link, in_, part),
                       on_s = reactions.on_body_of(MarkerFrame(*s), link, in_, part);
      world.take(on_p.force, on_p.moment), other.take(on_s.force, on_s.moment);
      local.take(to_link * on_p.force, to_link * on_p.moment);
      power = std::max(power, std::abs(power_of(link, e, part)));
    }
    const std::string start = link.name() + "." + part_name;
    add_axes(start + "force_on_p_world_", world.force, 1), add_axes(start + "force_on_p_link_", local.force, 1);
    const double length = system_.length();
    add_axes(start + "torque_on_p_world_", world.moment, length);
    add_axes(start + "torque_on_p_link_", local.moment, length);
    add_axes(start + "force_on_s_world_", other.force, 1), add_axes(start + "torque_on_s_world_", other.moment, length);
    if (part != Reactions::kJoint && power > u_.round_off)
      channels_.push_back(start + "power"), channels_.push_back(start + "work");
  }

  // (8.8) lambda . Ct over the rows of the drive
  double power_of(const Lock& link, const RowEntry& e, int part) const {
    double power = 0;
    for (int k = 0; k < e.m; ++k)
      if (Reactions::belongs(link.row(e.own[static_cast<std::size_t>(k)]), part))
        power += lambda_[e.first_row + k] * table_.block(e).Ct(k);
    return power;
  }
  const RowEntry& entry(const Lock& link) const {
    const int at = table_.entry_of_link[static_cast<std::size_t>(link.number())];
    return table_.entries[static_cast<std::size_t>(at)];
  }

  void add_axes(const std::string& name, const Vec3& largest, double unit) {
    for (int i = 0; i < 3; ++i)
      if (largest[i] > u_.round_off * unit) channels_.push_back(name + "xyz"[i]);
  }

  const System& system_;
  const Inputs& in_;
  const RowTable& table_;
  const Undetermined& u_;
  std::vector<std::string>& channels_;
  VecX lambda_;
};

}  // namespace

bool UniquenessReport::unique(const std::string& channel) const {
  return std::ranges::find(channels, channel) == channels.end();
}

UniquenessReport uniqueness(Dynamics& dynamics, const State& state) {
  const Evaluation& e = dynamics.gather_rows(state);
  const System& system = dynamics.system();
  RowTable all;  // with rows that were left out: they would take a share
  const bool any_left_out =
      std::ranges::any_of(system.links(), [&](const auto& link) { return system.left_out(*link) != 0; });
  if (any_left_out) system.lay_out(state.modes, all, true), system.gather_rows(e.inputs(), all);
  const RowTable& table = any_left_out ? all : e.rows();
  const Undetermined u(system, table);
  UniquenessReport report;
  report.undetermined = u.n;
  if (u.n == 0) return report;
  Components components(system, e.inputs(), table, u, report.channels);
  for (const auto& link : system.links()) {
    if (table.entry_of_link[static_cast<std::size_t>(link->number())] < 0 || link->pairs().empty()) continue;
    components.of(*link);
  }
  for (int row = 0; row < table.n_rows; ++row) {
    if (u.numbers(row).size() == 0 || u.numbers(row).lpNorm<Eigen::Infinity>() <= u.round_off) continue;
    const NamedRow named(system, table, row);
    report.rows.push_back(named.name());
    report.channels.push_back(named.link->name() + ".lambda_" + std::string(named.link->row_name(named.own)));
  }
  return report;
}

}  // namespace lockstep
