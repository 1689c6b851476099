// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/error.h>
#include "framework/mechanism/expression/function.h"
#include "motionlaws/law_types.h"

namespace lockstep {
namespace {

// y(t) by a formula, with exact derivatives. If a comparison in it switches, y may jump: a breakpoint.
class FormulaLaw final : public MotionLaw {
 public:
  FormulaLaw(const std::string& y, const std::vector<NamedNumbers>& constants) : y_(y, {"t"}, constants) {}
  LawValue at(double t) const override {
    const Time time(t, 1.0, 0.0), y = y_(std::span<const Time>(&time, 1));
    return {y.v, y.d, y.h};
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override { y_.breakpoints(0, t0, t1, out); }
  bool is_constant() const override { return y_.is_constant(); }

 private:
  expression::FormulaFunction y_;
};

}  // namespace

void add_formula(LawTypes& types) {
  types.laws.add({"formula",
                  "y by a formula of time",
                  {value_key("y", Form::text, kRequired,
                             "formula of t, as in \"=0.1*sin(3*t)\"; all numbers in SI, or all with units"),
                   expression::constants_key()}},
                 [](const Params& p) -> LawPtr<MotionLaw> {
                   const std::vector<NamedNumbers> constants = expression::read_constants(p, "parameters");
                   try {
                     return std::make_shared<const FormulaLaw>(p.text("y"), constants);
                   } catch (const ModelError& error) {
                     p.refuse("y", error.what());
                   }
                 });
}

}  // namespace lockstep
