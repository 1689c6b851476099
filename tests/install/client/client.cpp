// SPDX-License-Identifier: BSD-3-Clause
// client PREFIX PLUGINS: what is loaded comes from the prefix and fits the headers; a plugin's law can be made; functions
// of motionlaws/ and classes of integrators/ can be named.
#include <cmath>
#include <cstdio>
#include <cstring>

#include <lockstep/author/loader.h>
#include <lockstep/author/registry.h>
#include <lockstep/integrators.h>
#include <lockstep/laws.h>
#include <lockstep/version.h>

using namespace lockstep;

int main(int argc, char** argv) {
  if (argc < 3 || std::strcmp(kVersion, library_version()) != 0) return 1;
  Registry registry = builtin_registry();
  const std::string bump = load_plugin(registry, "bump");  // from the installed folder
  load_plugin(registry, "client_plugin", {argv[2]});
  const auto law = registry.laws.make("client_law", Params{{"slope", 3.0}}, &registry, "client");
  const auto sine = registry.laws.make("sine", Params{{"amplitude", 2.0}, {"frequency", "1 Hz"}}, &registry, "client");
  std::printf("lockstep %s, %s, law(2) = %g by %s\n", library_version(), bump.c_str(), law->at(2).y,
              label_of(law)->origin.c_str());
  return bump.find(argv[1]) == 0 && law->at(2).y == 6 && label_of(law)->origin == "client_plugin" && Rk4().info().order == 4 &&
                 std::abs(sine->at(0.25).y - 2) < 1e-12
             ? 0
             : 1;
}
