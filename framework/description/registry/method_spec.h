// MethodSpec: an integrator or a solver by name, with the keys of its type.
#pragma once

#include <string>
#include <vector>

#include "framework/description/registry/registry.h"

namespace lockstep {

struct MethodSpec {
  std::string type;  ///< name in the registry
  Value keys{};      ///< an object, or null for the defaults
  Where where{};     ///< where a file says so
};

/// Descriptions of all entries of a shelf.
template <class S>
std::vector<TypeInfo> types_of(const S& shelf) {
  std::vector<TypeInfo> all;
  for (const auto& [name, entry] : shelf.entries()) all.push_back(entry.info);
  return all;
}

/// From one word: "dopri5", or "dop853:stages=auto:fixed=true". Values are numbers, true, false, or texts, with or
/// without quotes. Throws ModelError for an unknown name or key, with the closest one.
LOCKSTEP_API MethodSpec read_method_spec(const std::string& text, const std::vector<TypeInfo>& types);

/// Made from their descriptions. `owner` begins every message. Throw SceneError with the place.
LOCKSTEP_API std::unique_ptr<Integrator> make_integrator(const MethodSpec&, const Registry&, const std::string& owner);
LOCKSTEP_API std::unique_ptr<LinearSolver> make_solver(const MethodSpec&, const Registry&, const std::string& owner);

}  // namespace lockstep
