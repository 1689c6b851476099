#include <lockstep/analysis.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <array>
#include <cmath>

namespace lockstep {
namespace {

constexpr double kSingular = 1e-9;

// Rows in lengths: angular columns divided by the scene's length L. visit(row, slot, numbers)
template <class Visit>
void for_each_row(const System& system, const RowTable& table, const RowEntry& e, Visit&& visit) {
  const double L = system.length();
  const RowView block = table.block(e);
  for (int i = 0; i < e.slots.n; ++i) {
    const bool particle = system.slot(e.slots[i]).freedoms == Freedoms::particle;
    for (int k = 0; k < e.m; ++k) {
      auto r = block.J(i, k);
      for (std::size_t c = 3; c < 6; ++c) r[c] = particle ? 0.0 : r[c] / L;
      visit(k, i, r);
    }
  }
}

// Whether no rows depend on each other because the links make a tree, and those of each link do not depend on each other
// on one of its slots. Costs as much as the links, where the rank of all rows costs as much as their cube.
bool independent_in_a_tree(Dynamics& dynamics, const State& state, const RowTable& table) {
  if (!dynamics.why_not_joint(state.modes).empty()) return false;
  using OfOneSlot = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaxRows>;
  for (const RowEntry& e : table.entries) {
    OfOneSlot Jt = OfOneSlot::Zero(6, e.m);
    for_each_row(dynamics.system(), table, e, [&](int k, int i, const std::array<double, 6>& r) {
      if (i == 0) Jt.col(k) = Eigen::Map<const Eigen::Matrix<double, 6, 1>>(r.data());
    });
    for (int k = 0; k < e.m; ++k) Jt.col(k).normalize();
    Eigen::FullPivLU<OfOneSlot> lu(Jt);
    lu.setThreshold(kSingular);
    if (!Jt.allFinite() || lu.rank() < e.m) return false;
  }
  return true;
}

// The rank of all rows, and the links whose rows take part in a dependency: those with a share in the null space of Jt.
void decompose(const System& system, const RowTable& table, MobilityReport& report) {
  MatX Jt = MatX::Zero(6 * system.n_slots(), table.n_rows);
  for (const RowEntry& e : table.entries)
    for_each_row(system, table, e, [&](int k, int i, const std::array<double, 6>& r) {
      for (int c = 0; c < 6; ++c) Jt(6 * e.slots[i] + c, e.first_row + k) = r[static_cast<std::size_t>(c)];
    });
  for (int k = 0; k < Jt.cols(); ++k) {
    const double length = Jt.col(k).norm();
    if (length > 0) Jt.col(k) /= length;
  }
  Eigen::CompleteOrthogonalDecomposition<MatX> cod;
  cod.setThreshold(kSingular);
  cod.compute(Jt);
  report.rank = static_cast<int>(cod.rank());
  // What the projector onto the row space's complement leaves of each row.
  const MatX projector = cod.pseudoInverse() * Jt;
  for (const auto& link : system.links()) {
    const int entry = table.entry_of_link[static_cast<std::size_t>(link->number())];
    if (entry < 0) continue;
    const RowEntry& e = table.entries[static_cast<std::size_t>(entry)];
    bool shares = false;
    for (int k = 0; k < e.m; ++k) shares = shares || 1.0 - projector(e.first_row + k, e.first_row + k) > kSingular;
    if (shares) report.redundant_links.push_back(link->name());
  }
}

}  // namespace

MobilityReport mobility(Dynamics& dynamics, const State& state) {
  const Evaluation& evaluation = dynamics.gather(state);
  const System& system = dynamics.system();
  const RowTable& table = evaluation.rows();
  MobilityReport report;
  report.bodies = system.n_slots();
  report.unknowns = system.n_velocities();
  report.rows = report.rank = table.n_rows;
  if (table.n_rows > 0 && !independent_in_a_tree(dynamics, state, table)) decompose(system, table, report);
  report.freedoms = report.unknowns - report.rank;
  report.redundant = report.rows - report.rank;
  return report;
}

}  // namespace lockstep
