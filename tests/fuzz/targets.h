// SPDX-License-Identifier: BSD-3-Clause
// What is fuzzed. A target takes any bytes, and returns: the library may refuse them by one of its errors, and nothing else.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace lockstep::fuzz {

using Bytes = std::span<const std::uint8_t>;

/// A promise that was not kept: an exception of another kind, a number that is not finite. No std::exception, so that
/// nothing on its way takes it for the library's.
struct Broken {
  std::string words;
};

void formula(Bytes);  ///< a formula, of quantities and of time and coordinates, and its switches
void table(Bytes);    ///< a CSV table, and the same as the columns of a law
void mesh(Bytes);     ///< a mesh for pictures, as STL and as OBJ
void plugin(Bytes);   ///< the file of a plugin: its structure and its record, never opened
void urdf(Bytes);     ///< a robot in URDF, and the scene that it becomes
void channel(Bytes);  ///< names of channels, of methods with keys, and of variables of a scene, one a line
void scene(Bytes);    ///< the text of a scene: read and built
void run(Bytes);      ///< the same, run for 0.1 s by every integrator
void api(Bytes);  ///< calls of the C++ API in any order: described, set up, evaluated, stepped, thrown out of, gone on

/// A target by its name.
struct Target {
  const char* name;
  void (*run)(Bytes);
};
inline constexpr Target kTargets[] = {{"formula", formula}, {"table", table}, {"mesh", mesh},
                                      {"plugin", plugin},   {"urdf", urdf},   {"channel", channel},
                                      {"scene", scene},     {"run", run},     {"api", api}};

inline std::string text_of(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

}  // namespace lockstep::fuzz
