// Ways: integrators and solvers with their keys, as words of the command line and from the registry.
#pragma once

#include <string>
#include <vector>

#include "framework/tools/program/commands.h"

namespace lockstep {

/// "dopri5", or "dopri5:fixed=true": a name and values of its keys, as JSON or as a bare word. Throws UsageError naming
/// `option` for an unknown name or key.
MethodSpec read_way(const std::string& option, const std::string& text, const std::vector<TypeInfo>& types);

/// The same in one word, to be read back by read_way.
std::string spelled(const MethodSpec&);
/// The same as it stands in a scene: "rk4" in quotes, or {"type": "dopri5", "fixed": true}.
Value as_value(const MethodSpec&);

/// `own` first, then every type with its defaults, then with each other value of a key that is a choice, one key at a
/// time; what is beyond that (switches, numbers) is charted where somebody names it.
std::vector<MethodSpec> all_ways(const MethodSpec& own, const std::vector<TypeInfo>& types);

/// `type` with those of `keys` that it knows.
MethodSpec with_known_keys(const TypeInfo& type, const Value& keys);

}  // namespace lockstep
