// Measures the order of the integrator and checks what a run requires. Argument: plugin file.
#include <cstdio>

#include <lockstep/author/check.h>
#include <lockstep/author/loader.h>
#include <lockstep/author/registry.h>

int main(int argc, char** argv) try {
  using namespace lockstep;
  Registry registry = builtin_registry();
  load_plugin(registry, argc > 1 ? argv[1] : "template_integrator");
  const CheckReport report = check_integrator(registry, "template_integrator");
  std::fputs(report.text().c_str(), stdout);
  return report.ok() ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
