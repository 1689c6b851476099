// SPDX-License-Identifier: BSD-3-Clause
#include "motionlaws/formula.h"

#include <lockstep/error.h>

namespace lockstep {

FormulaLaw::FormulaLaw(const std::string& y, const std::vector<expression::Constant>& constants)
    : y_(y, {"t"}, constants) {}

LawValue FormulaLaw::at(double t) const {
  const Time time(t, 1.0, 0.0), y = y_(std::span<const Time>(&time, 1));
  return {y.v, y.d, y.h};
}

void FormulaLaw::breakpoints(double t0, double t1, std::vector<double>& out) const { y_.breakpoints(0, t0, t1, out); }

const TypeInfo& FormulaLaw::info() {
  static const TypeInfo info{"formula",
                             "y by a formula of time",
                             {{"y",
                               Form::text,
                               Unit::none,
                               kRequired,
                               "formula of t, as in \"=0.1*sin(3*t)\"; all numbers in SI, or all with units",
                               {},
                               LawQuantity::value},
                              expression::constants_key()}};
  return info;
}

LawPtr<MotionLaw> FormulaLaw::make(const Params& p) {
  const std::vector<expression::Constant> constants = expression::read_constants(p, "parameters");
  try {
    return std::make_shared<const FormulaLaw>(p.text("y"), constants);
  } catch (const SceneError&) {
    throw;
  } catch (const ModelError& error) {
    p.refuse("y", error.what());
  }
}

}  // namespace lockstep
