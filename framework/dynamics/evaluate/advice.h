// Advice that several error messages end with.
#pragma once

namespace lockstep {

inline constexpr const char* kShorter =
    "make the step smaller, or take a method that chooses it (dopri5; radau5 where springs or dampers are stiff)";

}  // namespace lockstep
