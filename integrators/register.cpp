// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/registry/builtins.h"

#include <lockstep/author/registry.h>
#include <lockstep/integrators.h>

namespace lockstep {

void register_integrators(Registry& registry) {
  registry.integrators.add(SemiImplicitEuler::type_info(),
                           [](const Params&) { return std::make_unique<SemiImplicitEuler>(); });
  registry.integrators.add(Rk4::type_info(), [](const Params&) { return std::make_unique<Rk4>(); });
  registry.integrators.add(Dopri5::type_info(), &Dopri5::make);
  registry.integrators.add(Dop853::type_info(), &Dop853::make);
  registry.integrators.add(GeneralizedAlpha::type_info(), &GeneralizedAlpha::make);
  registry.integrators.add(Radau5::type_info(), &Radau5::make);
  for (const int order : {2, 4})
    registry.integrators.add(Rattle::type_info(order), [order](const Params&) { return Rattle::make(order); });
}

}  // namespace lockstep
