// Checks the force against its energies and, if it has a tangent, that against differences. Argument: plugin file.
#include <cstdio>

#include <lockstep/author/check.h>
#include <lockstep/author/loader.h>
#include <lockstep/author/registry.h>

int main(int argc, char** argv) try {
  using namespace lockstep;
  Registry registry = builtin_registry();
  load_plugin(registry, argc > 1 ? argv[1] : "template_force");
  const CheckReport report = check_force(registry, "template_force", {{"strength", 0.4}});
  std::fputs(report.text().c_str(), stdout);
  return report.ok() ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
