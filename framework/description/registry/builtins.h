// SPDX-License-Identifier: BSD-3-Clause
// What registers the types that come with lockstep, each in the folder of its types (register.cpp). All throw PluginError if
// a name is taken.
#pragma once

#include <lockstep/detail/export.h>

namespace lockstep {

class Registry;

LOCKSTEP_API void register_links(Registry&);
LOCKSTEP_API void register_forces(Registry&);
LOCKSTEP_API void register_solvers(Registry&);
LOCKSTEP_API void register_motion_laws(Registry&);  ///< scalar laws, of translations and of rotations
LOCKSTEP_API void register_integrators(Registry&);

/// Adds these classes to a shelf, in this order.
template <class... Types>
void add_types(auto& shelf) {
  (shelf.template add<Types>(), ...);
}

}  // namespace lockstep
