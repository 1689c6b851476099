// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/params/input_scope.h"
#include "motionlaws/law_types.h"

namespace lockstep {
namespace {

/// The present value of an input, which a host sets between steps.
class Input final : public MotionLaw {
 public:
  explicit Input(InputScope::Reader value) : value_(std::move(value)) {}
  LawValue at(double) const override { return {value_(), 0.0, 0.0}; }

 private:
  InputScope::Reader value_;
};

}  // namespace

void add_input(LawTypes& types) {
  types.laws.add(
      {"input",
       "y = an input of the mechanism, which a host program sets between steps; laws of one name share it",
       {{"name", Form::text, Unit::none, kRequired, "name of the input; its channel is NAME.value"},
        value_key("value", Form::number, 0, "the value until it is set, in the unit of the driven quantity")}},
      [](const Params& p) -> LawPtr<MotionLaw> {
        return std::make_shared<const Input>(InputScope::find(p.text("name"), p.number("value")));
      });
}

}  // namespace lockstep
