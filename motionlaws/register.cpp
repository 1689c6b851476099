// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/registry/builtins.h"

#include <lockstep/author/registry.h>
#include "motionlaws/law_types.h"

namespace lockstep {

void register_motion_laws(Registry& registry) {
  LawTypes types;
  for (const auto add : {add_constant, add_input, add_ramp, add_sine, add_fourier, add_polynomial, add_rise,
                         add_trapezoid, add_spline, add_sequence, add_repeat, add_combine, add_formula,
                         add_translations, add_path, add_rotations, add_spline_rotation})
    add(types);
  for (auto& [info, make] : types.laws.all) registry.laws.add(std::move(info), std::move(make));
  for (auto& [info, make] : types.translation_laws.all) registry.translation_laws.add(std::move(info), std::move(make));
  for (auto& [info, make] : types.rotation_laws.all) registry.rotation_laws.add(std::move(info), std::move(make));
}

}  // namespace lockstep
