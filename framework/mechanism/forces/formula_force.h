// FormulaForce: a force between markers from one formula; see formula.h for how to write it.
#pragma once

#include "framework/mechanism/forces/formula.h"
#include "framework/mechanism/forces/marker_force.h"

namespace lockstep {

/// F derives from FormulaForce<F> and has act(ends, load). Wrench, tangent and energies come from it; of quantities() the
/// first are those that act() shows, and one more, called "power", is what the force gives to its two bodies, W.
template <class F>
class FormulaForce : public MarkerForce, public Observable {
 public:
  using MarkerForce::MarkerForce;

  void apply(const Inputs& in, WrenchSum& out) const override { formula::apply(P_, S_, in, act(), out); }
  void tangent(const Inputs& in, TangentSum& out) const override { formula::tangent(P_, S_, in, act(), out); }
  double potential(const Inputs& in) const override { return account(in).potential; }
  double dissipation(const Inputs& in) const override { return account(in).dissipation; }
  double supply(const Inputs& in) const override { return account(in).supply; }
  const Observable* observable() const override { return this; }
  std::vector<Quantity> quantities() const override { return {}; }
  double quantity(int k, const Inputs& in) const override {
    const ForceAccount all = account(in);
    return k < all.n_shown ? all.shown[static_cast<std::size_t>(k)] : all.power;
  }

 private:
  auto act() const {
    return [this](const auto& at, auto& load) { static_cast<const F&>(*this).act(at, load); };
  }
  ForceAccount account(const Inputs& in) const { return formula::account(P_, S_, in, act()); }
};

}  // namespace lockstep
