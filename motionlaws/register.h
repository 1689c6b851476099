// SPDX-License-Identifier: BSD-3-Clause
// Registers the laws of this room.
#pragma once

#include <lockstep/author/law_checks.h>
#include <lockstep/author/registry.h>

namespace lockstep {

/// Adds the built-in scalar, translation and rotation laws. Throws PluginError when a name is taken.
LOCKSTEP_API void register_motion_laws(Registry&);

// Those of each file.
void add_constant(Registry&);
void add_ramp(Registry&);
void add_sine(Registry&);
void add_fourier(Registry&);
void add_polynomial(Registry&);
void add_rise(Registry&);
void add_trapezoid(Registry&);
void add_spline(Registry&);
void add_sequence(Registry&);
void add_repeat(Registry&);
void add_combine(Registry&);
void add_formula(Registry&);
void add_translations(Registry&);
void add_path(Registry&);
void add_rotations(Registry&);
void add_spline_rotation(Registry&);

}  // namespace lockstep
