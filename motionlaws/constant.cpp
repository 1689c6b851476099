// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/laws.h>

#include "motionlaws/law_types.h"

namespace lockstep {
namespace {

class Constant final : public MotionLaw {
 public:
  explicit Constant(double value) : value_(value) { require_finite("constant", "value", value); }
  LawValue at(double) const override { return {value_, 0.0, 0.0}; }
  bool is_constant() const override { return true; }

 private:
  double value_;
};

}  // namespace

namespace laws {
LawPtr<MotionLaw> constant(double value) { return std::make_shared<const Constant>(value); }
}  // namespace laws

void add_constant(LawTypes& types) {
  types.laws.add({"constant",
                  "y = value",
                  {{"value",
                    Form::number,
                    Unit::any,
                    kRequired,
                    "the value, in the unit of the driven quantity",
                    {},
                    LawQuantity::value}}},
                 [](const Params& p) { return laws::constant(p.number("value")); });
}

}  // namespace lockstep
