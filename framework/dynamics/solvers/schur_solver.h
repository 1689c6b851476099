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
  SchurSolver();
  ~SchurSolver() override;
  static TypeInfo info();
  static std::unique_ptr<LinearSolver> make(const Params&);

  std::string_view name() const override { return "schur"; }
  bool reads_rows() const override { return true; }
  void analyse(const KktPattern&) override;
  void factor(const Kkt&) override;
  SolveReport solve(const Kkt&, const VecX& f, const VecX& c, VecX& a, VecX& lambda) override;
  void complete(SolveReport&) const override;

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace lockstep
