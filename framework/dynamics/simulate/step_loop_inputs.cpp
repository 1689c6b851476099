// SPDX-License-Identifier: BSD-3-Clause
// What a host sets of inputs between two steps.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <deque>
#include <string>
#include <vector>

#include <lockstep/error.h>
#include "framework/dynamics/simulate/consistency.h"
#include "framework/dynamics/simulate/keep_state.h"
#include "framework/dynamics/simulate/step_loop_parts.h"
#include "framework/dynamics/tree/rows_in_plane.h"

namespace lockstep {

namespace {

// The inputs become as they were seen, and `seen` has what was set.
void swap_inputs(std::deque<ControlInput>& inputs, std::vector<double>& seen) {
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const double set = inputs[k].value();
    inputs[k].set(seen[k]), seen[k] = set;
  }
}

std::string set_of(const std::deque<ControlInput>& inputs, const std::vector<double>& seen) {
  std::string words;
  for (std::size_t k = 0; k < seen.size(); ++k)
    if (inputs[k].value() != seen[k])
      words += fmt::format("{}input '{}' was changed from {:g} to {:g}", words.empty() ? "" : ", ", inputs[k].name(),
                           seen[k], inputs[k].value());
  return words;
}

}  // namespace

void StepLoop::note_inputs() {
  inputs_seen_.resize(system().control_inputs().size());
  std::ranges::transform(system().control_inputs(), inputs_seen_.begin(), &ControlInput::value);
}

void StepLoop::begin_inputs() {
  has_laws_ = may_have_laws(system());
  note_inputs();
}

bool StepLoop::take_inputs() {
  if (std::ranges::equal(system().control_inputs(), inputs_seen_, {}, &ControlInput::value)) return false;
  const bool may_jump = has_laws_ && inputs_seen_.size() == system().control_inputs().size();
  const bool jumped = may_jump && dynamics_.has_current_coordinates(state_) && cross_inputs();
  note_inputs();
  return jumped || parts_->interval.keeps_accelerations();
}

// A law that reads an input jumps when that is set, as it does at a breakpoint. The bodies are where they were before.
bool StepLoop::cross_inputs() {
  State slots = state_;
  const PositionJump jump = [&] {
    swap_inputs(dynamics_.control_inputs(), inputs_seen_);
    const AtEnd as_set([this] { swap_inputs(dynamics_.control_inputs(), inputs_seen_); });
    dynamics_.to_slots(slots);
    return PositionJump(dynamics_, slots);
  }();
  if (!jump.changes_rows(dynamics_, slots)) return false;
  if (const auto why = jump.refusal(dynamics_, slots, options_.start_limit))
    throw AssemblyError(set_of(system().control_inputs(), inputs_seen_) + ": " + why->what() +
                            "; reset the input, or let it prescribe the speed of the drive",
                        why->data());
  note_inputs();  // an error from here on does not undo this
  if (state_.coordinates) keep_state(state_, parts_->before_change);
  keep_state(slots, state_);
  parts_->fall_due(Due::before_jump, {.acted = true, .jump = true, .cause = "the jump of a law"});
  deliver();
  return true;
}

}  // namespace lockstep
