// SPDX-License-Identifier: BSD-3-Clause
// Integrators and solvers with their options: from the command line, from the registry, and back to text.
#pragma once

#include <string>
#include <vector>

#include "framework/mechanism/params/units.h"
#include "framework/tools/program/commands.h"

namespace lockstep {

/// "dopri5", or "dopri5:fixed=true": a name and values of its keys, as JSON or as a bare word. Throws UsageError naming
/// `option` for an unknown name or key.
MethodSpec read_spec(const std::string& option, const std::string& text, const std::vector<TypeInfo>& types);

/// The same as one word, which read_spec reads back.
std::string to_word(const MethodSpec&);
/// The same as in a scene: "rk4" in quotes, or {"type": "dopri5", "fixed": true}.
Value to_value(const MethodSpec&);

/// `own` first, then every type with its defaults and with each other value of a key that is a choice, one key at a
/// time. Switches and numbers are varied only if the user names them.
std::vector<MethodSpec> all_specs(const MethodSpec& own, const std::vector<TypeInfo>& types);

/// `type` with those of `keys` that it knows.
MethodSpec with_known_keys(const TypeInfo& type, const Value& keys);

/// What the integrator of these settings is. A step may be missing.
IntegratorInfo integrator_info(RunSettings, const Registry&);

/// A positive number of the command line, in SI or with a unit. Throws UsageError naming `option`.
double positive_number(const std::string& option, const std::string& text, Unit unit, const char* example = nullptr);
/// A time of a run, s: 0, its start, or later. Throws likewise.
double instant(const std::string& option, const std::string& text);

/// A whole number of the command line, from 1 to `most`. Throws UsageError naming `option`; `refusal`: its words.
int whole_number(const std::string& option, const std::string& text, int most, const std::string& refusal = "");
/// --jobs; `usual` without it. Throws UsageError.
int jobs_of(const Arguments&, int usual);

}  // namespace lockstep
