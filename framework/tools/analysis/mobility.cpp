#include <lockstep/analysis.h>

#include <Eigen/QR>
#include <cmath>

namespace lockstep {

MobilityReport mobility(Dynamics& dynamics, const State& state) {
  const Evaluation& evaluation = dynamics.gather(state);
  const System& system = dynamics.system();
  const RowTable& table = evaluation.rows();
  MobilityReport report;
  report.bodies = system.n_slots();
  report.unknowns = system.n_velocities();
  report.rows = table.n_rows;

  // Rows in lengths: angular columns divided by the scene's length, each row to length one.
  const double L = system.length();
  MatX Jt = MatX::Zero(6 * system.n_slots(), table.n_rows);
  for (const RowEntry& e : table.entries) {
    const RowView block = table.block(e);
    for (int i = 0; i < e.slots.n; ++i) {
      const bool particle = system.slot(e.slots[i]).freedoms == Freedoms::particle;
      for (int k = 0; k < e.m; ++k) {
        const auto r = block.J(i, k);
        for (int c = 0; c < (particle ? 3 : 6); ++c) Jt(6 * e.slots[i] + c, e.first_row + k) = c < 3 ? r[c] : r[c] / L;
      }
    }
  }
  for (int k = 0; k < Jt.cols(); ++k) {
    const double length = Jt.col(k).norm();
    if (length > 0) Jt.col(k) /= length;
  }
  if (table.n_rows > 0) {
    Eigen::CompleteOrthogonalDecomposition<MatX> cod;
    cod.setThreshold(1e-9);
    cod.compute(Jt);
    report.rank = static_cast<int>(cod.rank());
    // Rows with a share in the null space of Jt: what the projector onto the row space's complement leaves of each.
    const MatX projector = cod.pseudoInverse() * Jt;
    for (const auto& link : system.links()) {
      const int entry = table.entry_of_link[static_cast<std::size_t>(link->number())];
      if (entry < 0) continue;
      const RowEntry& e = table.entries[static_cast<std::size_t>(entry)];
      bool shares = false;
      for (int k = 0; k < e.m; ++k) shares = shares || 1.0 - projector(e.first_row + k, e.first_row + k) > 1e-9;
      if (shares) report.redundant_links.push_back(link->name());
    }
  }
  report.freedoms = report.unknowns - report.rank;
  report.redundant = report.rows - report.rank;
  return report;
}

}  // namespace lockstep
