// SPDX-License-Identifier: BSD-3-Clause
// The kernel instance for a set of laws: a compromise between compile time and specialisation (theory, (5.4)). A law
// that the instance covers and the joint lacks enters as zero.
#pragma once

#include <type_traits>

#include <lockstep/detail/kernel.h>

namespace lockstep {

template <unsigned kWith>
using Instance = std::integral_constant<unsigned, kWith>;

/// Calls half(Instance<kWith>{}) with the instance of `translation` that covers the laws (with::Bits) and kExtra; not
/// at all when the mask holds no translation.
template <unsigned kExtra = 0, class F>
inline void choose_translation(Mask rows, unsigned laws, F&& half) {
  constexpr unsigned kMarkers = with::uP | with::uS | with::qS;
  if (!overlaps(rows, Mask::xyz)) return;
  if (laws & kMarkers)
    half(Instance<kMarkers | with::p | kExtra>{});
  else if (laws & with::p)
    half(Instance<with::p | kExtra>{});
  else if (laws & with::parallel)
    half(Instance<with::parallel | kExtra>{});
  else
    half(Instance<with::nothing | kExtra>{});
}

/// The same for `rotation`; not at all when the mask holds no turn.
template <class F>
inline void choose_rotation(Mask rows, unsigned laws, F&& half) {
  constexpr unsigned kMarkers = with::qP | with::qS;
  if (!overlaps(rows, Mask::e123)) return;
  if (laws & kMarkers)
    half(Instance<kMarkers | with::qD>{});
  else if (laws & with::qD)
    half(Instance<with::qD>{});
  else if (laws & with::parallel)
    half(Instance<with::parallel>{});
  else
    half(Instance<with::nothing>{});
}

}  // namespace lockstep
