// SPDX-License-Identifier: BSD-3-Clause
#include "motionlaws/register.h"

namespace lockstep {

void register_motion_laws(Registry& registry) {
  for (const auto add : {add_constant, add_ramp, add_sine, add_fourier, add_polynomial, add_rise, add_trapezoid,
                         add_spline, add_sequence, add_repeat, add_combine, add_formula, add_translations, add_path,
                         add_rotations, add_spline_rotation})
    add(registry);
}

}  // namespace lockstep
