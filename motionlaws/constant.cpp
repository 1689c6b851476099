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

LawPtr<MotionLaw> laws::constant(double value) { return std::make_shared<const Constant>(value); }

void add_constant(LawTypes& types) {
  types.laws.add({"constant",
                  "y = value",
                  {value_key("value", Form::number, kRequired, "the value, in the unit of the driven quantity")}},
                 [](const Params& p) { return laws::constant(p.number("value")); });
}

}  // namespace lockstep
