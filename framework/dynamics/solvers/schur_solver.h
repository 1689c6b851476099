// SchurSolver: S = J M^-1 J^T over the graph of the links, block by block (framework/docs/solvers.md, sections 2 and 5).
#pragma once

#include <memory>

#include "framework/dynamics/solvers/linear_solver.h"
#include "framework/mechanism/params/params.h"

namespace lockstep {

/// The default. Reads the rows where the links wrote them, in six velocities a slot, three in a plane; a step costs
/// time and memory in proportion to the bodies, trees without fill, slots with many links by a node of their own.
/// Nothing is allocated after analyse().
class LOCKSTEP_API SchurSolver final : public LinearSolver {
 public:
  static TypeInfo info();
  static std::unique_ptr<LinearSolver> make(const Params&);

  std::string_view name() const override { return "schur"; }
  bool reads_rows() const override { return true; }
  std::unique_ptr<Factorization> analyse(const KktPattern&) const override;
};

}  // namespace lockstep
