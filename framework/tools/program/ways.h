// Ways: integrators and solvers with their keys, as words of the command line and from the registry.
#pragma once

#include <string>
#include <vector>

#include "framework/tools/program/commands.h"

namespace lockstep {

/// What stands on a shelf of the registry.
template <class S>
std::vector<TypeInfo> types_of(const S& shelf) {
  std::vector<TypeInfo> all;
  for (const auto& [name, entry] : shelf.entries()) all.push_back(entry.info);
  return all;
}

/// "dopri5", or "dopri5:fixed=true": a name and values of its keys, as JSON or as a bare word. Throws UsageError naming
/// `option` for an unknown name or key.
Typed read_way(const std::string& option, const std::string& text, const std::vector<TypeInfo>& types);

/// The same in one word, to be read back by read_way.
std::string spelled(const Typed&);
/// The same as it stands in a scene: "rk4" in quotes, or {"type": "dopri5", "fixed": true}.
Value as_value(const Typed&);

/// `own` first, then every type with its defaults, then with each other value of a key that is a choice, one key at a
/// time; what is beyond that (switches, numbers) is charted where somebody names it.
std::vector<Typed> all_ways(const Typed& own, const std::vector<TypeInfo>& types);

/// `type` with those of `keys` that it knows.
Typed with_known_keys(const TypeInfo& type, const Value& keys);

}  // namespace lockstep
