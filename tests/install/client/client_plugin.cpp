// SPDX-License-Identifier: BSD-3-Clause
// The smallest law: y = slope t.
#include <lockstep/author/plugin.h>

namespace {

using namespace lockstep;

struct ClientLaw final : MotionLaw {
  explicit ClientLaw(double slope) : slope(slope) {}
  LawValue at(double t) const override { return {slope * t, slope, 0}; }
  static TypeInfo info() {
    return {
        "client_law", "slope t", {{"slope", Form::number, Unit::any, kRequired, "its slope", {}, LawQuantity::rate}}};
  }
  static LawPtr<MotionLaw> make(const Params& p) { return std::make_shared<ClientLaw>(p.number("slope")); }
  double slope;
};

}  // namespace

LOCKSTEP_PLUGIN(registry) { registry.laws.add<ClientLaw>(); }
