// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/batch/batch.h"

#include <lockstep/error.h>

namespace lockstep::lanes {

Batch::Batch(std::span<System* const> systems, int first, const CopiesOptions& options)
    : n_(static_cast<int>(systems.size())),
      first_(first),
      n_s_(static_cast<std::size_t>(systems[0]->n_states())),
      pass_(lanes::passes(options.instructions)),
      stabilization_(options.stabilization) {
  std::string why_not;
  const Trees trees = trees_of(systems, Formulation::joint, why_not);
  if (trees.empty()) throw ModelError("batch: joint coordinates are not possible: " + why_not);
  for (int l = 0; l < kLanes; ++l) {
    systems_[l] = systems[l < n_ ? l : 0];
    states_[l].setZero(systems_[l]->n_states());
    memory_[l] = systems_[l]->start().z;
    has_forces_ = has_forces_ || !systems_[l]->forces().empty();
  }
  for (const auto& link : systems_[0]->links())
    if (link->active_at_start() && link->n_own_states() > 0) stateful_.push_back(link->number());
  const auto& auxiliaries = systems_[0]->auxiliaries();
  for (std::size_t k = 0; k < auxiliaries.size(); ++k)
    if (!(auxiliaries[k]->reads_solution() && auxiliaries[k]->vanishes_without_laws())) integrated_.push_back(k);
  reads_motions_ = has_forces_ || !stateful_.empty() || !integrated_.empty() || !systems_[0]->counted_angles().empty();
  const int n_slots = systems_[0]->n_slots();
  motions_.resize(n_slots + 1);
  wrench_of_one_.setZero(6 * n_slots);
  rates_of_one_.setZero(systems_[0]->n_states());
  lay_out(trees);
  if (integrated_.empty()) return;
  passes::lay_out(*systems_[0], std::vector<bool>(systems_[0]->links().size(), false), no_rows_);
  no_accelerations_.setZero(6 * n_slots);
}

void Batch::put(int lane, const State& state, double* y) const {
  double* to = y + lane;
  for (const VecX* part : {&state.q, &state.v, &state.s})
    for (Eigen::Index i = 0; i < part->size(); ++i, to += kLanes) *to = (*part)[i];
  for (std::size_t i = 0; i < n_followed_; ++i, to += kLanes) *to = 0;
}
void Batch::get(int lane, const double* y, State& state) const {
  const double* from = y + lane;
  for (VecX* part : {&state.q, &state.v, &state.s})
    for (Eigen::Index i = 0; i < part->size(); ++i, from += kLanes) (*part)[i] = *from;
}

Inputs Batch::inputs(int lane, const double* y, double t) {
  VecX& s = states_[lane];
  const VecX& z = memory_[lane];
  const double* from = y + kL * first_state() + lane;
  for (Eigen::Index i = 0; i < s.size(); ++i, from += kLanes) s[i] = *from;
  return {t, motions_, {s.data(), static_cast<std::size_t>(s.size())}, {z.data(), static_cast<std::size_t>(z.size())}};
}

void Batch::see_motions(int lane) {
  for (int k = 0; k < system(lane).n_slots(); ++k) read_motion(lane, k, motions_[k + 1]);
}

void Batch::fill_wrench(const double* y, const Numbers8& t) {
  if (!has_forces_) return;
  for (int l = 0; l < kLanes; ++l) {
    wrench_of_one_.setZero();
    if (l < n_ && !system(l).forces().empty()) {
      see_motions(l);
      const Inputs in = inputs(l, y, t[l]);
      WrenchSum sum(in.motions, wrench_of_one_);
      guarded(l, [&] {
        for (const auto& force : system(l).forces()) force->apply(in, sum);
        passes::check_forces(system(l), in, wrench_of_one_);
      });
    }
    for (Eigen::Index i = 0; i < wrench_of_one_.size(); i += 3)
      put_axes(data_.z.wrench, static_cast<std::size_t>(i), l, axes_, wrench_of_one_.segment<3>(i));
  }
}

void Batch::state_rates(const double* y, const Numbers8& t, double* rate) {
  if (n_s_ == 0) return;
  if (stateful_.empty() && integrated_.empty() && systems_[0]->counted_angles().empty()) {
    std::fill_n(rate + kL * first_state(), kL * n_s_, 0.0);
    return;
  }
  for (int l = 0; l < kLanes; ++l) {
    rates_of_one_.setZero();
    if (l < n_)
      guarded(l, [&] {
        see_motions(l);
        const Inputs in = inputs(l, y, t[l]);
        for (const int number : stateful_) {
          const Lock& link = *system(l).links()[number];
          link.stateful()->state_rates(
              in, {rates_of_one_.data() + link.first_state(), static_cast<std::size_t>(link.n_own_states())});
        }
        const Evaluated values{in, no_accelerations_, no_multipliers_, no_rows_};
        for (const std::size_t k : integrated_) {
          const Auxiliary& own = *system(l).auxiliaries()[k];
          own.rates(values, {rates_of_one_.data() + own.first(), static_cast<std::size_t>(own.size())});
        }
        passes::angle_rates(system(l), in, rates_of_one_);
      });
    double* to = rate + kL * first_state() + l;
    for (Eigen::Index i = 0; i < rates_of_one_.size(); ++i, to += kLanes) *to = rates_of_one_[i];
  }
}

}  // namespace lockstep::lanes
