// Variables: one quantity of a scene each, and the values it takes from run to run.
#pragma once

#include <string>
#include <vector>

#include "framework/description/registry/registry.h"
#include "framework/description/scene/scene.h"

namespace lockstep {

struct Variable {
  std::string path;           ///< as it was asked for: "bodies.rod.mass"
  std::string place;          ///< the same, however it was asked for: things of a list by their name
  std::string unit;           ///< of the numbers, "kg"; "" when they have none or it is not known
  std::vector<Value> values;  ///< numbers in SI, words, true or false; one at least
  std::string near{};         ///< the closest number of the scene, when this is none of it yet
};

/// "NAME=a:b:n": n numbers evenly from a to b; "NAME=v1,v2,...": these values. NAME is a path (find_place); numbers
/// are SI, or carry units as in scenes. Throws ModelError or SceneError naming the path: no such place (with the
/// nearest), values that cannot stand there, and what decides on the columns, which are the same in all runs.
LOCKSTEP_API Variable read_variable(const std::string& text, const Scene&, const Registry&);

/// Of several; refuses the same place twice.
LOCKSTEP_API std::vector<Variable> read_variables(const std::vector<std::string>& texts, const Scene&, const Registry&);

/// The scene with value choice[k] of variable k in its place; its run settings are read anew. Throws SceneError for
/// settings that cannot be; the rest is checked by build().
LOCKSTEP_API Scene varied(const Scene&, const std::vector<Variable>&, const std::vector<std::size_t>& choice,
                          const Registry&);

/// "bodies.rod.mass = 2 kg, gravity.1 = -9.81".
LOCKSTEP_API std::string setting_text(const std::vector<Variable>&, const std::vector<std::size_t>& choice);

/// A value as it stands in a table: number in shortest form, word, true or false.
LOCKSTEP_API std::string plain_text(const Value&);

}  // namespace lockstep
