#include <lockstep/uniqueness.h>

#include <algorithm>
#include <span>

#include "framework/tools/analysis/loop_rows.h"

namespace lockstep {
namespace {

/// Vectors of multipliers that change no motion, one a column and one number a row of the table; of unit size where
/// rows have length 1.
struct Undetermined {
  int n = 0;
  MatX vectors;
  double round_off = 0;
};

Undetermined undetermined_of(const System& system, const RowTable& table) {
  Undetermined found;
  std::vector<VecX> vectors;
  for (const std::vector<int>& entries : loops_of(system, table)) {
    const LoopRows rows(system, table, entries);
    const NullVectors null = null_vectors(rows.n_columns(), rows.n(), rows.Jt());
    if (null.columns.cols() == 0) continue;
    found.n += rows.n() - find_dependencies(rows.n_columns(), rows.n(), rows.Jt()).rank;
    found.round_off = std::max(found.round_off, null.round_off);
    for (const auto column : null.columns.colwise()) {
      VecX lambda = VecX::Zero(table.n_rows);
      for (int k = 0; k < rows.n(); ++k)
        lambda[rows.number(k)] = rows.length(k) > 0 ? column[k] / rows.length(k) : 1.0;  // a row of zeros holds nothing
      vectors.push_back(std::move(lambda));
    }
  }
  found.vectors = MatX(table.n_rows, static_cast<Eigen::Index>(vectors.size()));
  for (std::size_t k = 0; k < vectors.size(); ++k) found.vectors.col(static_cast<Eigen::Index>(k)) = vectors[k];
  return found;
}

/// Largest absolute value of each component over the vectors.
struct Largest {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  void take(const Vec3& f, const Vec3& m) {
    force = force.cwiseMax(f.cwiseAbs()), moment = moment.cwiseMax(m.cwiseAbs());
  }
};

class Components {
 public:
  Components(const Evaluation& e, const Undetermined& u, std::vector<std::string>& channels)
      : e_(e), u_(u), channels_(channels) {}

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
    const Inputs& in = e_.inputs();
    const Mat3 to_link = in_world(MarkerFrame(*s), in).A.transpose();
    Largest world, local, other;
    double power = 0;
    for (const auto column : u_.vectors.colwise()) {
      const VecX lambda = column;
      const Reactions reactions(e_.rows(), {lambda.data(), static_cast<std::size_t>(lambda.size())});
      const LinkWrench on_p = reactions.on_body_of(MarkerFrame(*p), link, in, part),
                       on_s = reactions.on_body_of(MarkerFrame(*s), link, in, part);
      world.take(on_p.force, on_p.moment), other.take(on_s.force, on_s.moment);
      local.take(to_link * on_p.force, to_link * on_p.moment);
      power = std::max(power, std::abs(power_of(link, lambda, part)));
    }
    const std::string start = link.name() + "." + part_name;
    add_axes(start + "force_on_p_world_", world.force, 1), add_axes(start + "force_on_p_link_", local.force, 1);
    const double length = e_.system().length();
    add_axes(start + "torque_on_p_world_", world.moment, length);
    add_axes(start + "torque_on_p_link_", local.moment, length);
    add_axes(start + "force_on_s_world_", other.force, 1), add_axes(start + "torque_on_s_world_", other.moment, length);
    if (part != Reactions::kJoint && power > u_.round_off)
      channels_.push_back(start + "power"), channels_.push_back(start + "work");
  }

  // (8.8) lambda . Ct over the rows of the drive
  double power_of(const Lock& link, const VecX& lambda, int part) const {
    const int at = e_.rows().entry_of_link[static_cast<std::size_t>(link.number())];
    if (at < 0) return 0;
    const RowEntry& e = e_.rows().entries[static_cast<std::size_t>(at)];
    double power = 0;
    for (int k = 0; k < e.m; ++k)
      if (Reactions::belongs(link.row(e.own[static_cast<std::size_t>(k)]), part))
        power += lambda[e.first_row + k] * e_.rows().block(e).Ct(k);
    return power;
  }

  void add_axes(const std::string& name, const Vec3& largest, double unit) {
    for (int i = 0; i < 3; ++i)
      if (largest[i] > u_.round_off * unit) channels_.push_back(name + "xyz"[i]);
  }

  const Evaluation& e_;
  const Undetermined& u_;
  std::vector<std::string>& channels_;
};

}  // namespace

bool UniquenessReport::unique(const std::string& channel) const {
  return std::ranges::find(channels, channel) == channels.end();
}

UniquenessReport uniqueness(Dynamics& dynamics, const State& state) {
  const Evaluation& e = dynamics.gather(state);
  const System& system = dynamics.system();
  const Undetermined u = undetermined_of(system, e.rows());
  UniquenessReport report;
  report.undetermined = u.n;
  if (u.n == 0) return report;
  Components components(e, u, report.channels);
  for (const auto& link : system.links()) {
    if (e.rows().entry_of_link[static_cast<std::size_t>(link->number())] < 0 || link->pairs().empty()) continue;
    components.of(*link);
  }
  for (int row = 0; row < e.rows().n_rows; ++row) {
    if (u.vectors.row(row).cwiseAbs().maxCoeff() <= u.round_off) continue;
    const std::string name = name_of_row(system, e.rows(), row);
    report.rows.push_back(name);
    const std::size_t dot = name.rfind('.');
    report.channels.push_back(name.substr(0, dot) + ".lambda_" + name.substr(dot + 1));
  }
  return report;
}

}  // namespace lockstep
