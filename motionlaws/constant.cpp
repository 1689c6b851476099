// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/laws.h>


namespace lockstep {

Constant::Constant(double value) : value_(value) { require_finite("constant", "value", value); }

LawValue Constant::at(double) const { return {value_, 0.0, 0.0}; }

const TypeInfo& Constant::info() {
  static const TypeInfo info{"constant",
                             "y = value",
                             {{"value",
                               Form::number,
                               Unit::any,
                               kRequired,
                               "the value, in the unit of what it drives",
                               {},
                               LawQuantity::value}}};
  return info;
}

LawPtr<MotionLaw> Constant::make(const Params& p) {
  return laws::constant(p.number("value"));
}

namespace laws {
LawPtr<MotionLaw> constant(double value) { return std::make_shared<const Constant>(value); }
}  // namespace laws

}  // namespace lockstep
