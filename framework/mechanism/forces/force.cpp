// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/force.h>

#include <algorithm>

namespace lockstep {

Force::Force(std::string name) : name_(std::move(name)) {}
Force::~Force() = default;

void Force::breakpoints(double, double, std::vector<double>&) const {}
std::string Force::diagnose(double) const { return {}; }

namespace {

// K and D by central differences of `push(inputs, sum)` over these slots.
template <class Push>
void add_differences(const std::vector<int>& slots, const Inputs& in, TangentSum& out, const Push& push) {
  if (slots.empty()) return;
  Differences& scratch = out.differences(in);
  Inputs at = in;
  at.motions = scratch.motions;
  WrenchSum sum(at.motions, scratch.f);
  const auto add_force = [&](int column, int k, double factor) {
    for (const int i : slots) scratch.f.segment<6>(6 * i).setZero();
    push(at, sum);
    for (const int i : slots) {
      Mat6 change = Mat6::Zero();
      change.col(k % 6) = factor * scratch.f.segment<6>(6 * i);
      if (k < 6)
        out.add_K(i, column, change);
      else
        out.add_D(i, column, change);
    }
  };
  const double distance = Differences::distance(slots, in);
  for (const int j : slots)
    for (int k = 0; k < 12; ++k) {
      Motion& O = scratch.motions[j + 1];
      const Motion home = O;
      const double speed = std::max(1.0, k < 9 ? home.v.norm() : home.w.norm());
      const double h = Differences::kStep * (k < 3 ? distance : k < 6 ? 1.0 : speed);
      O = Differences::moved(home, k, h);
      add_force(j, k, -0.5 / h);
      O = Differences::moved(home, k, -h);
      add_force(j, k, 0.5 / h);
      O = home;
    }
}

}  // namespace

void Force::tangent(const Inputs& in, TangentSum& out) const {
  add_differences(slots_, in, out, [this](const Inputs& at, WrenchSum& sum) { apply(at, sum); });
}
void Reacting::react_tangent(const Inputs& in, const Reactions& reactions, TangentSum& out) const {
  add_differences(self_->slots(), in, out, [&](const Inputs& at, WrenchSum& sum) { react(at, reactions, sum); });
}

double Force::potential(const Inputs&) const { return 0; }
double Force::dissipation(const Inputs&) const { return 0; }
double Force::supply(const Inputs&) const { return 0; }

void Force::place(int first_memory) {
  first_memory_ = first_memory;
  switch_memory_ = switched_ ? first_memory + n_own_memory() : -1;
  slots_.clear();
  for (const Marker* m : markers())
    if (m->body->slot != kGround && std::find(slots_.begin(), slots_.end(), m->body->slot) == slots_.end())
      slots_.push_back(m->body->slot);
}

}  // namespace lockstep
