// Observers that are told a phase again when they could not take it in.
#pragma once

#include <lockstep/export.h>

namespace lockstep {

class Observer;

/// For an observer that keeps rows: called before it throws, it has the loop repeat this call when the run goes on, so
/// that no row is lost. Observers that do not ask are not told again: what they threw may be meant to break the run off.
LOCKSTEP_API void ask_again(const Observer&) noexcept;

/// For the loop: whether this observer has asked since the last call, on this thread. The question is forgotten.
bool take_asked_again(const Observer&) noexcept;

}  // namespace lockstep
