#include <lockstep/check.h>

#include <spdlog/fmt/fmt.h>

#include "framework/tools/check/integrator_check.h"
#include <lockstep/error.h>

namespace lockstep {

CheckReport check_integrator(const IntegratorMaker& make, const CheckOptions& options) {
  const std::unique_ptr<Integrator> first = make ? make() : nullptr;
  if (!first) throw ModelError("check_integrator: its maker gives no integrator; give one that does");
  CheckReport report(fmt::format("integrator '{}'", first->info().name), options.seed);
  IntegratorCheck(make, report).run();
  return report;
}

CheckReport check_integrator(const Registry& registry, const std::string& type, const Params& params,
                             const CheckOptions& options) {
  return check_integrator([&] { return registry.integrators.make(type, params, &registry, "integrator"); }, options);
}

}  // namespace lockstep
