// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/record/quadrature.h"

#include <spdlog/fmt/fmt.h>

#include <lockstep/error.h>

namespace lockstep {

const Quadrature& quadrature(System& system, const std::string& name,
                             const std::function<double(const Evaluated&)>& rate, Integrand of) {
  for (const auto& auxiliary : system.auxiliaries()) {
    if (auxiliary->name() != name) continue;
    if (const auto* found = dynamic_cast<const Quadrature*>(auxiliary.get())) return *found;
    throw ModelError(fmt::format(
        "channel \"{0}\" needs an integrated state of its name, but the system already has one; rename that state",
        name));
  }
  return static_cast<const Quadrature&>(system.add(std::make_unique<Quadrature>(name, rate, of)));
}

}  // namespace lockstep
