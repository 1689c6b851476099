// SPDX-License-Identifier: BSD-3-Clause
// The law 'formula': a formula of time, written in a scene.
#pragma once

#include <lockstep/author/law.h>
#include <lockstep/author/params.h>
#include "framework/mechanism/expression/function.h"

namespace lockstep {

/// y(t) by a formula, with exact derivatives. Where a comparison in it switches, y may jump: a breakpoint.
class LOCKSTEP_API FormulaLaw final : public MotionLaw {
 public:
  /// A formula of t, s, in SI. Throws ModelError with formula, column and problem.
  explicit FormulaLaw(const std::string& y, const std::vector<expression::Constant>& constants = {});

  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  bool is_constant() const override { return y_.is_constant(); }

  static const TypeInfo& info();                 ///< name and keys of its type
  static LawPtr<MotionLaw> make(const Params&);  ///< the law from checked parameters

 private:
  expression::FormulaFunction y_;
};

}  // namespace lockstep
