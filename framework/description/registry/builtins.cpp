// SPDX-License-Identifier: BSD-3-Clause
// Registers everything built in; the only file that knows every room's register function.
#include "framework/description/registry/builtins.h"

#include <algorithm>
#include <array>

#include <lockstep/author/registry.h>
#include "framework/description/registry/shelves.h"
#include "framework/description/registry/survey.h"
#if !LOCKSTEP_BUILTINS
#include <lockstep/author/loader.h>
#include <lockstep/error.h>
#endif

namespace lockstep {
namespace {

// The plugins that a library without built-ins loads itself.
constexpr std::array kParts = {"motionlaws", "integrators"};

#if LOCKSTEP_BUILTINS
void add_laws_and_integrators(Registry& registry) {
  register_motion_laws(registry);
  register_integrators(registry);
}
#else
// The types are the library's own, whatever file they come from: they are added without the plugin's name.
void add_laws_and_integrators(Registry& registry) {
  Registry its;
  for (const char* folder : kParts) try {
      load_plugin(its, folder);
    } catch (const PluginError& error) {
      throw PluginError(std::string("this lockstep loads its ") + folder +
                        " from a plugin (it was built with LOCKSTEP_BUILTINS=OFF): " + error.what());
    }
  for_each_shelf([&](auto, auto, auto shelf) {
    for (const auto& [type, entry] : (its.*shelf).entries()) (registry.*shelf).add(entry.info, entry.make);
  });
}
#endif

}  // namespace

bool is_part_of_library(std::string_view plugin) {
  return !LOCKSTEP_BUILTINS && std::ranges::find(kParts, plugin) != kParts.end();
}

Registry builtin_registry() {
  Registry registry;
  add_laws_and_integrators(registry);
  register_links(registry);
  register_forces(registry);
  register_solvers(registry);
  for_each_shelf([&](auto, auto, auto shelf) { (registry.*shelf).set_origin("built in"); });
  return registry;
}

}  // namespace lockstep
