// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/force.h>

#include <algorithm>
#include <utility>

#include <lockstep/author/relative.h>
#include <lockstep/error.h>
#include "framework/mechanism/lock/add_differences.h"

namespace lockstep {

Force::Force(std::string name) : name_(std::move(name)) {}
Force::~Force() = default;

void Force::tangent(const Inputs& in, TangentSum& out) const {
  add_differences(slots_, true, in, out, [this](const Inputs& at, VecX& f) {
    WrenchSum sum(at.motions, f);
    apply(at, sum);
  });
}
void Reacting::react_tangent(const Inputs& in, const Reactions& reactions, TangentSum& out) const {
  add_differences(self_->slots(), true, in, out, [&](const Inputs& at, VecX& f) {
    WrenchSum sum(at.motions, f);
    react(at, reactions, sum);
  });
}

void Force::place(int first_memory) {
  first_memory_ = first_memory;
  switch_memory_ = switched_ ? first_memory + n_own_memory() : -1;
  slots_.clear();
  for (const Marker* m : markers())
    if (m->body->slot != kGround && std::find(slots_.begin(), slots_.end(), m->body->slot) == slots_.end())
      slots_.push_back(m->body->slot);
}

FunctionForce::FunctionForce(std::string name, std::vector<const Marker*> markers, Apply apply, Energy potential,
                             Energy dissipation)
    : Force(std::move(name)),
      markers_(std::move(markers)),
      apply_(std::move(apply)),
      potential_(std::move(potential)),
      dissipation_(std::move(dissipation)) {
  if (!apply_) throw ModelError("force '" + this->name() + "' (function_force) has no function; give one");
  for (const Marker* m : markers_) {
    if (m == nullptr) throw ModelError("force '" + this->name() + "' (function_force): a marker is null; remove it");
    if (m->body == nullptr)
      throw ModelError("force '" + this->name() + "' (function_force): marker '" + m->name +
                       "' is not on a body; add it with add_marker");
  }
}

void FunctionForce::breakpoints(double t0, double t1, std::vector<double>& out) const {
  for (const Marker* m : markers_) MarkerFrame(*m).breakpoints(t0, t1, out);
}

std::unique_ptr<FunctionForce> function_force(std::string name, std::vector<const Marker*> markers,
                                              FunctionForce::Apply apply, FunctionForce::Energy potential,
                                              FunctionForce::Energy dissipation) {
  return std::make_unique<FunctionForce>(std::move(name), std::move(markers), std::move(apply), std::move(potential),
                                         std::move(dissipation));
}

}  // namespace lockstep
